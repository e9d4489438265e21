// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/exporters/outgoing.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::Record;

namespace {

/// What the values of a part depend on beside its samples.
Channel scaled_as(const Channel& head) {
  Channel part;
  part.scale = head.scale;
  part.offset = head.offset;
  part.clock.start = head.clock.start;
  part.clock.interval = head.clock.interval;
  return part;
}

template <typename Number>
std::vector<Number> some(const std::vector<Number>& all, std::uint64_t first, std::size_t count) {
  if (all.empty()) return {};
  const auto begin = all.begin() + static_cast<std::ptrdiff_t>(first);
  return {begin, begin + static_cast<std::ptrdiff_t>(count)};
}

Channel part_in_memory(const Channel& channel, std::uint64_t first, std::size_t count) {
  Channel part = scaled_as(channel);
  std::visit([&](const auto& raw) { part.raw = some(raw, first, count); }, channel.raw);
  part.imaginary = some(channel.imaginary, first, count);
  part.valid = some(channel.valid, first, count);
  part.clock.times = some(channel.clock.times, first, count);
  return part;
}

/// Every kind that a spool has fits a double exactly.
template <typename Number>
std::vector<Number> some(const MappedFile& file, const StoredNumbers& all, std::uint64_t first,
                         std::size_t count) {
  if (all.size() == 0) return {};
  std::vector<double> numbers(count);
  read_numbers(file, all, first, numbers);
  if constexpr (std::is_same_v<Number, double>) return numbers;
  std::vector<Number> result(count);
  std::ranges::transform(numbers, result.begin(),
                         [](double number) { return static_cast<Number>(number); });
  return result;
}

Channel part_on_disk(const Channel& head, const StoredChannel& stored, const MappedFile& file,
                     std::uint64_t first, std::size_t count) {
  Channel part = scaled_as(head);
  switch (stored.samples.kind()) {
    case NumberKind::f32:
      part.raw = some<float>(file, stored.samples, first, count);
      break;
    case NumberKind::i16:
      part.raw = some<std::int16_t>(file, stored.samples, first, count);
      break;
    case NumberKind::i32:
      part.raw = some<std::int32_t>(file, stored.samples, first, count);
      break;
    default:
      part.raw = some<double>(file, stored.samples, first, count);
  }
  part.imaginary = some<double>(file, stored.imaginary, first, count);
  part.clock.times = some<double>(file, stored.times, first, count);
  part.valid = some<std::uint8_t>(file, stored.invalid, first, count);
  for (std::uint8_t& mark : part.valid) mark = mark == 0 ? 1 : 0;
  return part;
}

}  // namespace

OutgoingRecording outgoing(const Record& record) {
  OutgoingRecording list{record, {}};
  for (const Channel& channel : record.channels)
    list.channels.push_back({&channel, channel.size(), channel.complex(), channel.clock.uniform(),
                             !channel.valid.empty(),
                             std::holds_alternative<std::vector<float>>(channel.raw),
                             [&channel](std::uint64_t first, std::size_t count) {
                               return part_in_memory(channel, first, count);
                             }});
  return list;
}

OutgoingRecording without_single_numbers(const OutgoingRecording& recording,
                                         std::vector<std::string>& warnings) {
  const auto is_signal = [](const OutgoingChannel& channel) { return channel.size != 1; };
  if (std::ranges::none_of(recording.channels,
                           [](const OutgoingChannel& channel) { return channel.size > 1; }) ||
      std::ranges::all_of(recording.channels, is_signal))
    return recording;
  OutgoingRecording signals{recording.record, {}};
  std::string left_out;
  for (const OutgoingChannel& channel : recording.channels) {
    if (is_signal(channel))
      signals.channels.push_back(channel);
    else
      left_out += fmt::format("{}'{}'", left_out.empty() ? "" : ", ", channel.head->name);
  }
  warnings.push_back(
      fmt::format("left out are single numbers, which a table of samples has no place for: {}; "
                  ".h5 and .mat files keep them",
                  left_out));
  return signals;
}

OutgoingRecording outgoing(const Record& record, const SpooledRecording& samples) {
  OutgoingRecording list{record, {}};
  for (std::size_t i = 0; i < record.channels.size(); ++i) {
    const Channel& head = record.channels[i];
    const StoredChannel& stored = samples.channels.at(i);
    const MappedFile& file = *samples.file;
    list.channels.push_back({&head, stored.samples.size(), stored.imaginary.size() > 0,
                             stored.times.size() == 0, stored.invalid.size() > 0,
                             stored.samples.kind() == NumberKind::f32,
                             [&head, &stored, &file](std::uint64_t first, std::size_t count) {
                               return part_on_disk(head, stored, file, first, count);
                             }});
  }
  return list;
}

}  // namespace impactrig::acquisition
