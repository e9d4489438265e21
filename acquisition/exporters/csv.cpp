// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "acquisition/exporters/formats.hpp"
#include "acquisition/exporters/not_kept.hpp"
#include "acquisition/exporters/output_file.hpp"
#include "acquisition/importers/csv_roles.hpp"
#include "acquisition/importers/time_axis.hpp"
#include "datasets/input_error.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::FileError;

namespace {

constexpr std::size_t most_mark_text = 100000;  ///< [bytes]

/// Of channels of one length.
bool same_times(const OutgoingChannel& a, const OutgoingChannel& b) {
  if (&a == &b) return true;
  if (a.uniform || b.uniform) return a.uniform == b.uniform;
  bool same = true;
  a.each([&](const Channel& part, std::uint64_t first) {
    same = same && part.clock.times == b.part(first, part.size()).clock.times;
  });
  return same;
}

/// The channel whose times are the table's: the first that has samples.
const OutgoingChannel& clock_of(const OutgoingRecording& recording) {
  const auto found = std::ranges::find_if(
      recording.channels, [](const OutgoingChannel& channel) { return channel.size > 0; });
  return found == recording.channels.end() ? recording.channels.front() : *found;
}

/// A table has one time column: every channel with samples must fit it.
void check_channels(const OutgoingRecording& recording, const std::string& path) {
  const OutgoingChannel& first = clock_of(recording);
  for (const OutgoingChannel& outgoing : recording.channels) {
    const Channel& channel = *outgoing.head;
    const auto domain = channel.attributes.find("domain");
    if (domain != channel.attributes.end() && domain->second != "time")
      throw FileError(
          path, fmt::format(
                    "'{}' is over {}, a CSV file here holds time records: write a .uff or .h5 file",
                    channel.name, domain->second));
    if (outgoing.complex)
      throw FileError(
          path,
          fmt::format(
              "'{}' is complex, which a CSV file here does not hold: write a .uff or .h5 file",
              channel.name));
    if (outgoing.size == 0) continue;
    if (outgoing.size != first.size || channel.clock.start != first.head->clock.start ||
        channel.clock.interval != first.head->clock.interval || !same_times(outgoing, first))
      throw FileError(
          path, fmt::format(
                    "'{}' and '{}' were not sampled at the same times, and a CSV file has one time "
                    "column: choose channels with --channel, or write a .uff or .h5 file",
                    first.head->name, channel.name));
  }
}

/// True where an importer may take a channel for further times.
bool any_looks_like_times(const OutgoingRecording& recording) {
  return std::ranges::any_of(recording.channels, [](const OutgoingChannel& channel) {
    const std::string& unit = channel.head->unit;
    return unit.empty() || datasets::conversion(unit, "s").has_value();
  });
}

/// A cell of the header: always with brackets, so that none in the name is taken for a unit.
std::string heading(const Channel& channel) {
  std::string text = fmt::format("{} [{}]", channel.name, channel.unit);
  std::replace(text.begin(), text.end(), '\n', ' ');
  std::replace(text.begin(), text.end(), '\r', ' ');
  std::replace(text.begin(), text.end(), '"', '\'');
  const bool plain = text.find_first_of(",;\t#%") == std::string::npos;
  return plain ? text : '"' + text + '"';
}

/// The times [s] of a part that begins with sample `first`.
std::vector<double> times_of(const OutgoingChannel& channel, const Channel& part,
                             std::uint64_t first) {
  std::vector<double> times = part.clock.times;
  if (!channel.uniform) return times;
  times.resize(part.size());
  for (std::size_t i = 0; i < times.size(); ++i) times[i] = channel.head->clock.time(first + i);
  return times;
}

/// Whether times are so far from 0 that doubles round their steps: without a stated interval an
/// importer counts them from the first.
bool far_from_zero(const datasets::SampleClock& clock) {
  constexpr double few_digits = 1e-4;  // of a step; an importer counts from 1e-3 on
  return std::abs(clock.start) * std::numeric_limits<double>::epsilon() >
         few_digits * clock.interval;
}

/// Whether times of this clock, read back, give another interval or start.
bool table_changes_clock(const OutgoingChannel& channel) {
  const datasets::SampleClock& clock = channel.head->clock;
  if (channel.size == 0) return clock.interval != 0.0;
  if (far_from_zero(clock)) return true;
  TimeAxisCheck check(clock.time(0), clock.time(channel.size - 1), channel.size);
  std::vector<double> times;
  for (std::uint64_t first = 0; first < channel.size; first += times.size()) {
    times.resize(
        static_cast<std::size_t>(std::min<std::uint64_t>(samples_at_once, channel.size - first)));
    for (std::size_t i = 0; i < times.size(); ++i) times[i] = clock.time(first + i);
    check.add(times);
  }
  return check.axis().clock.interval != clock.interval;
}

/// Marks as comments, which our importer reads back. Too many would not leave it the rows to look
/// at: a warning tells.
void print_marks(OutputFile& out, const OutgoingRecording& recording, std::size_t first_column,
                 std::vector<std::string>& warnings) {
  std::size_t left = most_mark_text;
  for (std::size_t c = 0; c < recording.channels.size(); ++c) {
    // a run takes two bytes at least
    const MarkedSamples marked = marked_samples(recording.channels[c], most_mark_text / 2);
    const std::string marks = listed(marked.runs, " ");
    if (marked.more || marks.size() > left) {
      tell_of_marks(recording.channels[c], "the head of a CSV file", warnings);
      continue;
    }
    left -= marks.size();
    if (!marks.empty()) out.print("# invalid samples of column {}: {}\n", c + first_column, marks);
  }
}

/// Cells of channels without samples are empty.
void print_rows(OutputFile& out, const OutgoingRecording& recording, bool with_time) {
  const OutgoingChannel& clock = clock_of(recording);
  // all channels at a time: fewer rows of more channels
  const std::size_t rows_at_once =
      std::max<std::size_t>(samples_at_once * 64 / recording.channels.size(), 64);
  std::vector<Channel> parts(recording.channels.size());
  for (std::uint64_t first = 0; first < clock.size; first += rows_at_once) {
    const auto rows =
        static_cast<std::size_t>(std::min<std::uint64_t>(rows_at_once, clock.size - first));
    for (std::size_t c = 0; c < parts.size(); ++c)
      if (recording.channels[c].size > 0) parts[c] = recording.channels[c].part(first, rows);
    const auto timed = static_cast<std::size_t>(&clock - recording.channels.data());
    const std::vector<double> times = times_of(clock, parts[timed], first);
    for (std::size_t i = 0; i < rows; ++i) {
      if (with_time) out.print("{},", times[i]);
      for (std::size_t c = 0; c < parts.size(); ++c) {
        if (recording.channels[c].size > 0) out.print("{}", parts[c].value(i));
        out.print("{}", c + 1 < parts.size() ? ',' : '\n');
      }
    }
  }
}

}  // namespace

