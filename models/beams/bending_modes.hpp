// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "models/rig.hpp"

namespace impactrig::models {

/// Value, slope and curvature of a mode at a point.
struct ModeShape {
  double value = 0.0;
  double slope = 0.0;
  double curvature = 0.0;
};

/// One bending mode of a uniform Euler-Bernoulli bar without further masses, scaled to unit modal
/// mass: ∫ ρA φ² dx = 1 (φ in 1/√kg).
///
/// cantilever (clamped at the hinge in the floating frame, free at the tip):
///   φ ~ cosh βx − cos βx − σ (sinh βx − sin βx), σ = (cosh z + cos z)/(sinh z + sin z), cos z cosh
///   z = −1;
/// pinned-free: φ ~ sin βx + (sin z / sinh z) sinh βx, tan z = tanh z;  z = βL.
/// Exponentials are paired so that no term exceeds 1: accurate to rounding for any mode number.
/// Source: [Blevins1979], tables 8-1.
class BendingMode {
 public:
  /// number from 1, the lowest elastic mode.
  BendingMode(const Beam& beam, Basis basis, int number);

  double angular_frequency() const { return omega_; }  ///< [rad/s]

  ModeShape at(double x) const;

 private:
  Basis basis_;
  double length_;
  double z_;  // βL
  double omega_;
  double scale_ = 1.0;
};

/// The lowest `count` modes.
std::vector<BendingMode> bending_modes(const Beam& beam, Basis basis, int count);

/// Deflection of the elastic hinged bar at x under a unit force there and the inertia loads of the
/// rigid rotation it causes [m/N]: C = ∫ M² / EI + Q² / κGA dx, Q² where it shears. It bounds how
/// far a given elastic and vibration energy E can move the point from where the mean rotation has
/// it: √(2 E C).
double elastic_compliance(const Beam& beam, double x);

/// At most the slowest vibration of the bar clamped at its hinge [rad/s]: by its weakest section
/// all along and every lumped mass at its tip, without shear.
double slowest_vibration(const Beam& beam);

/// Deflection of the point at x under a unit force there of a bar that is clamped at its hinge
/// [m/N].
double clamped_compliance(const Beam& beam, double x);

}  // namespace impactrig::models
