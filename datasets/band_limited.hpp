// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace impactrig::datasets {

/// Values of a band-limited signal between its samples.
///
/// A sinc of 32 zero crossings on either side under a Kaiser window (beta 9), cut off at 0.9 of the
/// lower of the two Nyquist frequencies: flat to 1e-4 up to 0.8 of it, 90 dB down from it on. The
/// signal is prolonged at both ends by its reflection about the end points.
class BandLimited {
 public:
  static constexpr int crossings = 32;   ///< of the sinc on either side
  static constexpr double beta = 9.0;    ///< of the Kaiser window
  static constexpr double cutoff = 0.9;  ///< of the lower Nyquist frequency

  /// `values` (n) one sample apart must live as long; `stretch` >= 1: how many of them one new
  /// sample stands for, 1 where the rate is not lowered.
  BandLimited(std::span<const double> values, double stretch);

  double operator()(double index) const;  ///< between -0.5 and n - 0.5

  /// At the samples themselves (n): what operator() gives, to the last bit, by weights that are
  /// made once for all of them.
  std::vector<double> at_samples() const;

 private:
  double sample(std::ptrdiff_t i) const;

  std::span<const double> values_;
  double stretch_;
};

}  // namespace impactrig::datasets
