// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "models/beams/reissner_beam.hpp"
#include "models/implicit/element_chain.hpp"
#include "models/implicit/stage_array.hpp"

namespace impactrig::models {

/// A ReissnerBeam with the hinge's two displacements kept as coordinates that stay zero. Its forces
/// are evaluated for all stages of a step at once.
class ReissnerChain {
 public:
  using Element = ReissnerElement;
  using Beam = ReissnerBeam;

  /// Derivatives of the internal forces without the hinge's; what is held has no part in them.
  using Tangent = std::vector<Element::Matrix>;

  /// The linear systems of K pairs of stages.
  template <int K>
  using Systems = ElementChain<K, Element::own, Element::values - Element::own>;

  static constexpr int stride = Element::own;  ///< from X of a node to X of the next
  static constexpr int beside = Element::u0;   ///< from X to U

  explicit ReissnerChain(const ReissnerBeam& beam);

  int elements() const { return static_cast<int>(elements_.size()); }

  int coordinates() const { return stride * elements() + Element::values - Element::own; }

  /// Diagonal of the mass matrix, zero for what is held.
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

  /// Of the elements; what is held has a mass of its own.
  const std::vector<Element::Matrix>& masses() const { return masses_; }

  /// Rate of the hinge's angle, closing > 0.
  template <int S>
  Eigen::Array<double, S, 1> hinge_rate(const StageArray<S>&, const StageArray<S>& v) const {
    return -v.col(Element::turn0);
  }

  /// Adds a moment on the hinge, closing > 0, that acts on the bar.
  template <int S>
  void add_hinge_moment(double moment, const StageArray<S>&, StageArray<S>& r) const {
    r.col(Element::turn0) += moment;
  }

  const Hinge& hinge() const { return hinge_; }

  /// Kinetic, elastic and gravitational, of one state.
  BeamEnergy energy(const Eigen::ArrayXd& q, const Eigen::ArrayXd& v) const;

  Tangent make_tangent() const { return Tangent(elements_.size()); }

  void renew(const Eigen::ArrayXd& q, Tangent& tangent) const;

  template <int K>
  Systems<K> make_systems() const {
    return Systems<K>(elements_.size());
  }

  template <int K>
  void factor(const Tangent& tangent, const SystemShares<K>& share, Systems<K>& systems) const {
    systems.factor(masses_, tangent, Element::turn0, share);
  }

  /// visit(X, U, node): the coordinates that turn with the bar, and X of the node they belong to.
  template <typename Visitor>
  void for_each_pair(Visitor&& visit) const {
    for (int node = 0; node < coordinates(); node += stride)
      for (const int place : {Element::x0, Element::xa, Element::xc})
        if (node + place < coordinates()) visit(node + place, node + place + beside, node);
  }

  /// Of the bar at a node, given by its X, closing < 0.
  static BarDirection direction(const Eigen::ArrayXd& q, int node) {
    const double angle = q[node + Element::turn0];
    return {std::cos(angle), std::sin(angle)};
  }

  /// What makes up X, or X', as the beam tells it.
  static std::array<ChainShare, 4> shares_of(const ReissnerBeam::Row& row);

  /// Between the order of the ReissnerBeam and that of the chain.
  void to_beam(const Eigen::ArrayXd& chain, Eigen::VectorXd& beam) const;
  void from_beam(const Eigen::VectorXd& beam, Eigen::ArrayXd& chain) const;

 private:
  template <int S>
  using Lanes = Eigen::Array<double, S, 1>;
  template <int S>
  using Values = Element::Values<Lanes<S>>;

  template <int S>
  static Values<S> gather(const StageArray<S>& x, int first) {
    Values<S> values;
    for (int i = 0; i < Element::values; ++i)
      values[static_cast<std::size_t>(i)] = x.col(first + i);
    return values;
  }

  /// Adds M a, a multiple of it, for one element.
  template <int S>
  static void add_inertia(const Element::Matrix& mass, double factor, const Values<S>& a,
                          Values<S>& r);

  template <int S>
  static void add(const Values<S>& values, int first, StageArray<S>& to) {
    for (int i = 0; i < Element::values; ++i)
      to.col(first + i) += values[static_cast<std::size_t>(i)];
  }

  template <int S>
  static void hold(StageArray<S>& r) {
    r.col(Element::x0).setZero();
    r.col(Element::u0).setZero();
  }

  std::vector<Element> elements_;
  Hinge hinge_;
  BarDamping damping_;
  std::vector<Element::Matrix> masses_;
  Eigen::ArrayXd inertia_, weight_force_;
};

template <int S>
void ReissnerChain::add_inertia(const Element::Matrix& mass, double factor, const Values<S>& a,
                                Values<S>& r) {
  constexpr std::array<std::size_t, 4> line = {Element::x0, Element::xa, Element::xc, Element::x1};
  constexpr std::array<std::size_t, 3> turning = {Element::turn0, Element::turn_b, Element::turn1};
  const auto entry = [&](std::size_t row, std::size_t column) {
    return factor * mass(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column));
  };
  for (const std::size_t row : line)
    for (const std::size_t column : line) {
      r[row] += entry(row, column) * a[column];
      r[row + beside] += entry(row + beside, column + beside) * a[column + beside];
    }
  for (const std::size_t row : turning)
    for (const std::size_t column : turning) r[row] += entry(row, column) * a[column];
}

template <int S>
void ReissnerChain::residual(const StageArray<S>& q, const StageArray<S>& a,
                             StageArray<S>& r) const {
  for (int k = 0; k < coordinates(); ++k) r.col(k).setConstant(-weight_force_[k]);
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const int first = stride * static_cast<int>(e);
    Values<S> force;
    force.fill(Lanes<S>::Zero());
    elements_[e].add_elastic_force<Lanes<S>>(gather<S>(q, first), force);
    add_inertia<S>(masses_[e], 1.0, gather<S>(a, first), force);
    add<S>(force, first, r);
  }
  r.col(Element::turn0) += hinge_.spring * q.col(Element::turn0);
  hold<S>(r);
}

template <int S>
void ReissnerChain::add_damping(const StageArray<S>& q, const StageArray<S>& v,
                                StageArray<S>& r) const {
  for (std::size_t e = 0; e < elements_.size() && damping_ != BarDamping{}; ++e) {
    const int first = stride * static_cast<int>(e);
    const Values<S> rates = gather<S>(v, first);
    Values<S> force;
    force.fill(Lanes<S>::Zero());
    if (damping_.mass != 0.0) add_inertia<S>(masses_[e], damping_.mass, rates, force);
    if (damping_.stiffness != 0.0)
      elements_[e].add_damping_force<Lanes<S>>(damping_.stiffness, gather<S>(q, first), rates,
                                               force);
    add<S>(force, first, r);
  }
  r.col(Element::turn0) += hinge_.viscous * v.col(Element::turn0);
  hold<S>(r);
}

}  // namespace impactrig::models
