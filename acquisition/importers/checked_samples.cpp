// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/checked_samples.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

#include "acquisition/importers/all_finite.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::Record;

namespace {

template <typename Sample>
bool without_strange(std::span<const Sample> samples) {
  if constexpr (std::is_floating_point_v<Sample>)
    return all_finite(samples);
  else
    return true;
}

/// The part of a block that lies in a range; the block's first sample is sample `first`.
SampleBlock within(SampleRange range, std::uint64_t first, const SampleBlock& block) {
  const std::uint64_t end = first + block.size();
  const auto from = static_cast<std::size_t>(std::clamp(range.first, first, end) - first);
  const auto to = static_cast<std::size_t>(std::clamp(range.last, first, end) - first);
  const std::size_t count = std::max(from, to) - from;
  SampleBlock part;
  std::visit([&](auto raw) { part.raw = raw.subspan(from, count); }, block.raw);
  if (!block.imaginary.empty()) part.imaginary = block.imaginary.subspan(from, count);
  if (!block.valid.empty()) part.valid = block.valid.subspan(from, count);
  return part;
}

/// "the first 300 and the last 20"; "" where neither is.
std::string ends_named(std::uint64_t first, std::uint64_t last) {
  std::string text;
  if (first > 0) text = fmt::format("the first {}", first);
  if (last > 0) text += fmt::format("{}the last {}", text.empty() ? "" : " and ", last);
  return text;
}

/// The options that leave padding out, of a channel with an even clock.
std::string without_padding(const Channel& channel, const PaddingCheck& padding,
                            std::uint64_t samples) {
  const datasets::SampleClock& clock = channel.clock;
  if (!clock.uniform() || !(clock.interval > 0.0)) return "--from and --to leave them out";
  const auto time = [&clock](std::uint64_t sample) {
    return clock.start + clock.interval * static_cast<double>(sample);
  };
  std::string options;
  if (padding.begin() > 0) options = fmt::format("--from {:.9g}", time(padding.begin()));
  if (padding.end() > 0)
    options +=
        fmt::format("{}--to {:.9g}", options.empty() ? "" : " ", time(samples - padding.end() - 1));
  return options + " leaves them out";
}

}  // namespace

CheckedSamples::CheckedSamples(std::size_t channels, std::vector<SampleRange> ranges,
                               SampleSink& next)
    : marks_(channels),
      seen_(channels),
      ranges_(std::move(ranges)),
      next_(next) {}

void CheckedSamples::take(std::size_t index, const SampleBlock& whole) {
  const SampleBlock block = ranges_.empty() ? whole : within(ranges_[index], seen_[index], whole);
  seen_[index] += whole.size();
  if (block.size() == 0) return;
  SampleBlock checked = block;
  const bool finite =
      std::visit([](auto samples) { return without_strange(samples); }, block.raw) &&
      all_finite(block.imaginary);
  Marks& marks = marks_[index];
  if (!finite) {
    std::visit([&](auto samples) { mark(samples, block, marks); }, block.raw);
    checked.valid = valid_;
  }
  marks.samples += block.size();
  marks.padding.add(block);
  next_.take(index, checked);
}

void CheckedSamples::take_times(std::size_t index, std::span<const double> times) {
  if (ranges_.empty()) next_.take_times(index, times);
}

void CheckedSamples::tell(Record& record) const {
  for (std::size_t i = 0; i < marks_.size(); ++i) {
    const Marks& marks = marks_[i];
    const Channel& channel = record.channels[i];
    if (marks.found > 0)
      record.warnings.push_back(fmt::format(
          "'{}': {} of {} samples {} not finite, the first is sample {}; marked as "
          "not valid",
          channel.name, marks.found, marks.samples, marks.found == 1 ? "is" : "are", marks.first));
    const std::string ends = ends_named(marks.padding.begin(), marks.padding.end());
    if (!ends.empty())
      record.warnings.push_back(
          fmt::format("'{}': {} of {} samples are exactly 0, and no other stretch is: its recorder "
                      "seems to have filled them in; {}",
                      channel.name, ends, marks.samples,
                      without_padding(channel, marks.padding, marks.samples)));
  }
}

template <typename Sample>
void CheckedSamples::mark(std::span<const Sample> samples, const SampleBlock& block, Marks& marks) {
  valid_.assign(block.valid.begin(), block.valid.end());
  valid_.resize(samples.size(), 1);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const bool finite = std::isfinite(static_cast<double>(samples[i])) &&
                        (block.imaginary.empty() || std::isfinite(block.imaginary[i]));
    if (finite || valid_[i] == 0) continue;
    valid_[i] = 0;
    if (marks.found++ == 0) marks.first = marks.samples + i;
  }
}

}  // namespace impactrig::acquisition
