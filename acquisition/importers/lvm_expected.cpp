// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/lvm_expected.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace impactrig::acquisition {

namespace {

/// Rows of numbers differ in length: so much less or more than their size tells may be declared.
constexpr double believed = 0.05;

/// A segment that is expected to go on behind the lines read.
struct Expectation {
  std::uint64_t read = 0;      ///< rows of it that were read
  std::uint64_t rows = 0;      ///< of it
  std::uint64_t declared = 0;  ///< samples of the longest channel; 0: not declared
  bool packets = false;        ///< of channels with different numbers of samples

  /// Where the header and the size of the rows agree.
  bool as_declared() const {
    return declared > 0 &&
           std::abs(static_cast<double>(declared) / static_cast<double>(rows) - 1.0) <= believed;
  }

  std::uint64_t samples(const LvmPart& part) const {
    const std::uint64_t there = part.samples();
    if (as_declared()) return part.said.value_or(declared);
    if (packets)
      return static_cast<std::uint64_t>(static_cast<double>(there) * static_cast<double>(rows) /
                                        static_cast<double>(read));
    return there > read / 2 ? rows : there;  // else the column ends within the lines read
  }
};

Expectation expectation(const LvmSegment& segment, const LvmFirstLines& lines) {
  Expectation found;
  bool differ = false;
  for (const LvmPart& part : segment.parts) {
    found.read = std::max(found.read, part.samples());
    found.declared = std::max(found.declared, part.said.value_or(0));
    differ = differ || part.said != segment.parts.front().said;
  }
  found.packets = differ && lines.one_heading && found.read > 0;
  const double behind = static_cast<double>(lines.rows) / lines.bytes * lines.bytes_behind;
  found.rows = found.read + static_cast<std::uint64_t>(std::round(behind));
  return found;
}

std::string assumed(const LvmSegment& segment, const Expectation& expected, bool one_heading) {
  constexpr std::string_view likewise =
      "it is assumed that those behind have the same channels and go on where the one before ends";
  if (segment.joined > 1 || !segment.goes_on)
    return fmt::format("only the first MB was looked at, which has {} {}: {}", segment.joined,
                       segment.joined == 1 ? "segment" : "segments", likewise);
  const bool more = !one_heading && expected.declared > 0 && expected.declared < expected.rows;
  if (expected.as_declared() || !more) return {};
  return fmt::format(
      "only the first MB was looked at, whose segment declares {} samples, while the file has room "
      "for about {} like them: {}",
      expected.declared, expected.rows, likewise);
}

}  // namespace

RecordingHead expected_head(LvmRecording& recording, const LvmFirstLines& lines) {
  std::vector<std::uint64_t> samples;
  for (const LvmSegment& segment : recording.segments())
    for (const LvmPart& part : segment.parts) samples.push_back(part.samples());
  if (recording.segments().size() == 1) {
    const LvmSegment& segment = recording.segments().front();
    const Expectation expected = expectation(segment, lines);
    for (std::size_t c = 0; c < segment.parts.size(); ++c)
      samples[c] = expected.samples(segment.parts[c]);
    if (std::string text = assumed(segment, expected, lines.one_heading); !text.empty())
      recording.warn(std::move(text));
  } else if (!recording.segments().empty()) {
    const LvmSegment& last = recording.segments().back();
    const std::uint64_t room = expectation(last, lines).rows;
    for (std::size_t c = 0; c < last.parts.size() && last.goes_on; ++c)
      samples[samples.size() - last.parts.size() + c] =
          std::min(last.parts[c].said.value_or(last.parts[c].samples()), room);
    recording.warn(fmt::format(
        "only the first MB was looked at, which has {} segments that do not continue each other in "
        "time: about {} more are behind it, whose channels are not listed",
        recording.segments().size(),
        std::round(lines.segments * lines.bytes_behind / lines.bytes)));
  }
  recording.finish(lines.several_x, false);
  RecordingHead head = recording.reader()->head();
  head.samples = std::move(samples);
  head.counted = false;
  return head;
}

}  // namespace impactrig::acquisition
