// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace impactrig::acquisition {

void CompensatedSum::add(double term) {
  const double sum = sum_ + term;
  compensation_ += std::abs(sum_) >= std::abs(term) ? (sum_ - sum) + term : (term - sum) + sum_;
  sum_ = sum;
}

double CompensatedSum::value() const {
  return std::isfinite(sum_) ? sum_ + compensation_
                             : sum_;  // an overflow leaves no sense in the rest
}

ChannelStatistics statistics(const datasets::Channel& channel) {
  ChannelStatistics figures;
  figures.samples = channel.size();
  if (figures.samples > 0) {
    figures.first = channel.value(0);
    figures.last = channel.value(figures.samples - 1);
  }
  CompensatedSum sum;
  CompensatedSum squares;
  CompensatedSum imaginary;
  CompensatedSum imaginary_squares;
  figures.min = std::numeric_limits<double>::infinity();
  figures.max = -std::numeric_limits<double>::infinity();
  std::size_t finite = 0;
  const auto take = [&](std::size_t i, double value) {
    const bool is_finite =
        std::isfinite(value) && (!channel.complex() || std::isfinite(channel.imaginary[i]));
    if (!is_finite || !channel.is_valid(i)) ++figures.invalid;
    if (!is_finite) return;
    ++finite;
    sum.add(value);
    squares.add(value * value);
    if (channel.complex()) {
      imaginary.add(channel.imaginary[i]);
      imaginary_squares.add(channel.imaginary[i] * channel.imaginary[i]);
    }
    figures.min = std::min(figures.min, value);
    figures.max = std::max(figures.max, value);
  };
  std::visit(
      [&](const auto& raw) {
        for (std::size_t i = 0; i < raw.size(); ++i)
          take(i, channel.scale * static_cast<double>(raw[i]) + channel.offset);
      },
      channel.raw);

  figures.sum = sum.value();
  figures.sum_of_squares = squares.value();
  figures.complex_sum = {figures.sum, imaginary.value()};
  figures.sum_abs2 = figures.sum_of_squares + imaginary_squares.value();
  if (finite == 0) {
    figures.min = figures.max = figures.mean = figures.rms =
        std::numeric_limits<double>::quiet_NaN();
    return figures;
  }
  figures.mean = figures.sum / static_cast<double>(finite);
  figures.rms = std::sqrt(figures.sum_of_squares / static_cast<double>(finite));
  return figures;
}

}  // namespace impactrig::acquisition
