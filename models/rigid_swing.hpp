// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "models/rig.hpp"

namespace impactrig::models {

/// The straight bar turning about its hinge as a rigid body, away from the stop:
///
///   I φ̈ = S g sin(γ − φ) − k φ − c φ̇ − T sign φ̇
///
/// φ is the angle from touch [rad, closing > 0], γ the direction of gravity (0: the bar hangs when
/// it touches, and the first term is −S g sin φ), I and S the second and first moment of mass about
/// the hinge [kg m², kg m], k, c and T of the hinge, c with the bar's mass damping α I.
class RigidSwing {
 public:
  explicit RigidSwing(const Rig& rig);

  /// Of weight and spring, zero at touch [J].
  double potential(double angle) const;

  double acceleration(double angle, double rate) const;  ///< φ̈, friction apart [rad/s²]

  /// What weight and spring could set free from an angle on [J].
  double available(double angle) const;

  /// Rate with which the bar arrives at touch when it is released from rest at an angle before it
  /// [rad/s]; none when it does not arrive.
  std::optional<double> rate_after_release(double angle) const;

  struct Arrival {
    double rate;  ///< [rad/s]
    double time;  ///< since the release [s]
  };

  /// That rate and when it arrives.
  std::optional<Arrival> arrive(double angle) const;

  struct State {
    double angle = 0.0;  ///< [rad]
    double rate = 0.0;   ///< [rad/s]
  };

  /// The swing about touch, linearised: at a time from touch [s] of a bar that touches at a rate,
  /// against friction all the way.
  State near_touch(double time, double rate) const;

  /// Whether weight presses the bar against the stop, and a bar that leaves it at an angle < 0 with
  /// a rate < 0 has not the energy to fall over to the other side.
  bool pulled_back(double angle, double rate) const;

  /// Time a bar that is not pulled back takes at least until it swings back to the stop [s].
  double shortest_return() const;

 private:
  double left(double angle, double to_go) const;
  std::optional<Arrival> integrate(double angle) const;

  double inertia_;         // I
  double along_, across_;  // S g cos γ, S g sin γ [N m]
  double spring_, viscous_, friction_;
};

}  // namespace impactrig::models
