// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <vector>

#include "models/beams/ancf.hpp"
#include "models/implicit/block_tridiagonal.hpp"
#include "models/implicit/stage_array.hpp"
#include "models/lanes/stage_lanes.hpp"

namespace impactrig::models {

/// An AncfBeam ordered node by node, X, X', U, U', the hinge's two positions kept as coordinates
/// that stay zero. Its forces are evaluated for all stages of a step at once.
class AncfChain {
 public:
  using Beam = AncfBeam;

  /// Derivatives of the internal forces, and of the hinge's angle times themselves.
  struct Tangent {
    ChainMatrix stiffness;
    Eigen::Matrix4d hinge;
  };

  /// The linear systems of K pairs of stages.
  template <int K>
  using Systems = BlockTridiagonal<K>;

  static constexpr int stride = 4;  ///< from X of a node to X of the next
  static constexpr int beside = 2;  ///< from X to U

  explicit AncfChain(const AncfBeam& beam);

  int nodes() const { return static_cast<int>(elements_.size()) + 1; }

  int coordinates() const { return 4 * nodes(); }

  const ChainMatrix& mass() const { return mass_; }

  /// Diagonal of the mass matrix, zero for what is held (4 nodes).
  const Eigen::ArrayXd& inertia() const { return inertia_; }

  /// M a + internal forces − weight; what is held is left at zero.
  template <int S>
  void residual(const StageArray<S>& q, const StageArray<S>& a, StageArray<S>& r) const;

  /// Whether bar or hinge take energy.
  bool damped() const { return hinge_.viscous != 0.0 || damping_ != BarDamping{}; }

  /// Adds the forces of damping in bar and hinge, as they resist.
  template <int S>
  void add_damping(const StageArray<S>& q, const StageArray<S>& v, StageArray<S>& r) const;

  const BarDamping& damping() const { return damping_; }

  /// Rate of the hinge's angle, closing > 0.
  template <int S>
  Eigen::Array<double, S, 1> hinge_rate(const StageArray<S>& q, const StageArray<S>& v) const {
    const auto hinge = hinge_angle<Eigen::Array<double, S, 1>>(q.col(1), q.col(3));
    return hinge.by_across * v.col(1) + hinge.by_along * v.col(3);
  }

  /// Adds a moment on the hinge, closing > 0, that acts on the bar.
  template <int S>
  void add_hinge_moment(double moment, const StageArray<S>& q, StageArray<S>& r) const {
    const auto hinge = hinge_angle<Eigen::Array<double, S, 1>>(q.col(1), q.col(3));
    r.col(1) -= moment * hinge.by_across;
    r.col(3) -= moment * hinge.by_along;
  }

  /// Kinetic, elastic and gravitational, of one state (4 nodes each).
  BeamEnergy energy(const Eigen::ArrayXd& q, const Eigen::ArrayXd& v) const;

  /// ∂(internal forces)/∂q without the hinge's; what is held has no part in it.
  void stiffness(const Eigen::ArrayXd& q, ChainMatrix& k) const;

  /// Shares of spring and damper of the hinge in the block of the first node.
  Eigen::Matrix4d hinge_block(const Eigen::ArrayXd& q, double coefficient) const;

  const Hinge& hinge() const { return hinge_; }

  Tangent make_tangent() const {
    return {ChainMatrix(static_cast<std::size_t>(nodes())), Eigen::Matrix4d::Zero()};
  }

  void renew(const Eigen::ArrayXd& q, Tangent& tangent) const {
    stiffness(q, tangent.stiffness);
    tangent.hinge = hinge_block(q, 1.0);
  }

  template <int K>
  Systems<K> make_systems() const {
    return Systems<K>(static_cast<std::size_t>(nodes()));
  }

  template <int K>
  void factor(const Tangent& tangent, const SystemShares<K>& share, Systems<K>& systems) const {
    systems.factor(mass_, tangent.stiffness, tangent.hinge, share);
  }

  /// visit(X, U, node): the coordinates that turn with the bar, and X of the node they belong to.
  template <typename Visitor>
  void for_each_pair(Visitor&& visit) const {
    for (int node = 0; node < coordinates(); node += stride)
      for (int k = node; k < node + beside; ++k) visit(k, k + beside, node);
  }

