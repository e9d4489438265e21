// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/quicklook_builder.hpp"

namespace impactrig::datasets {

std::size_t QuicklookBuilder::begin(std::size_t count) {
  while (samples_ % width_ == 0 && buckets_.size() == (width_ == 1 ? most_ : most_ / 2))
    merge_pairs();
  return static_cast<std::size_t>(std::min<std::uint64_t>(width_ - samples_ % width_, count));
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
