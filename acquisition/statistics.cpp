// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace impactrig::acquisition {

void CompensatedSum::add(const CompensatedSum& other) {
  add(other.sum_);
  compensation_ += other.compensation_;
}

double CompensatedSum::value() const {
  return std::isfinite(sum_) ? sum_ + compensation_
                             : sum_;  // an overflow leaves no sense in the rest
}

StatisticsGathering::StatisticsGathering() {
  smallest_.fill(std::numeric_limits<double>::infinity());
  largest_.fill(-std::numeric_limits<double>::infinity());
}

void StatisticsGathering::add(const SampleBlock& block, double scale, double offset) {
  const std::size_t n = block.size();
  if (n == 0) return;
  values_.resize(n);
  std::visit(
      [&](auto raw) {
        for (std::size_t i = 0; i < n; ++i)
          values_[i] = scale * static_cast<double>(raw[i]) + offset;
      },
      block.raw);
  if (counts_.samples == 0) counts_.first = values_.front();
  counts_.last = values_.back();
  counts_.samples += n;
  double zero = 0.0;  // times zero: zero, or not a number
  for (const double value : values_) zero += 0.0 * value;
  if (zero == 0.0 && block.imaginary.empty() && block.valid.empty())
    add_finite(values_);
  else
    add_any(block);
}

void StatisticsGathering::add_finite(std::span<const double> values) {
  finite_ += values.size();
  const std::size_t whole = values.size() / lanes * lanes;
  for (std::size_t i = 0; i < whole; i += lanes)
    for (std::size_t k = 0; k < lanes; ++k) {
      const double value = values[i + k];
      sums_[k].add(value);
      squares_[k].add(value * value);
      smallest_[k] = std::min(smallest_[k], value);
      largest_[k] = std::max(largest_[k], value);
    }
  for (std::size_t i = whole; i < values.size(); ++i) {
    sums_[0].add(values[i]);
    squares_[0].add(values[i] * values[i]);
    smallest_[0] = std::min(smallest_[0], values[i]);
    largest_[0] = std::max(largest_[0], values[i]);
  }
}

void StatisticsGathering::add_any(const SampleBlock& block) {
  for (std::size_t i = 0; i < values_.size(); ++i) {
    const bool finite =
        std::isfinite(values_[i]) && (block.imaginary.empty() || std::isfinite(block.imaginary[i]));
    if (!finite || (!block.valid.empty() && block.valid[i] == 0)) ++counts_.invalid;
    if (!finite) continue;
    add_finite({&values_[i], 1});
    if (block.imaginary.empty()) continue;
    imaginary_.add(block.imaginary[i]);
    imaginary_squares_.add(block.imaginary[i] * block.imaginary[i]);
  }
}

ChannelStatistics StatisticsGathering::figures() const {
  CompensatedSum sum;
  CompensatedSum squares;
  ChannelStatistics figures = counts_;
  figures.min = *std::ranges::min_element(smallest_);
  figures.max = *std::ranges::max_element(largest_);
  for (std::size_t k = 0; k < lanes; ++k) {
    sum.add(sums_[k]);
    squares.add(squares_[k]);
  }
  figures.sum = sum.value();
  figures.sum_of_squares = squares.value();
  figures.complex_sum = {figures.sum, imaginary_.value()};
  figures.sum_abs2 = figures.sum_of_squares + imaginary_squares_.value();
  if (finite_ == 0) {
    figures.min = figures.max = figures.mean = figures.rms =
        std::numeric_limits<double>::quiet_NaN();
    return figures;
  }
  figures.mean = figures.sum / static_cast<double>(finite_);
  figures.rms = std::sqrt(figures.sum_of_squares / static_cast<double>(finite_));
  return figures;
}

ChannelStatistics statistics(const datasets::Channel& channel) {
  StatisticsGathering gathering;
  SampleBlock block;
  std::visit([&](const auto& raw) { block.raw = std::span(raw); }, channel.raw);
  block.imaginary = channel.imaginary;
  block.valid = channel.valid;
  gathering.add(block, channel.scale, channel.offset);
  return gathering.figures();
}

}  // namespace impactrig::acquisition
