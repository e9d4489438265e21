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
  double scale = 1.0;                   ///< how long the motion takes from the bend to its turn
  int most_powers = 3;                  ///< of the departure
  double grain = 0.0;                   ///< what two values must differ by to differ at all
  bool may_vibrate = true;
};

/// Place and displacement of a touch, and the speed there [SI per sample].
struct Touched {
  Estimate touch, level;
  Estimate course;    ///< the speed there if the bar does not vibrate
  Estimate approach;  ///< the speed there, vibration and all
};

/// Fits, by least squares over `points`,
///
///   x(t) = c₀ + c₁ s + c₂ s² + Σ d_k s^{(4+k)/2} + a sin ωs + b cos ωs,  the d_k for s = t − t₀ > 0,
///
/// t₀ the touch, k = 1 ... 3. A contact's force that sets in linearly takes a body with a mass to s³
/// from its course and a long beam, whose mass at work grows as the root of time, to s^{5/2}; the
/// next powers are of their series. The bar may vibrate as it comes, by a and b; ω is looked for
/// from half a period over the points up to a period of twice `scale`: what is faster changes sign
/// within the contact. The numbers are means over 1 to 3 powers, without vibration and with one of
/// each ω, by their Akaike weights, those of all ω together once [BurnhamAnderson2002]; the errors
/// hold how far these differ. So vibration that the noise hides widens them by what it may be.
///
/// Source: [BurnhamAnderson2002] for the weights.
Touched fit_touch(const Points& points, const TouchRange& range);

}  // namespace impactrig::acquisition
