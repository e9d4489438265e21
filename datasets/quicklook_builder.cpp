// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/quicklook_builder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace impactrig::datasets {

namespace {

/// Written so that a value that is not a number loses against any number.
bool below(double a, double b) {
  return a < b || (std::isnan(b) && !std::isnan(a));
}

bool above(double a, double b) {
  return a > b || (std::isnan(b) && !std::isnan(a));
}

struct Extremes {
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -std::numeric_limits<double>::infinity();
};

/// Of the numbers among `values`; eight side by side, which the processor compares at once.
Extremes extremes_of(std::span<const double> values) {
  constexpr std::size_t lanes = 8;
  std::array<double, lanes> lowest;
  std::array<double, lanes> highest;
  lowest.fill(Extremes{}.lowest);
  highest.fill(Extremes{}.highest);
  const std::size_t whole = values.size() / lanes * lanes;
  for (std::size_t i = 0; i < whole; i += lanes)
    for (std::size_t k = 0; k < lanes; ++k) {
      const double value = values[i + k];
      lowest[k] = value < lowest[k] ? value : lowest[k];
      highest[k] = value > highest[k] ? value : highest[k];
    }
  for (std::size_t i = whole; i < values.size(); ++i) {
    lowest[0] = values[i] < lowest[0] ? values[i] : lowest[0];
    highest[0] = values[i] > highest[0] ? values[i] : highest[0];
  }
  return {*std::ranges::min_element(lowest), *std::ranges::max_element(highest)};
}

}  // namespace

void QuicklookBuilder::add(std::span<const double> values, std::span<const double> imaginary) {
  while (!values.empty()) {
    const std::uint64_t in_bucket = samples_ % width_;
    if (in_bucket == 0 && buckets_.size() == (width_ == 1 ? most_ : most_ / 2)) {
      merge_pairs();
      continue;
    }
    const auto count =
        static_cast<std::size_t>(std::min<std::uint64_t>(width_ - in_bucket, values.size()));
    add_to_bucket(values.first(count), imaginary.first(imaginary.empty() ? 0 : count));
    samples_ += count;
    values = values.subspan(count);
    imaginary = imaginary.subspan(imaginary.empty() ? 0 : count);
  }
}

void QuicklookBuilder::add_to_bucket(std::span<const double> values,
                                     std::span<const double> imaginary) {
  const auto point = [&](std::size_t i) {
    return Point{samples_ + i, values[i], imaginary.empty() ? 0.0 : imaginary[i]};
  };
  if (samples_ % width_ == 0) buckets_.push_back({point(0), point(0)});
  if (values.size() == 1 && samples_ % width_ == 0) return;
  Bucket& bucket = buckets_.back();
  const Extremes extremes = extremes_of(values);
  const auto find = [&](double value) {
    return point(static_cast<std::size_t>(std::ranges::find(values, value) - values.begin()));
  };
  // where no value is a number, the extremes are infinite and none of the values
  if (extremes.lowest > extremes.highest) return;
  if (below(extremes.lowest, bucket.lowest.value)) bucket.lowest = find(extremes.lowest);
  if (above(extremes.highest, bucket.highest.value)) bucket.highest = find(extremes.highest);
}

void QuicklookBuilder::merge_pairs() {
  width_ *= 2;
  const std::size_t half = buckets_.size() / 2;
  for (std::size_t i = 0; i < half; ++i) {
    const Bucket& a = buckets_[2 * i];
    const Bucket& b = buckets_[2 * i + 1];
    buckets_[i] = {below(b.lowest.value, a.lowest.value) ? b.lowest : a.lowest,
                   above(b.highest.value, a.highest.value) ? b.highest : a.highest};
  }
  buckets_.resize(half);
}

std::vector<QuicklookBuilder::Point> QuicklookBuilder::points() const {
  std::vector<Point> points;
  for (const Bucket& bucket : buckets_) {
    const bool rises = bucket.lowest.sample < bucket.highest.sample;
    points.push_back(rises ? bucket.lowest : bucket.highest);
    if (bucket.lowest.sample != bucket.highest.sample)
      points.push_back(rises ? bucket.highest : bucket.lowest);
  }
  return points;
}

}  // namespace impactrig::datasets
