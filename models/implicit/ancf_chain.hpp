// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "models/beams/ancf.hpp"
#include "models/implicit/block_tridiagonal.hpp"

namespace impactrig::models {

/// Values of S stages side by side (lanes), a column for each coordinate of a chain: 4 node + c, c
/// = X, X', U, U'.
template <int S>
using StageArray = Eigen::Array<double, S, Eigen::Dynamic>;

/// An AncfBeam ordered node by node, the hinge's two positions kept as coordinates that stay zero.
/// Its forces are evaluated for all stages of a step at once.
class AncfChain {
 public:
  explicit AncfChain(const AncfBeam& beam);

  int nodes() const { return static_cast<int>(elements_.size()) + 1; }

  int coordinates() const { return 4 * nodes(); }

  const ChainMatrix& mass() const { return mass_; }

  /// Diagonal of the mass matrix, zero for what is held (4 nodes).
  const Eigen::ArrayXd& inertia() const { return inertia_; }

  /// M a + internal forces − weight; what is held is left at zero.
  template <int S>
  void residual(const StageArray<S>& q, const StageArray<S>& a, StageArray<S>& r) const;

  /// Kinetic, elastic and gravitational, of one state (4 nodes each).
  BeamEnergy energy(const Eigen::ArrayXd& q, const Eigen::ArrayXd& v) const;

  /// ∂(internal forces)/∂q; what is held has no part in it.
  void stiffness(const Eigen::ArrayXd& q, ChainMatrix& k) const;

  /// Between the order of the AncfBeam and that of the chain.
  void to_beam(const Eigen::ArrayXd& chain, Eigen::VectorXd& beam) const;
  void from_beam(const Eigen::VectorXd& beam, Eigen::ArrayXd& chain) const;

 private:
  struct GaussPoint {
    double chord, first, second;  // share of chord and end slopes in the slope
    double weight;
  };

  template <int S>
  void add_inertia(const StageArray<S>& a, StageArray<S>& r) const;

  std::vector<AncfBeam::Element> elements_;
  std::array<GaussPoint, 5> gauss_;
  double axial_stiffness_, bending_stiffness_;
  ChainMatrix mass_;
  Eigen::ArrayXd inertia_, weight_force_;
};

template <int S>
void AncfChain::add_inertia(const StageArray<S>& a, StageArray<S>& r) const {
  for (int i = 0; i < nodes(); ++i) {
    const Eigen::Matrix4d& own = mass_.diagonal[static_cast<std::size_t>(i)];
    for (int c = 0; c < 4; c += 2) {
      const int k = 4 * i + c;
      r.col(k) += own(c, c) * a.col(k) + own(c, c + 1) * a.col(k + 1);
      r.col(k + 1) += own(c + 1, c) * a.col(k) + own(c + 1, c + 1) * a.col(k + 1);
      if (i + 1 == nodes()) continue;
      const Eigen::Matrix4d& next = mass_.next[static_cast<std::size_t>(i)];
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
  for (int k = 0; k < coordinates(); ++k) r.col(k).setConstant(-weight_force_[k]);
  add_inertia<S>(a, r);
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const int k = 4 * static_cast<int>(e);
    const double l = elements_[e].length;
    const double over = 1.0 / l;
    const double bending = bending_stiffness_ * over;
    const Lanes chord_x = (q.col(k + 4) - q.col(k)) * over;
    const Lanes chord_u = (q.col(k + 6) - q.col(k + 2)) * over;
    const Lanes first_x = q.col(k + 1), second_x = q.col(k + 5);
    const Lanes first_u = q.col(k + 3), second_u = q.col(k + 7);
    // end rotations against the chord
    const Lanes bent_x0 = first_x - chord_x, bent_x1 = second_x - chord_x;
    const Lanes bent_u0 = first_u - chord_u, bent_u1 = second_u - chord_u;
    Lanes moment_x0 = bending * (4.0 * bent_x0 + 2.0 * bent_x1);
    Lanes moment_x1 = bending * (2.0 * bent_x0 + 4.0 * bent_x1);
    Lanes moment_u0 = bending * (4.0 * bent_u0 + 2.0 * bent_u1);
    Lanes moment_u1 = bending * (2.0 * bent_u0 + 4.0 * bent_u1);
    Lanes pull_x = -(moment_x0 + moment_x1);
    Lanes pull_u = -(moment_u0 + moment_u1);
    for (const GaussPoint& g : gauss_) {
      const Lanes slope_x = g.chord * chord_x + g.first * first_x + g.second * second_x;
      const Lanes slope_u = g.chord * chord_u + g.first * first_u + g.second * second_u;
      const Lanes strain = 0.5 * (slope_x * slope_x + slope_u * slope_u) - slope_u;
      const Lanes tension = (axial_stiffness_ * l * g.weight) * strain;
      const Lanes along_x = tension * slope_x;
      const Lanes along_u = tension * (slope_u - 1.0);
      pull_x += g.chord * along_x;
      moment_x0 += g.first * along_x;
      moment_x1 += g.second * along_x;
      pull_u += g.chord * along_u;
      moment_u0 += g.first * along_u;
      moment_u1 += g.second * along_u;
    }
    pull_x *= over;
    pull_u *= over;
    r.col(k) -= pull_x;
    r.col(k + 1) += moment_x0;
    r.col(k + 2) -= pull_u;
    r.col(k + 3) += moment_u0;
    r.col(k + 4) += pull_x;
    r.col(k + 5) += moment_x1;
    r.col(k + 6) += pull_u;
    r.col(k + 7) += moment_u1;
  }
  r.col(0).setZero();
  r.col(2).setZero();
}

}  // namespace impactrig::models
