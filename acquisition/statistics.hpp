// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "acquisition/recording_reader.hpp"
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

/// Sum of doubles with Neumaier's compensation [Neumaier1974]: the error does not grow with the
/// number of terms.
class CompensatedSum {
 public:
  void add(double term) {
    const double sum = sum_ + term;
    compensation_ += std::abs(sum_) >= std::abs(term) ? (sum_ - sum) + term : (term - sum) + sum_;
    sum_ = sum;
  }

  void add(const CompensatedSum& other);
  double value() const;

 private:
  double sum_ = 0.0;
  double compensation_ = 0.0;
};

/// Gathers the figures of a channel block by block.
class StatisticsGathering {
 public:
  StatisticsGathering();

  /// The next samples; `scale` and `offset` are the channel's.
  void add(const SampleBlock& block, double scale, double offset);

  ChannelStatistics figures() const;

 private:
  void add_finite(std::span<const double> values);
  void add_any(const SampleBlock& block);

  /// Sums side by side, which the processor adds at once.
  static constexpr std::size_t lanes = 8;

  std::array<CompensatedSum, lanes> sums_;
  std::array<CompensatedSum, lanes> squares_;
  std::array<double, lanes> smallest_;
  std::array<double, lanes> largest_;
  CompensatedSum imaginary_;
  CompensatedSum imaginary_squares_;
  std::uint64_t finite_ = 0;
  ChannelStatistics counts_;  // samples, invalid, first and last
  std::vector<double> values_;
};

ChannelStatistics statistics(const datasets::Channel& channel);

}  // namespace impactrig::acquisition
