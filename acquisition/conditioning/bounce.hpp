// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>

#include "acquisition/conditioning/course_bends.hpp"
#include "acquisition/conditioning/touch_fit.hpp"
#include "acquisition/conditioning/trace.hpp"

namespace impactrig::acquisition {

/// A touch as a displacement shows it. Places are in samples and have fractions, speeds in SI per
/// sample.
struct Bounce {
  double sign = 1.0;     ///< of the approach: 1 where the displacement grows
  double touch = 0.0;    ///< first touch
  double level = 0.0;    ///< displacement there [SI]
  std::size_t turn = 0;  ///< the farthest sample behind it
  Estimate course{};     ///< as `approach`, if the bar did not vibrate before
  Estimate approach{};   ///< at touch, along `sign`, > 0
  std::optional<double>
      back{};  ///< where it is at `level` again; none where the record ends before

  /// The mean speed back over the stretch [from, to], and how far that of its thirds scatters.
  struct Return {
    double from = 0.0, to = 0.0;
    Estimate speed{};
    double vibration = 0.0;  ///< standard error of the mean by its thirds [SI per sample]
  };

  std::optional<Return>
      rebound{};  ///< none where less than a contact's duration of it was recorded
};

/// The digitiser step of a steady motion, whose samples hardly repeat: that of its second
/// differences.
double grain_of_motion(const Trace& trace);

/// Fits the touch that a bend of a displacement may be: least squares over the `window` samples
/// before it and those up to where the motion turns,
///
///   x(t) = c₀ + c₁ s + c₂ s² + Σ d_k s^{(4+k)/2} for s = t − t₀ > 0, k = 1 ... 3,
///
/// t₀ the touch. A contact's force that sets in linearly takes a body with a mass to s³ from its
/// course and a long beam, whose mass at work grows as the root of time, to s^{5/2}; the next
/// powers are of their series. Touch, c₀ and c₁ are the means over 1 to 3 powers by their Akaike
/// weights, and their errors hold how far these differ [BurnhamAnderson2002]. None where the
/// approach is less than five of its errors, or the motion does not turn.
///
/// Neither touch nor `back` has a stated error: force sets in so slowly that noise hides it, and at
/// noise of 1 % of the excursion touch may be early by more than the contact lasts
/// (docs/conditioning.md has figures). The rebound needs neither: it begins where the displacement
/// is behind `level` by two of its errors.
///
/// Source: [BurnhamAnderson2002] for the weights.
std::optional<Bounce> fit_bounce(const Trace& trace, const Bend& bend, std::size_t floor,
                                 std::size_t window);

}  // namespace impactrig::acquisition
