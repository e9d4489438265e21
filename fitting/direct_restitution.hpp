// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <limits>
#include <string>
#include <vector>

#include "datasets/impact.hpp"
#include "fitting/rig_file.hpp"

namespace impactrig::fitting {

/// What one source of uncertainty adds to an estimate, as a standard uncertainty in its unit.
struct Contribution {
  std::string source;  ///< "relative delay"
  double std_error = 0.0;
};

/// A number read from a record without a model of the impact.
struct DirectEstimate {
  double value = std::numeric_limits<double>::quiet_NaN();
  double std_error = std::numeric_limits<double>::quiet_NaN();  ///< root sum of squares of `budget`
  std::array<double, 2> ci95 = {std::numeric_limits<double>::quiet_NaN(),
                                std::numeric_limits<double>::quiet_NaN()};
  std::vector<Contribution> budget;  ///< every source, also those that cancel
  std::string absent;                ///< why there is no value; empty where there is one

  bool given() const { return absent.empty(); }
};

/// Contact force over penetration, from touch to separation, on the force's samples.
struct Hysteresis {
  DirectEstimate dissipated;        ///< area of the loop [J]
  DirectEstimate max_penetration;   ///< [m]
  std::vector<double> time;         ///< from first touch as the force shows it [s] (n)
  std::vector<double> penetration;  ///< [m] (n)
  std::vector<double> force;        ///< [N] (n)
};

/// Restitution of the first contact as force and velocity show it, beside what a fit says.
struct DirectRestitution {
  DirectEstimate kinematic;  ///< Newton; see direct_restitution()
  DirectEstimate smoothed;   ///< the same with the mean speed after separation, vibration averaged
  DirectEstimate kinetic;    ///< Poisson
  DirectEstimate energetic;  ///< Stronge
  Hysteresis hysteresis;
  /// On the record's time axis, of the force [s]; NaN where not seen.
  double touch = std::numeric_limits<double>::quiet_NaN();
  double deepest = std::numeric_limits<double>::quiet_NaN();
  double separation = std::numeric_limits<double>::quiet_NaN();
  std::vector<std::string> notes;  ///< what stands between these numbers and the contact's own
};

/// Restitution of an impact's first contact from its record and its sensors alone.
///
///   kinematic = −v(t₂)/v(t₀)                      (Newton)
///   kinetic   = ∫_{t₁}^{t₂} F dt / ∫_{t₀}^{t₁} F dt         (Poisson)
///   energetic = √(−∫_{t₁}^{t₂} F v dt / ∫_{t₀}^{t₁} F v dt)     (Stronge)
///   dissipated = ∫_{t₀}^{t₂} F v dt, penetration = ∫_{t₀} v dt
///
/// F contact force [N], v speed of the struck point [m/s, closing > 0]. t₀ first touch and t₂ first
/// separation: the force's flanks, continued to zero. t₁ greatest penetration: where v crosses
/// zero. These are the definitions of Simulation::restitution where the force ends as the surfaces
/// part: v(t₂) is the speed of the point at the instant of separation, vibration included;
/// `smoothed` has the mean after it instead. v(t₀)
/// is a line through the samples before touch, v(t₂) a parabola about separation. Both channels are
/// first freed of their sensor's chain (undo_chain) and set on one clock. Without a velocity the
/// displacement is differentiated.
///
/// Uncertainty. Noise: 256 repetitions of the record with noise of the stated size and correlation
/// added (the fixed draws make the result repeatable; itself 4.5 %); the force's with the speed
/// smoothed, so that an instant that moves does not count the motion's noise again. Relative delay,
/// u² = u_F² + u_v²: shifts by ±√3 u and 0, weighed 1/6, 2/3, 1/6, the Gauss-Hermite rule, so that
/// a bent dependence counts as it is. Gains, force baseline, velocity zero, touch and separation:
/// half the difference of one standard uncertainty up and down; gains cancel in the ratios. The
/// force's baseline may wander by the trend seen before touch. A velocity's zero is not seen before
/// touch; it is taken to be as uncertain as the velocity's mean over the contact is off zero, since
/// a penetration that begins at zero ends there too, lasting indentation aside, but no less than
/// touch and separation leave open. Of the correction for the sensors' chain a tenth is taken as
/// uncertain, and all of what the sampling does not resolve. The interval is value ± the root sum
/// of squares of 1.96 u, the delay's part being the change at ±1.96 u itself.
///
/// What cannot be estimated has a sentence in `absent` instead. Valid where the laser looks at the
/// struck point and the stop is rigid; `notes` tells otherwise.
///
/// Source: [Stronge2000], [GUM2008].
DirectRestitution direct_restitution(const datasets::Impact& impact, const RigFile& rig);

}  // namespace impactrig::fitting
