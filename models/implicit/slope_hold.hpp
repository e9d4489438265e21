// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "models/implicit/ancf_chain.hpp"

namespace impactrig::models {

/// Holds the slope vector r_x = (X', U' − 1) of a chain's first node at the angle θ it has, closing
/// > 0, where it may still stretch: n · r_x = 0, n = (−cos θ, sin θ) across it. The equation of
/// motion along n gives way to n · r̈_x = 0, and tells the moment that this takes.
template <int S>
class SlopeHold {
 public:
  using Lanes = Eigen::Array<double, S, 1>;

  explicit SlopeHold(const AncfChain& chain)
      : own_(chain.mass()),
        mass_(own_),
        inertia_(chain.inertia()[1]) {}

  /// Takes the angle of a state, and the slope's turning from it.
  void stop(const Eigen::ArrayXd& q, Eigen::ArrayXd& v) {
    const double angle = std::atan2(-q[1], 1.0 - q[3]);
    across_ = -std::cos(angle);
    along_ = std::sin(angle);
    const double turning = across_ * v[1] + along_ * v[3];
    v[1] -= turning * across_;
    v[3] -= turning * along_;
    mass_ = own_;
    free(mass_.diagonal[0], mass_.next[0]);
    mass_.diagonal[0] += inertia_ * normal() * normal().transpose();
  }

  /// The mass matrix, n · r_x apart from all else.
  const ChainMatrix& mass() const { return mass_; }

  /// Takes n · r_x out of the stiffness of bar and hinge.
  void release(ChainMatrix& stiffness, Eigen::Matrix4d& hinge) const {
    free(stiffness.diagonal[0], stiffness.next[0]);
    hinge.setZero();
  }

  /// Replaces the equation along n in a residual.
  void constrain(const StageArray<S>& a, StageArray<S>& r) const {
    const Lanes change = inertia_ * (across_ * a.col(1) + along_ * a.col(3)) -
                         (across_ * r.col(1) + along_ * r.col(3));
    r.col(1) += across_ * change;
    r.col(3) += along_ * change;
  }

  /// The moment that holds, closing > 0 [N m], from the residual before constrain().
  Lanes moment(const StageArray<S>& q, const StageArray<S>& r) const {
    const Lanes slope = (q.col(1).square() + (q.col(3) - 1.0).square()).sqrt();
    return slope * (across_ * r.col(1) + along_ * r.col(3));
  }

 private:
  Eigen::Vector4d normal() const { return {0.0, across_, 0.0, along_}; }

  void free(Eigen::Matrix4d& diagonal, Eigen::Matrix4d& next) const {
    const Eigen::Matrix4d projector = Eigen::Matrix4d::Identity() - normal() * normal().transpose();
    diagonal = projector * diagonal * projector;
    next = projector * next;
  }

  ChainMatrix own_, mass_;
  double inertia_;
  double across_ = -1.0, along_ = 0.0;  // n
};

}  // namespace impactrig::models
