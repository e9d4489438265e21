// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace impactrig::datasets {

/// Picks the samples that a viewer draws while they come: all while they are few, else the smallest
/// and the largest of each of at most `most`/2 buckets of equal width, which doubles when they run
/// out. `most` is a multiple of 4.
class QuicklookBuilder {
 public:
  explicit QuicklookBuilder(std::size_t most) : most_(most) {}

  /// The next samples, of any type of number; NaN where one is not valid. `imaginary` is empty or
  /// one a sample.
  template <typename Number>
  void add(std::span<const Number> values, std::span<const double> imaginary = {}) {
    while (!values.empty()) {
      const std::size_t count = begin(values.size());
      add_to_bucket(values.first(count), imaginary.first(imaginary.empty() ? 0 : count));
      samples_ += count;
      values = values.subspan(count);
      imaginary = imaginary.subspan(imaginary.empty() ? 0 : count);
    }
  }

  struct Point {
    std::uint64_t sample;
    double value;
    double imaginary;
  };

  std::vector<Point> points() const;

  std::uint64_t samples() const { return samples_; }

 private:
  struct Bucket {
    Point lowest, highest;
  };

  static constexpr std::size_t piece = 128;

  template <typename Number>
  struct Extremes {
    Number lowest, highest;
  };

  /// Of the numbers among `values`, of which NaN is none; as many side by side as the processor
  /// compares at once, and some more.
  template <typename Number>
  static Extremes<Number> extremes_of(std::span<const Number> values) {
    using Limits = std::numeric_limits<Number>;
    constexpr std::size_t lanes = 64 / sizeof(Number);
    std::array<Number, lanes> lowest;
    std::array<Number, lanes> highest;
    lowest.fill(Limits::has_infinity ? Limits::infinity() : Limits::max());
    highest.fill(Limits::has_infinity ? -Limits::infinity() : Limits::lowest());
    const std::size_t whole = values.size() / lanes * lanes;
    const auto see = [&](std::size_t lane, Number value) {
      lowest[lane] = value < lowest[lane] ? value : lowest[lane];
      highest[lane] = value > highest[lane] ? value : highest[lane];
    };
    for (std::size_t i = 0; i < whole; i += lanes)
      for (std::size_t k = 0; k < lanes; ++k) see(k, values[i + k]);
    for (std::size_t i = whole; i < values.size(); ++i) see(0, values[i]);
    if (whole > 0)
      for (std::size_t half = lanes / 2; half > 0; half /= 2)
        for (std::size_t k = 0; k < half; ++k) {
          lowest[k] = std::min(lowest[k], lowest[k + half]);
          highest[k] = std::max(highest[k], highest[k + half]);
        }
    return {lowest[0], highest[0]};
  }

  template <typename Number>
  void add_to_bucket(std::span<const Number> values, std::span<const double> imaginary) {
    const auto point = [&](std::size_t i) {
      return Point{samples_ + i, static_cast<double>(values[i]),
                   imaginary.empty() ? 0.0 : imaginary[i]};
    };
    const bool is_first = samples_ % width_ == 0;
    if (is_first) buckets_.push_back({point(0), point(0)});
    if (is_first && values.size() == 1) return;
    // piece by piece, so that the place of an extreme is sought in one of them
    Extremes<Number> extremes = extremes_of(values.first(0));
    std::size_t lowest_from = 0;
    std::size_t highest_from = 0;
    for (std::size_t first = 0; first < values.size(); first += piece) {
      const Extremes<Number> here =
          extremes_of(values.subspan(first, std::min(piece, values.size() - first)));
      if (here.lowest < extremes.lowest) lowest_from = first;
      if (here.highest > extremes.highest) highest_from = first;
      extremes.lowest = std::min(extremes.lowest, here.lowest);
      extremes.highest = std::max(extremes.highest, here.highest);
    }
    // where no value is a number, the extremes are infinite and none of the values
    if (extremes.lowest > extremes.highest) return;
    const auto find = [&](Number value, std::size_t from) {
      const auto found = std::ranges::find(values.subspan(from), value);
      return point(from + static_cast<std::size_t>(found - values.subspan(from).begin()));
    };
    Bucket& bucket = buckets_.back();
    if (below(static_cast<double>(extremes.lowest), bucket.lowest.value))
      bucket.lowest = find(extremes.lowest, lowest_from);
    if (above(static_cast<double>(extremes.highest), bucket.highest.value))
      bucket.highest = find(extremes.highest, highest_from);
  }

  /// A value that is not a number loses against any number.
  static bool below(double a, double b) { return a < b || (std::isnan(b) && !std::isnan(a)); }

  static bool above(double a, double b) { return a > b || (std::isnan(b) && !std::isnan(a)); }

  /// Makes room for the next of `count` samples; returns how many of them its bucket takes.
  std::size_t begin(std::size_t count);
  void merge_pairs();

  std::size_t most_;
  std::uint64_t samples_ = 0;
  std::uint64_t width_ = 1;
  std::vector<Bucket> buckets_;
};

}  // namespace impactrig::datasets
