// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace impactrig::acquisition {

/// A number and its standard error.
struct Estimate {
  double value = 0.0, error = 0.0;
};

/// Means of neighbouring samples, and where they lie [samples].
struct Points {
  std::vector<double> at, values;
  double per_point = 1.0;  ///< samples
};

/// Where a touch is looked for, and what the samples can tell.
struct TouchRange {
  double earliest = 0.0, latest = 0.0;  ///< [samples]
  double course_end = 0.0;              ///< before it there is no contact [samples]
  double scale = 1.0;                   ///< how long the motion takes from touch to turn [samples]
  int most_powers = 1;                  ///< of the departure
  double grain = 0.0;                   ///< what two values must differ by to differ at all
  bool may_vibrate = true;
};

/// Place and displacement of a touch, and the speed there [SI per sample].
struct Touched {
  Estimate touch, level;
  Estimate course;        ///< the speed there if the bar does not vibrate
  Estimate approach;      ///< the speed there, vibration and all
  double variance = 0.0;  ///< of what the best fit leaves of a point [SI^2]
};

/// Fits, by least squares over `points`,
///
///   x(t) = c₀ + c₁ s + c₂ s² + Σ d_k s^{(4+k)/2} + a sin ωs + b cos ωs,  the d_k for s = t − t₀ >
///   0,
///
/// t₀ the touch, k = 1 ... `most_powers`. A contact's force that sets in linearly takes a body with
/// a mass to s³ from its course and a long beam, whose mass at work grows as the root of time, to
/// s^{5/2}; the next powers are of their series. The bar may vibrate as it comes, slower than it
/// does from touch to turn and back, or faster: of each the ω is taken with which the course before
/// leaves least.
///
/// The numbers are means over the powers, without and with these vibrations, by their Akaike
/// weights [BurnhamAnderson2002]; the errors hold how far these differ. So a vibration that the
/// noise hides widens them by what it may be, unless it is a fast one, which counts where it shows.
/// Left out are vibrations faster than the course, with which the bar would not come all the time.
///
/// Source: [BurnhamAnderson2002] for the weights.
Touched fit_touch(const Points& points, const TouchRange& range);

/// The variance of what a bar that swings and touches nothing leaves of a point [SI^2]:
///
///   x(t) = c₀ + c₁ s + c₂ s² + (a + a' s) sin ωs + (b + b' s) cos ωs,
///
/// of all ω up to `fastest` [radians per sample] and an eighth of the points' rate the best. 0
/// where there are too few points to say.
double variance_beside_swing(const Points& points, double fastest);

}  // namespace impactrig::acquisition
