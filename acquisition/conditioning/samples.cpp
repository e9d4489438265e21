// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/samples.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "acquisition/conditioning/background.hpp"
#include "acquisition/conditioning/trace.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::TimeSpan;

std::vector<std::uint8_t> sound_marks(const Channel& channel) {
  std::vector<std::uint8_t> valid = channel.valid;
  for (std::size_t i = 0; i < channel.size(); ++i) {
    if (std::isfinite(channel.value(i))) continue;
    if (valid.empty()) valid.assign(channel.size(), 1);
    valid[i] = 0;
  }
  return valid;
}

std::vector<double> sound_values(const Channel& channel, std::size_t least) {
  const bool history =
      !channel.complex() && channel.clock.uniform() && channel.clock.interval > 0.0;
  if (!history)
    throw std::invalid_argument(
        fmt::format("channel '{}' is not a real time history at uniform steps; resample it first, "
                    "or choose another one",
                    channel.name));
  if (channel.size() < least)
    throw std::invalid_argument(fmt::format("channel '{}' has {} samples; at least {} are needed",
                                            channel.name, channel.size(), least));
  std::vector<double> values = channel.values();
  const std::vector<std::uint8_t> valid = sound_marks(channel);
  if (!valid.empty() && std::ranges::find(valid, 1) == valid.end())
    throw std::invalid_argument(
        fmt::format("channel '{}' has no sound sample; choose another channel", channel.name));
  bridge_invalid(values, valid);
  return values;
}

void replace_values(Channel& channel, std::vector<double>&& values) {
  channel.raw = std::move(values);
  channel.scale = 1.0;
  channel.offset = 0.0;
}

double largest_departure(std::span<const double> values) {
  const double level = median({values.begin(), values.end()});
  double largest = 0.0;
  for (const double value : values)
    if (std::abs(value - level) > std::abs(largest)) largest = value - level;
  return largest;
}

IndexRange samples_in(const Channel& channel, const TimeSpan& span) {
  const double n = static_cast<double>(channel.size());
  const auto& clock = channel.clock;
  // A ten-thousandth of a step of grace: times are rounded.
  const double from = std::ceil((span.begin - clock.start) / clock.interval - 1e-4);
  const double to = std::floor((span.end - clock.start) / clock.interval + 1e-4) + 1.0;
  IndexRange range;
  range.begin = static_cast<std::size_t>(std::clamp(from, 0.0, n));
  range.end = std::max(range.begin, static_cast<std::size_t>(std::clamp(to, 0.0, n)));
  return range;
}

std::size_t sound_samples(const Channel& channel, const IndexRange& range) {
  std::size_t count = 0;
  for (std::size_t i = range.begin; i < range.end; ++i)
    count += channel.is_valid(i) && std::isfinite(channel.value(i));
  return count;
}

std::string text_of(std::span<const TimeSpan> spans) {
  std::string text;
  for (const TimeSpan& span : spans)
    text += fmt::format("{}{:.12g} s to {:.12g} s", text.empty() ? "" : ", ", span.begin, span.end);
  return text;
}

}  // namespace impactrig::acquisition