  /// Of the bar at a node, given by its X, closing < 0.
  static BarDirection direction(const Eigen::ArrayXd& q, int node) {
    const double across = q[node + 1], along = 1.0 - q[node + 3];
    const double length = std::sqrt(across * across + along * along);
    return {along / length, across / length};
  }

  /// What makes up X, or X', as the beam tells it.
  static std::array<ChainShare, 4> shares_of(const AncfBeam::Row& row);

  /// Between the order of the AncfBeam and that of the chain.
  void to_beam(const Eigen::ArrayXd& chain, Eigen::VectorXd& beam) const;
  void from_beam(const Eigen::VectorXd& beam, Eigen::ArrayXd& chain) const;

 private:
  struct GaussPoint {
    double chord, first, second;                 // share of chord and end slopes in the slope
    double bend_chord, bend_first, bend_second;  // the same in the curvature times the length
    double weight;
  };

  /// Of the slope at the hinge, closing > 0, with derivatives by X' and U'.
  template <typename Value>
  struct HingeAngle {
    Value angle, by_across, by_along;
  };

  template <typename Value>
  static HingeAngle<Value> hinge_angle(const Value& slope_x, const Value& slope_u) {
    const Value across = -slope_x;
    const Value along = 1.0 - slope_u;
    const Value square = across * across + along * along;
    return {atan2_of(across, along), -along / square, across / square};
  }

  static double atan2_of(double y, double x) { return std::atan2(y, x); }

  template <typename Lanes>
  static Lanes atan2_of(const Lanes& y, const Lanes& x) {
    return y.binaryExpr(x, [](double a, double b) { return std::atan2(a, b); });
  }

  template <int S>
  void add_material_damping(const StageArray<S>& q, const StageArray<S>& v, StageArray<S>& r) const;

  /// Adds M a, a multiple of it.
  template <int S>
  void add_inertia(double factor, const StageArray<S>& a, StageArray<S>& r) const;

