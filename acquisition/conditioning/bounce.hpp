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
  bool steady = false;   ///< the halves of the course before are about as fast
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

/// Fits the touch that a bend of a displacement may be (fit_touch) to at least the `window` samples
/// before it and those up to where the motion turns. None where the approach, of a bar that does
/// not vibrate, is less than five of its errors, or the motion does not turn: it has to come back
/// by more than noise among so many samples does.
///
/// Neither touch nor `back` has a stated error: force sets in so slowly that touch is late, by up
/// to a tenth of the contact (docs/conditioning.md has figures). The rebound needs neither: it
/// begins where the displacement is behind `level` by two of its errors.
std::optional<Bounce> fit_bounce(const Trace& trace, const Bend& bend, std::size_t floor,
                                 std::size_t window);

}  // namespace impactrig::acquisition