std::vector<std::string> write_csv(const OutgoingRecording& recording, const std::string& path) {
  if (recording.channels.empty()) throw FileError(path, "the recording has no channels to write");
  check_channels(recording, path);
  const OutgoingChannel& first = clock_of(recording);
  const datasets::SampleClock& clock = first.head->clock;
  const bool one_sample = first.size == 1 && clock.start != 0.0;  // no interval, but a time
  const bool with_time = !first.uniform || clock.interval > 0.0 || one_sample;

  OutputFile out(path);
  // comments only for what the table itself would not give back
  if (with_time && first.uniform && table_changes_clock(first))
    out.print("# sample interval: {} s\n", clock.interval);
  const std::string_view times = !with_time                        ? no_time_column
                                 : any_looks_like_times(recording) ? only_first_is_time
                                                                   : std::string_view();
  if (!times.empty()) out.print("# {}: {}\n", time_column_key, times);
  const std::size_t channels = recording.channels.size();
  for (std::size_t c = 0; c < channels; ++c) {
    const Channel& channel = *recording.channels[c].head;
    if (channel.quantity != datasets::quantity_of_unit(channel.unit))
      out.print("# quantity of column {}: {}\n", c + (with_time ? 1 : 0),
                datasets::name(channel.quantity));
  }
  std::vector<std::string> warnings;
  tell_of_calibrations(recording.record, "a CSV file", warnings);
  tell_of_filters(recording.record, "a CSV file", warnings);
  print_marks(out, recording, with_time ? 1 : 0, warnings);
  if (with_time) out.print("time [s],");
  for (std::size_t c = 0; c < channels; ++c)
    out.print("{}{}", heading(*recording.channels[c].head), c + 1 < channels ? "," : "\n");
  print_rows(out, recording, with_time);
  out.finish();
  return warnings;
}

}  // namespace impactrig::acquisition