  std::vector<BarElement> elements_;
  std::array<GaussPoint, 5> gauss_;
  Hinge hinge_;
  BarDamping damping_;
  ChainMatrix mass_;
  Eigen::ArrayXd inertia_, weight_force_;
  // the same for residual()
  std::vector<AncfNumbers> element_numbers_;
  std::vector<AncfNode> node_numbers_;
  std::array<AncfGaussPoint, 5> gauss_numbers_;
};

template <int S>
void AncfChain::add_inertia(double factor, const StageArray<S>& a, StageArray<S>& r) const {
  for (int i = 0; i < nodes(); ++i) {
    const Eigen::Matrix4d own = factor * mass_.diagonal[static_cast<std::size_t>(i)];
    for (int c = 0; c < 4; c += 2) {
      const int k = 4 * i + c;
      r.col(k) += own(c, c) * a.col(k) + own(c, c + 1) * a.col(k + 1);
      r.col(k + 1) += own(c + 1, c) * a.col(k) + own(c + 1, c + 1) * a.col(k + 1);
      if (i + 1 == nodes()) continue;
      const Eigen::Matrix4d next = factor * mass_.next[static_cast<std::size_t>(i)];
      r.col(k) += next(c, c) * a.col(k + 4) + next(c, c + 1) * a.col(k + 5);
      r.col(k + 1) += next(c + 1, c) * a.col(k + 4) + next(c + 1, c + 1) * a.col(k + 5);
      r.col(k + 4) += next(c, c) * a.col(k) + next(c + 1, c) * a.col(k + 1);
      r.col(k + 5) += next(c, c + 1) * a.col(k) + next(c + 1, c + 1) * a.col(k + 1);
    }
  }
}

template <int S>
void AncfChain::residual(const StageArray<S>& q, const StageArray<S>& a, StageArray<S>& r) const {
  using Lanes = Eigen::Array<double, S, 1>;
  find_residual({.stages = S,
                 .elements = static_cast<int>(elements_.size()),
                 .element = element_numbers_.data(),
                 .node = node_numbers_.data(),
                 .gauss = gauss_numbers_.data(),
                 .q = q.data(),
                 .a = a.data(),
                 .residual = r.data()});
  if (hinge_.spring == 0.0) return;
  const auto hinge = hinge_angle<Lanes>(q.col(1), q.col(3));
  r.col(1) += hinge_.spring * hinge.angle * hinge.by_across;
  r.col(3) += hinge_.spring * hinge.angle * hinge.by_along;
}

template <int S>
void AncfChain::add_damping(const StageArray<S>& q, const StageArray<S>& v,
                            StageArray<S>& r) const {
  using Lanes = Eigen::Array<double, S, 1>;
  if (damping_.mass != 0.0) add_inertia<S>(damping_.mass, v, r);
  if (damping_.stiffness != 0.0) add_material_damping<S>(q, v, r);
  if (hinge_.viscous != 0.0) {
    const auto hinge = hinge_angle<Lanes>(q.col(1), q.col(3));
    const Lanes moment = hinge_.viscous * (hinge.by_across * v.col(1) + hinge.by_along * v.col(3));
    r.col(1) += moment * hinge.by_across;
    r.col(3) += moment * hinge.by_along;
  }
  r.col(0).setZero();
  r.col(2).setZero();
}

/// Kelvin-Voigt: axial stress from the rate of strain, moment from the rate of curvature as a
/// section that turns with the axis sees it, as AncfBeam has it.
template <int S>
void AncfChain::add_material_damping(const StageArray<S>& q, const StageArray<S>& v,
                                     StageArray<S>& r) const {
  using Lanes = Eigen::Array<double, S, 1>;
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const double axial = damping_.stiffness * elements_[e].axial_stiffness;
    const double bending = damping_.stiffness * elements_[e].bending_stiffness;
    const int k = 4 * static_cast<int>(e);
    const double l = elements_[e].length;
    const double over = 1.0 / l;

    struct Direction {
      Lanes chord, first, second, chord_rate, first_rate, second_rate;
      Lanes pull = Lanes::Zero(), moment0 = Lanes::Zero(), moment1 = Lanes::Zero();
    };

    const auto direction = [&](int c) {
      Direction d;
      d.chord = (q.col(c + 4) - q.col(c)) * over;
      d.first = q.col(c + 1);
      d.second = q.col(c + 5);
      d.chord_rate = (v.col(c + 4) - v.col(c)) * over;
      d.first_rate = v.col(c + 1);
      d.second_rate = v.col(c + 5);
      return d;
    };
    Direction x = direction(k), u = direction(k + 2);
    for (const GaussPoint& g : gauss_) {
      const auto slope = [&](const Lanes& chord, const Lanes& first, const Lanes& second) -> Lanes {
        return g.chord * chord + g.first * first + g.second * second;
      };
      const auto bend = [&](const Lanes& chord, const Lanes& first, const Lanes& second) -> Lanes {
        return over * (g.bend_chord * chord + g.bend_first * first + g.bend_second * second);
      };
      const Lanes slope_x = slope(x.chord, x.first, x.second);
      const Lanes slope_y = slope(u.chord, u.first, u.second) - 1.0;
      const Lanes rate_x = slope(x.chord_rate, x.first_rate, x.second_rate);
      const Lanes rate_y = slope(u.chord_rate, u.first_rate, u.second_rate);
      const Lanes bent_x = bend(x.chord, x.first, x.second);
      const Lanes bent_y = bend(u.chord, u.first, u.second);
      const Lanes square = slope_x * slope_x + slope_y * slope_y;
      const Lanes spin = (slope_x * rate_y - slope_y * rate_x) / square;
      const Lanes tension = axial * (slope_x * rate_x + slope_y * rate_y);
      const Lanes moment_x =
          bending * (bend(x.chord_rate, x.first_rate, x.second_rate) + spin * bent_y);
      const Lanes moment_y =
          bending * (bend(u.chord_rate, u.first_rate, u.second_rate) - spin * bent_x);
      const Lanes by_spin = (moment_x * bent_y - moment_y * bent_x) / square;
      const double weight = g.weight * l;
      const auto add = [&](Direction& d, const Lanes& moment, const Lanes& force) {
        d.pull += weight * (g.bend_chord * over * moment + g.chord * force);
        d.moment0 += weight * (g.bend_first * over * moment + g.first * force);
        d.moment1 += weight * (g.bend_second * over * moment + g.second * force);
      };
      add(x, moment_x, tension * slope_x - by_spin * slope_y);
      add(u, moment_y, tension * slope_y + by_spin * slope_x);
    }
    const auto put = [&](int c, const Direction& d) {
      r.col(c) -= d.pull * over;
      r.col(c + 1) += d.moment0;
      r.col(c + 4) += d.pull * over;
      r.col(c + 5) += d.moment1;
    };
    put(k, x);
    put(k + 2, u);
  }
}

}  // namespace impactrig::models
