// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "models/implicit/ancf_chain.hpp"

namespace impactrig::models {

/// Holds the slope vector r_x = (X', U' − 1) of a chain's first node at an angle θ, closing > 0,
/// that is given for each stage of a step; it may stretch:
///
///   n · r_x = 0,   n = (−cos θ, sin θ) across it, t = (−sin θ, −cos θ) along it, r_x = s t
///
/// The equation of motion along n gives way to n · r̈_x = 2 ṡ θ̇ + s θ̈, and tells the moment that
/// this takes.
template <int S>
class SlopeHold {
 public:
  using Lanes = Eigen::Array<double, S, 1>;

  explicit SlopeHold(const AncfChain& chain)
      : own_(chain.mass()),
        mass_(own_),
        inertia_(chain.inertia()[1]) {}

  static double angle_of(const Eigen::ArrayXd& q) { return std::atan2(-q[1], 1.0 - q[3]); }

  /// At rest.
  void stop(double angle) {
    across_.setConstant(-std::cos(angle));
    along_.setConstant(std::sin(angle));
    rate_.setZero();
    acceleration_.setZero();
  }

  /// Turning, at the stages.
  void turn(const Lanes& angle, const Lanes& rate, const Lanes& acceleration) {
    across_ = -angle.cos();
    along_ = angle.sin();
    rate_ = rate;
    acceleration_ = acceleration;
  }

  /// Puts a state exactly there.
  static void place(double angle, double rate, Eigen::ArrayXd& q, Eigen::ArrayXd& v) {
    const double sine = std::sin(angle), cosine = std::cos(angle);
    const double slope = -sine * q[1] - cosine * (q[3] - 1.0);
    const double stretching = -sine * v[1] - cosine * v[3];
    q[1] = -sine * slope;
    q[3] = 1.0 - cosine * slope;
    v[1] = -sine * stretching - cosine * slope * rate;
    v[3] = -cosine * stretching + sine * slope * rate;
  }

  /// Takes n · r_x at an angle out of the tangent, and apart in the mass matrix.
  void release(double angle, AncfChain::Tangent& tangent) {
    const Eigen::Vector4d normal(0.0, -std::cos(angle), 0.0, std::sin(angle));
    const Eigen::Matrix4d projector = Eigen::Matrix4d::Identity() - normal * normal.transpose();
    const auto free = [&](Eigen::Matrix4d& diagonal, Eigen::Matrix4d& next) {
      diagonal = projector * diagonal * projector;
      next = projector * next;
    };
    free(tangent.stiffness.diagonal[0], tangent.stiffness.next[0]);
    tangent.hinge.setZero();
    mass_.diagonal[0] = own_.diagonal[0];
    mass_.next[0] = own_.next[0];
    free(mass_.diagonal[0], mass_.next[0]);
    mass_.diagonal[0] += inertia_ * normal * normal.transpose();
  }

  /// The linear systems after release().
  template <int K>
  void factor(const AncfChain::Tangent& tangent, const SystemShares<K>& share,
              AncfChain::Systems<K>& systems) const {
    systems.factor(mass_, tangent.stiffness, tangent.hinge, share);
  }

  /// Replaces the equation along n in a residual.
  void constrain(const StageArray<S>& q, const StageArray<S>& v, const StageArray<S>& a,
                 StageArray<S>& r) const {
    const Lanes slope = across_ * (q.col(3) - 1.0) - along_ * q.col(1);
    const Lanes stretching = across_ * v.col(3) - along_ * v.col(1);
    const Lanes turning =
        across_ * a.col(1) + along_ * a.col(3) - 2.0 * stretching * rate_ - slope * acceleration_;
    const Lanes change = inertia_ * turning - (across_ * r.col(1) + along_ * r.col(3));
    r.col(1) += across_ * change;
    r.col(3) += along_ * change;
  }

  const Lanes& rate() const { return rate_; }

  /// The moment that holds, closing > 0 [N m], from the residual before constrain().
  Lanes moment(const StageArray<S>& q, const StageArray<S>& r) const {
    const Lanes slope = across_ * (q.col(3) - 1.0) - along_ * q.col(1);
    return slope * (across_ * r.col(1) + along_ * r.col(3));
  }

 private:
  ChainMatrix own_, mass_;
  double inertia_;
  Lanes across_ = -Lanes::Ones(), along_ = Lanes::Zero();  // n
  Lanes rate_ = Lanes::Zero(), acceleration_ = Lanes::Zero();
};

}  // namespace impactrig::models
