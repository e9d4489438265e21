// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "acquisition/exporters/formats.hpp"
#include "acquisition/exporters/not_kept.hpp"
#include "acquisition/exporters/output_file.hpp"
#include "acquisition/importers/time_axis.hpp"
#include "datasets/input_error.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::FileError;
using datasets::Record;

namespace {

constexpr std::size_t most_mark_text = 100000;  ///< [bytes]

/// A table has one time column: every channel must fit it.
void check_channels(const Record& record, const std::string& path) {
  const Channel& first = record.channels.front();
  for (const Channel& channel : record.channels) {
    const auto domain = channel.attributes.find("domain");
    if (domain != channel.attributes.end() && domain->second != "time")
      throw FileError(
          path, fmt::format(
                    "'{}' is over {}, a CSV file here holds time records: write a .uff or .h5 file",
                    channel.name, domain->second));
    if (channel.complex())
      throw FileError(
          path,
          fmt::format(
              "'{}' is complex, which a CSV file here does not hold: write a .uff or .h5 file",
              channel.name));
    if (channel.size() != first.size() || channel.clock.start != first.clock.start ||
        channel.clock.interval != first.clock.interval || channel.clock.times != first.clock.times)
      throw FileError(
          path, fmt::format(
                    "'{}' and '{}' were not sampled at the same times, and a CSV file has one time "
                    "column: write a .uff or .h5 file",
                    first.name, channel.name));
  }
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

std::vector<double> times_of(const Channel& channel) {
  std::vector<double> times(channel.size());
  for (std::size_t i = 0; i < times.size(); ++i) times[i] = channel.clock.time(i);
  return times;
}

/// Marks as comments, which our importer reads back. Too many would not leave it the rows to look
/// at: a warning tells.
void print_marks(OutputFile& out, const Record& record, std::size_t first_column,
                 std::vector<std::string>& warnings) {
  std::size_t left = most_mark_text;
  for (std::size_t c = 0; c < record.channels.size(); ++c) {
    const std::string marks = listed(marked_samples(record.channels[c]), " ");
    if (marks.size() > left) {
      tell_of_marks(record.channels[c], "the head of a CSV file", warnings);
      continue;
    }
    left -= marks.size();
    if (!marks.empty()) out.print("# invalid samples of column {}: {}\n", c + first_column, marks);
  }
}

}  // namespace

std::vector<std::string> write_csv(const Record& record, const std::string& path) {
  if (record.channels.empty()) throw FileError(path, "the recording has no channels to write");
  check_channels(record, path);
  const Channel& first = record.channels.front();
  const bool with_time = !first.clock.uniform() || first.clock.interval > 0.0;
  const std::vector<double> times = times_of(first);

  OutputFile out(path);
  // comments only for what the table itself would not give back
  if (with_time && first.clock.uniform() && time_axis(times).clock.interval != first.clock.interval)
    out.print("# sample interval: {} s\n", first.clock.interval);
  for (std::size_t c = 0; c < record.channels.size(); ++c) {
    const Channel& channel = record.channels[c];
    if (channel.quantity != datasets::quantity_of_unit(channel.unit))
      out.print("# quantity of column {}: {}\n", c + (with_time ? 1 : 0),
                datasets::name(channel.quantity));
  }
  std::vector<std::string> warnings;
  tell_of_calibrations(record, "a CSV file", warnings);
  print_marks(out, record, with_time ? 1 : 0, warnings);
  if (with_time) out.print("time [s],");
  for (std::size_t c = 0; c < record.channels.size(); ++c)
    out.print("{}{}", heading(record.channels[c]), c + 1 < record.channels.size() ? "," : "\n");
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (with_time) out.print("{},", times[i]);
    for (std::size_t c = 0; c < record.channels.size(); ++c)
      out.print("{}{}", record.channels[c].value(i), c + 1 < record.channels.size() ? ',' : '\n');
  }
  out.finish();
  return warnings;
}

}  // namespace impactrig::acquisition
