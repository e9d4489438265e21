// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

namespace impactrig::fitting {

/// Contact force and speed of the struck point on one clock.
struct ContactRecord {
  double start = 0.0;            ///< of sample 0 [s]
  double interval = 0.0;         ///< [s]
  std::vector<double> force;     ///< compression > 0 [N] (n)
  std::vector<double> velocity;  ///< closing > 0 [m/s] (n)

  double time(std::size_t i) const { return start + interval * static_cast<double>(i); }
};

/// What happens in a contact and when; NaN where the record does not show it.
struct ContactPhases {
  double touch = std::numeric_limits<double>::quiet_NaN();        ///< t₀ [s]
  double deepest = std::numeric_limits<double>::quiet_NaN();      ///< t₁ [s]
  double separation = std::numeric_limits<double>::quiet_NaN();   ///< t₂ [s]
  double touch_error = 0.0, separation_error = 0.0;               ///< standard uncertainty [s]
  double approach = std::numeric_limits<double>::quiet_NaN();     ///< v(t₀) [m/s]
  double rebound = std::numeric_limits<double>::quiet_NaN();      ///< −v(t₂) [m/s]
  double smoothed = std::numeric_limits<double>::quiet_NaN();     ///< −mean of v after t₂ [m/s]
  double smoothed_error = 0.0;                                    ///< of that mean, by swings [m/s]
  double impulse_in = std::numeric_limits<double>::quiet_NaN();   ///< from t₀ to t₁ [N s]
  double impulse_out = std::numeric_limits<double>::quiet_NaN();  ///< from t₁ to t₂ [N s]
  double work_in = std::numeric_limits<double>::quiet_NaN();      ///< likewise [J]
  double work_out = std::numeric_limits<double>::quiet_NaN();     ///< given back > 0 [J]
  double depth = std::numeric_limits<double>::quiet_NaN();        ///< greatest penetration [m]
  double drift = 0.0;  ///< penetration left at t₂ [m]: the velocity's zero, or an indentation
};

/// Finds the phases of a contact that is known to lie about [begin, end] of the record's clock.
///
/// First touch and separation: the force's flank between L and 4 L, but no more than 2 % of the
/// contact, a straight line continued to zero; L is 0.5 % of the peak at touch and 1 % at
/// separation, or five standard deviations before touch where that is more. The falling flank,
/// often flat, is that of means over 4 % of the contact. Their uncertainty is how far the line was
/// continued, and one sample, each over √3: a force that begins as δ^(3/2) is met half that way
/// late. Integrals are trapezoids, with fractions of a sample at both ends. Values and crossings of
/// the speed are those of a parabola over 3 % of the contact to both sides, its weights falling to
/// zero at the ends.
///
/// `touch_shift` and `separation_shift` [s] move these instants, to learn what their errors do.
ContactPhases contact_phases(const ContactRecord& record, double begin, double end,
                             double touch_shift = 0.0, double separation_shift = 0.0);

/// Means over 2 m + 1 samples; the first and last m stay as they are. A straight flank keeps its
/// place.
std::vector<double> running_means(const std::vector<double>& values, std::size_t m);

/// Penetration from first touch on, at the record's samples (n) [m].
std::vector<double> penetration_of(const ContactRecord& record, double touch);

}  // namespace impactrig::fitting
