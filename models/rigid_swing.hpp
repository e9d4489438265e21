// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "models/rig.hpp"

namespace impactrig::models {

/// The straight bar turning about its hinge as a rigid body, away from the stop:
///
///   I φ̈ = −S g sin φ − k φ − c φ̇
///
/// φ is the angle from hanging straight [rad, closing > 0], I and S the second and first moment of
/// mass about the hinge [kg m², kg m], k and c of the hinge, c with the bar's mass damping α I.
class RigidSwing {
 public:
  explicit RigidSwing(const Rig& rig);

  /// Of weight and spring, zero at touch [J].
  double potential(double angle) const;

  double acceleration(double angle, double rate) const;  ///< φ̈ [rad/s²]

  /// Rate with which the bar arrives at touch when it is released from rest at an angle before it
  /// [rad/s]; none when it does not arrive.
  std::optional<double> rate_after_release(double angle) const;

  struct State {
    double angle = 0.0;  ///< [rad]
    double rate = 0.0;   ///< [rad/s]
  };

  /// The swing about touch, linearised: at a time from touch [s] of a bar that touches at a rate.
  State near_touch(double time, double rate) const;

  /// Time a bar that leaves the stop takes at least until it swings back to it [s].
  double shortest_return() const;

 private:
  double inertia_;  // I
  double weight_;   // S g [N m]
  double spring_, viscous_;
};

}  // namespace impactrig::models
