// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "models/collocation/bar_motion.hpp"
#include "models/implicit/complex_lanes.hpp"
#include "models/implicit/radau_stages.hpp"
#include "models/implicit/stage_array.hpp"
#include "models/lanes/stage_lanes.hpp"

namespace impactrig::models {

/// What a step of a RadauStages method makes of the accelerations at its stages, for n coordinates
/// or for one.
template <int S>
class StageMaps {
 public:
  static constexpr int pairs = S / 2;
  using Stages = StageArray<S>;
  using Lanes = Eigen::Array<double, S, 1>;
  using Series = Eigen::Matrix<double, S, 1>;
  using Square = Eigen::Matrix<double, S, S>;

  explicit StageMaps(int coordinates) : coordinates_(coordinates) {}

  /// All maps are those of a step of this length [s] from now on.
  void begin_step(double h) {
    h_ = h;
    velocity_map_ = h * method_.to_velocity;
    displacement_map_ = h * h * method_.to_displacement;
    reach_ = h * nodes_;
  }

  const RadauStages<S>& method() const { return method_; }

  const Collocation& rule() const { return method_.rule; }

  const Square& to_series() const { return to_series_; }  ///< from the nodes to Legendre terms

  /// From a state (n) under the accelerations of the stages to the stages (S, n).
  void place(const Eigen::ArrayXd& q, const Eigen::ArrayXd& v, const Stages& a, Stages& stage_q,
             Stages& stage_v) const {
    place_displacements(q, v, a, stage_q);
    map({.map = velocity_map_.data(), .in = a.data(), .offset = v.data(), .out = stage_v.data()});
  }

  void place_displacements(const Eigen::ArrayXd& q, const Eigen::ArrayXd& v, const Stages& a,
                           Stages& stage_q) const {
    map({.map = displacement_map_.data(),
         .in = a.data(),
         .ramp = reach_.data(),
         .slope = v.data(),
         .offset = q.data(),
         .out = stage_q.data()});
  }

  /// From forces at the stages to the complex ones of the method's pairs of eigenvalues.
  void split(const Stages& from, std::vector<ComplexLanes<pairs>>& to) const {
    map({.map = method_.into.data(), .in = from.data(), .out = to[0].numbers()});
  }

  /// From complex accelerations to those of the stages.
  void gather(std::vector<ComplexLanes<pairs>>& from, Stages& to) const {
    map({.map = method_.out.data(), .in = from[0].numbers(), .out = to.data()});
  }

  /// The accelerations' Legendre series (S, n).
  void find_series(const Stages& a, Stages& series) const {
    map({.map = to_series_.data(), .in = a.data(), .out = series.data()});
  }

  /// Accelerations of a step from the polynomial of another one, at its places origin + ratio c.
  void predict(const Stages& from, double ratio, double origin, Stages& to) const {
    if (ratio == 0.0) {
      to.setZero();
      return;
    }
    const int kept = origin > 0.0 ? std::min(S, 3) : S;
    Square values = Square::Zero();
    Series legendre;
    for (int i = 0; i < S; ++i) {
      shifted_legendre(origin + ratio * nodes_[i], legendre);
      values.row(i).head(kept) = legendre.head(kept).transpose();
    }
    const Square ahead = values * to_series_;
    map({.map = ahead.data(), .in = from.data(), .out = to.data()});
  }

  /// What one coordinate gains to the nodes.
  Lanes displacement_of(double v, const Lanes& a) const {
    return h_ * (v * nodes_ + h_ * (method_.to_displacement * a.matrix()).array());
  }

  Lanes velocity_of(const Lanes& a) const {
    return h_ * (method_.to_velocity * a.matrix()).array();
  }

  Series series_of(const Lanes& a) const { return to_series_ * a.matrix(); }

  /// One coordinate within the step: of position, speed and acceleration at the nodes.
  PointMotion motion_at(double q, double v, const Lanes& a, double part) const {
    Series integrals;
    shifted_legendre_integrals(part, integrals);
    const Lanes speed = v + velocity_of(a);
    return {q + h_ * integrals.dot(series_of(speed)), v + h_ * integrals.dot(series_of(a))};
  }

 private:
  void map(StagesByMap columns) const {
    columns.stages = S;
    columns.columns = coordinates_;
    map_stages(columns);
  }

  const RadauStages<S>& method_ = RadauStages<S>::get();
  Square to_series_ = method_.rule.to_series();
  Lanes nodes_ = method_.rule.points().array();
  int coordinates_;
  double h_ = 0.0;
  // from accelerations and a speed to what stages gain
  Square velocity_map_, displacement_map_;
  Lanes reach_;
};

}  // namespace impactrig::models
