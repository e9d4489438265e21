// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/lvm_headerless.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/number.hpp"
#include "acquisition/recording_spool.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::Record;

namespace {

/// Where the samples of a column end.
struct ColumnEnd {
  std::uint64_t rows = 0;     ///< of the table
  std::uint64_t samples = 0;  ///< up to the last value
  std::uint64_t missing = 0;  ///< of these

  bool cut() const { return samples != rows; }
};

/// "'column 3'" in a warning's beginning.
std::string about(const std::string& name) {
  return fmt::format("'{}'", name);
}

/// Columns counted from 1, in names, warnings and attributes.
void count_from_one(Record& record) {
  record.warnings.emplace(record.warnings.begin(),
                          "the file has no header: it is read as a table of numbers");
  std::string& time_column = record.attributes["time column"];
  if (time_column.starts_with("column 0 (")) {
    time_column[7] = '1';
    for (std::string& warning : record.warnings)
      if (warning.starts_with("the time column 'column 0'")) warning[24] = '1';
  }
  std::vector<std::string> names;
  for (Channel& channel : record.channels) {
    names.push_back(channel.name);
    const auto number =
        integer_in(channel.name.starts_with("column ") ? channel.name.substr(7) : std::string());
    if (number) channel.name = fmt::format("column {}", *number + 1);
  }
  for (std::string& warning : record.warnings)
    for (std::size_t c = 0; c < names.size(); ++c)
      if (warning.starts_with(about(names[c]))) {
        warning.replace(0, about(names[c]).size(), about(record.channels[c].name));
        break;
      }
}

/// Says where a column ends, in place of how many of its values are missing.
void tell_end(const std::string& name, ColumnEnd end, Record& record) {
  if (!end.cut()) return;
  std::string text = fmt::format(
      "'{}' ends after {} of {} rows{}", name, end.samples, end.rows,
      end.missing > 0 ? fmt::format(", {} values within are missing", end.missing) : "");
  const auto old = std::ranges::find_if(record.warnings, [&](const std::string& warning) {
    return warning.starts_with(about(name));
  });
  if (old != record.warnings.end())
    *old = std::move(text);
  else
    record.warnings.push_back(std::move(text));
}

ColumnEnd end_of(const Channel& channel) {
  ColumnEnd end{channel.size(), channel.size(), 0};
  if (channel.valid.empty()) return end;
  while (end.samples > 0 && channel.valid[end.samples - 1] == 0) --end.samples;
  end.missing = static_cast<std::uint64_t>(std::count(
      channel.valid.begin(), channel.valid.begin() + static_cast<std::ptrdiff_t>(end.samples), 0));
  return end;
}

Record read_whole(RecordingReader& table) {
  Record record = read_into_memory(table);
  count_from_one(record);
  for (Channel& channel : record.channels) {
    const ColumnEnd end = end_of(channel);
    tell_end(channel.name, end, record);
    if (!end.cut()) continue;
    std::get<std::vector<double>>(channel.raw).resize(end.samples);
    channel.valid.resize(end.samples);
    if (!channel.clock.times.empty()) channel.clock.times.resize(end.samples);
    if (end.missing == 0) channel.valid.clear();
  }
  return record;
}

/// A large table, which goes to the disk when its samples are asked for: only then is it known
/// where columns end.
class LargeHeaderless final : public RecordingReader {
 public:
  LargeHeaderless(std::string path, std::unique_ptr<RecordingReader> table)
      : path_(std::move(path)),
        table_(std::move(table)),
        head_(table_->head()) {
    count_from_one(head_.record);
  }

  const RecordingHead& head() const override { return head_; }

  Record read(const Selection& wanted, SampleSink& sink) override {
    if (!on_disk_) on_disk_ = to_disk();
    return on_disk_->read(wanted, sink);
  }

 private:
  std::unique_ptr<RecordingReader> to_disk() {
    RecordingSpool spool(path_, head_.samples.size());
    Record record = table_->read({}, spool);
    count_from_one(record);
    SpooledRecording samples = spool.finish();
    for (std::size_t c = 0; c < samples.channels.size(); ++c) {
      StoredChannel& stored = samples.channels[c];
      const std::uint64_t rows = stored.samples.size();
      const std::uint64_t last = spool.sound_end(c);
      const ColumnEnd end{rows, last, spool.unsound(c) - (rows - last)};
      tell_end(record.channels[c].name, end, record);
      if (!end.cut()) continue;
      stored.samples = stored.samples.first(last);
      stored.invalid = end.missing > 0 ? stored.invalid.first(last) : StoredNumbers();
      stored.times = stored.times.first(last);
    }
    return reader_of_numbers(std::move(samples.file), std::move(record),
                             std::move(samples.channels));
  }

  std::string path_;
  std::unique_ptr<RecordingReader> table_;
  RecordingHead head_;
  std::unique_ptr<RecordingReader> on_disk_;
};

}  // namespace

std::unique_ptr<RecordingReader> open_lvm_without_header(const std::string& path,
                                                         const ImportOptions& options,
                                                         bool by_blocks) {
  if (!by_blocks) return reader_of(read_whole(*open_csv(path, options)));
  auto large = std::make_unique<LargeHeaderless>(path, open_csv_by_blocks(path, options));
  if (options.head_only) return reader_of_head(large->head());
  return large;
}

}  // namespace impactrig::acquisition
