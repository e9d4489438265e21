// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "datasets/conditioning.hpp"
#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// What was done, and what the result holds that nobody recorded.
struct Resampled {
  datasets::Edit edit;
  double lost = 0.0;         ///< of the largest departure from the median
  std::size_t gaps = 0;      ///< in uneven times, with new samples in them
  std::size_t in_gaps = 0;   ///< new samples in them, all marked invalid
  double longest_gap = 0.0;  ///< from sample to sample [s]
};

/// Puts a channel on a clock of another rate: same start, as many samples as fit. Uneven times are
/// first joined by modified Akima cubics [Akima1970] at their mean rate or the new one, whichever
/// is higher: a step there is not band-limited. A new sample is invalid where one within a step of
/// either rate is, and in gaps: where a step is longer than 2.5 times the usual one (the median of
/// 7) before it and behind it, so that two samples or more are missing.
///
/// Throws std::invalid_argument when the rate is not positive, or the channel has fewer than 4
/// samples or would get fewer than 16 or more than 2²⁶ and than twice as many as it has.
Resampled resample(datasets::Channel& channel, const datasets::Resample& to);

}  // namespace impactrig::acquisition
