// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "datasets/conditioning.hpp"
#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// The samples of a real time history at uniform steps, invalid ones bridged by straight lines; in
/// the channel's unit. Throws std::invalid_argument when the channel is not such a history, has
/// fewer than `least` samples, or none that is sound.
std::vector<double> sound_values(const datasets::Channel& channel, std::size_t least = 1);

/// The channel's marks and 0 where a sample is not finite; empty: all sound. A step that puts
/// numbers in the place of samples keeps these.
std::vector<std::uint8_t> sound_marks(const datasets::Channel& channel);

/// New samples in the channel's unit, as many as before.
void replace_values(datasets::Channel& channel, std::vector<double>&& values);

/// The value furthest from the median, less that; of at least one value.
double largest_departure(std::span<const double> values);

/// The indices [begin, end) of the samples within a span; may be empty.
struct IndexRange {
  std::size_t begin = 0, end = 0;

  std::size_t size() const { return end - begin; }
};

IndexRange samples_in(const datasets::Channel& channel, const datasets::TimeSpan& span);

/// How many of them are valid and finite.
std::size_t sound_samples(const datasets::Channel& channel, const IndexRange& range);

/// "-0.001 s to 0 s", with commas between several.
std::string text_of(std::span<const datasets::TimeSpan> spans);

}  // namespace impactrig::acquisition
