// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace impactrig::datasets {

/// Picks the samples that a viewer draws while they come: all while they are few, else the smallest
/// and the largest of each of at most `most`/2 buckets of equal width, which doubles when they run
/// out.
class QuicklookBuilder {
 public:
  explicit QuicklookBuilder(std::size_t most) : most_(most) {}

  /// The next samples; NaN where one is not valid. `imaginary` is empty or one a sample.
  void add(std::span<const double> values, std::span<const double> imaginary);

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

  void add_to_bucket(std::span<const double> values, std::span<const double> imaginary);
  void merge_pairs();

  std::size_t most_;
  std::uint64_t samples_ = 0;
  std::uint64_t width_ = 1;
  std::vector<Bucket> buckets_;
};

}  // namespace impactrig::datasets
