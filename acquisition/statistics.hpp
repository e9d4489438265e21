// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstddef>

#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// Figures of a channel in its own unit, over its finite samples, valid or not. Of a complex
/// channel, `first` to `rms` are of the real part. Where there is no finite sample, min, max, mean
/// and rms are not numbers; first and last are those samples whatever they are.
struct ChannelStatistics {
  std::size_t samples = 0;
  std::size_t invalid = 0;  ///< flagged as not valid, or not finite
  double first = 0.0;
  double last = 0.0;
  double min = 0.0;
  double max = 0.0;
  double mean = 0.0;
  double rms = 0.0;             ///< about zero
  double sum = 0.0;             ///< compensated: exact to about one rounding
  double sum_of_squares = 0.0;  ///< likewise
  std::complex<double> complex_sum{};
  double sum_abs2 = 0.0;  ///< of |z|^2
};

ChannelStatistics statistics(const datasets::Channel& channel);

/// Sum of doubles with Neumaier's compensation [Neumaier1974]: the error does not grow with the
/// number of terms.
class CompensatedSum {
 public:
  void add(double term);
  double value() const;

 private:
  double sum_ = 0.0;
  double compensation_ = 0.0;
};

}  // namespace impactrig::acquisition
