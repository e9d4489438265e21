// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "datasets/conditioning.hpp"
#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// Values of a band-limited signal between its samples.
///
/// A sinc of 32 zero crossings on either side under a Kaiser window (beta 9), cut off at 0.9 of the
/// lower of the two Nyquist frequencies: flat to 1e-4 up to 0.8 of it, 90 dB down from it on. The
/// signal is prolonged at both ends by its reflection about the end points.
class BandLimited {
 public:
  /// `values` (n) one sample apart must live as long; `stretch` >= 1: how many of them one new
  /// sample stands for, 1 where the rate is not lowered.
  BandLimited(std::span<const double> values, double stretch);

  double operator()(double index) const;  ///< between -0.5 and n - 0.5

 private:
  double sample(std::ptrdiff_t i) const;

  std::span<const double> values_;
  double stretch_;
  std::vector<double> kernel_;  ///< one side, 4096 values a zero crossing
};

/// Puts a channel on a clock of another rate: same start, as many samples as fit. Uneven times are
/// first joined by modified Akima cubics [Akima1970] at their mean rate or the new one, whichever
/// is higher: a step there is not band-limited. A new sample is invalid where one within a step of
/// either rate is.
///
/// Throws std::invalid_argument when the rate is not positive, or the channel has fewer than 4
/// samples or would get fewer than 16 or more than 2²⁶.
datasets::Edit resample(datasets::Channel& channel, const datasets::Resample& to);

}  // namespace impactrig::acquisition
