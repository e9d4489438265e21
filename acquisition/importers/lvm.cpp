// SPDX-License-Identifier: BSD-3-Clause
// LabVIEW measurement files. Layout: National Instruments, "Specification for the LabVIEW
// Measurement File (.lvm)", 2006 and later.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/large_table.hpp"
#include "acquisition/importers/lvm_expected.hpp"
#include "acquisition/importers/lvm_headerless.hpp"
#include "acquisition/importers/lvm_heads.hpp"
#include "acquisition/importers/lvm_recording.hpp"
#include "acquisition/importers/lvm_rows.hpp"
#include "acquisition/importers/lvm_text.hpp"
#include "acquisition/importers/text_file.hpp"
#include "acquisition/importers/text_table.hpp"

namespace impactrig::acquisition {

using datasets::Record;
using datasets::SampleClock;

namespace {

class LvmReader {
 public:
  /// `looked_at`: for estimated_head(), which is then all that may be called.
  LvmReader(const std::string& path, const ImportOptions& options,
            std::size_t looked_at = LvmText::all)
      : options_(options),
        text_(path, options.encoding, looked_at),
        recording_(path, options_),
        heads_(text_, options_, recording_),
        rows_(text_, recording_) {}

  /// Counts what a large file holds without keeping it. False where that does not tell all there is
  /// to know: several segments, missing values, times that Delta_X does not explain.
  bool count() {
    rows_.only_count();
    heads_.read_file_header();
    if (!read_segment() || !rows_.plain()) return false;
    heads_.skip_between();
    if (text_.at != text_.end || recording_.segments().size() != 1) return false;
    for (const LvmPart& part : recording_.segments().front().parts) {
      const bool without_x = part.x.empty() && part.counted_x == 0;
      const bool explained = part.check.agrees && part.delta.value_or(0.0) > 0.0;
      if (part.counted == 0 || !(without_x || explained)) return false;
    }
    finish();
    return true;
  }

  /// What the first lines of a large file say. None when they do not reach to a row.
  std::optional<RecordingHead> estimated_head() {
    heads_.read_file_header();
    heads_.skip_between();
    const char* first = text_.at;
    LvmFirstLines lines;
    while (read_segment()) lines.rows += rows_.count();
    if (lines.rows == 0) return std::nullopt;
    if (number_ == 1) first = rows_.first();
    lines.bytes = static_cast<double>(text_.end - first);
    lines.bytes_behind =
        text_.file.expected_size() - static_cast<double>(text_.end - text_.file.text().data());
    lines.one_heading = text_.one_heading;
    lines.several_x = text_.multi;
    lines.segments = number_;
    RecordingHead head = expected_head(recording_, lines);
    add_special_blocks(head.record);
    return head;
  }

  const Record& record() { return recording_.record(); }

  std::vector<std::uint64_t> counts() const {
    std::vector<std::uint64_t> list;
    for (const LvmPart& part : recording_.segments().front().parts) list.push_back(part.counted);
    return list;
  }

  /// Reads the values that were counted; `use(row)` is told before each row, `take(channel, value)`
  /// of each value.
  template <typename Use, typename Take>
  void read_counted(const Use& use, const Take& take) {
    rows_.read_counted(recording_.segments().front(), use, take);
  }

  void release(const char* first, const char* last) const { text_.file.release(first, last); }

  const char* rows() const { return rows_.first(); }

  /// Reads all: into memory, or to the disk.
  std::unique_ptr<RecordingReader> read(bool to_disk) {
    if (to_disk) recording_.use_spool();
    heads_.read_file_header();
    while (read_segment()) {
    }
    finish();
    return recording_.reader();
  }

 private:
  void finish() {
    recording_.finish(text_.multi);
    add_special_blocks(recording_.record());
  }

  void add_special_blocks(Record& record) const {
    if (heads_.special_blocks() > 0)
      record.attributes["special blocks left out"] = fmt::format("{}", heads_.special_blocks());
  }

  /// False when there is none left.
  bool read_segment() {
    heads_.skip_between();
    if (text_.at == text_.end) return false;
    const char* const start = text_.at;
    LvmHeader header;
    if (!heads_.read_segment_header(header, number_ + 1)) {
      if (text_.is_part) return false;
      recording_.warn(
          fmt::format("the file ends within the header of segment {} at {}: it is left out",
                      number_ + 1, text_.file.position(start).text()));
      return false;
    }
    if (text_.at == text_.end && text_.is_part) return false;
    ++number_;
    if (text_.at == text_.end) {
      recording_.warn(
          fmt::format("segment {} has no samples: the file ends behind its header", number_));
      return false;
    }
    LvmSegment segment;
    segment.first = number_;
    heads_.describe(header, segment);
    rows_.read(segment);
    segment.goes_on = text_.at == text_.end && text_.is_part;
    recording_.add(std::move(segment), text_.one_heading);
    return true;
  }

  const ImportOptions options_;
  LvmText text_;
  LvmRecording recording_;
  LvmHeads heads_;
  LvmRows rows_;
  int number_ = 0;  ///< of the segment that is read, from 1
};

/// A large file of one segment, whose values are read by blocks.
class LargeLvm final : public RecordingReader {
 public:
  explicit LargeLvm(std::unique_ptr<LvmReader> counted) : file_(std::move(counted)) {
    head_.record = file_->record();
    head_.samples = file_->counts();
  }

  const RecordingHead& head() const override { return head_; }

  Record read(const Selection& wanted, SampleSink& sink) override {
    const std::vector<std::size_t> chosen = selected_channels(head_, wanted);
    Record record = head_.record;
    record.channels.clear();
    std::vector<Wanted> parts;
    std::uint64_t last = 0;
    for (const std::size_t index : chosen) {
      record.channels.push_back(head_.record.channels[index]);
      SampleClock& clock = record.channels.back().clock;
      parts.push_back({index, samples_within(clock, head_.samples[index], wanted), {}});
      clock.start += clock.interval * static_cast<double>(parts.back().range.first);
      last = std::max(last, parts.back().range.last);
    }
    std::vector<std::vector<std::size_t>> of_channel(head_.samples.size());
    for (std::size_t i = 0; i < parts.size(); ++i) of_channel[parts[i].channel].push_back(i);
    std::uint64_t row = 0;
    const char* released = file_->rows();
    const auto hand_over = [&] {
      for (std::size_t i = 0; i < parts.size(); ++i) {
        if (!parts[i].values.empty())
          sink.take(i, {std::span<const double>(parts[i].values), {}, {}});
        parts[i].values.clear();
      }
    };
    file_->read_counted(
        [&](std::uint64_t next, const char* at) {
          row = next;
          if (row % rows_at_once == 0) {
            hand_over();
            file_->release(released, at);
            released = at;
          }
          return row < last;
        },
        [&](std::size_t channel, double value) {
          for (const std::size_t i : of_channel[channel])
            if (row >= parts[i].range.first && row < parts[i].range.last)
              parts[i].values.push_back(value);
        });
    hand_over();
    return record;
  }

 private:
  struct Wanted {
    std::size_t channel;
    SampleRange range;
    std::vector<double> values;
  };

  static constexpr std::uint64_t rows_at_once = 16384;

  std::unique_ptr<LvmReader> file_;
  RecordingHead head_;
};

}  // namespace

int recognises_lvm(std::string_view file_name, std::string_view head) {
  if (trimmed(head.substr(0, 64)).starts_with(lvm_first_word)) return 100;
  return lowered(file_name).ends_with(".lvm") && recognises_csv(file_name, head) > 0 ? 30 : 0;
}

std::unique_ptr<RecordingReader> open_lvm(const std::string& path, const ImportOptions& options) {
  {
    TextFile file(path, true, options.encoding);
    const std::string_view text = file.text();
    const std::size_t start = text.find_first_not_of(" \t\r\n");
    const bool headed =
        start != std::string_view::npos && text.substr(start).starts_with(lvm_first_word);
    const std::string_view head = text.substr(0, 65536);
    const bool large = file.is_part() || text.size() > read_at_once;
    if (!headed && head.find(lvm_end_of_header) == std::string_view::npos)
      return open_lvm_without_header(path, options, large);
    if (large && options.head_only)
      if (auto expected = estimated_lvm_head(path, options, telling_part))
        return reader_of_head(std::move(*expected));
    if (large) return open_lvm_by_blocks(path, options);
  }
  return LvmReader(path, options).read(false);
}

std::optional<RecordingHead> estimated_lvm_head(const std::string& path,
                                                const ImportOptions& options,
                                                std::size_t looked_at) try {
  return LvmReader(path, options, looked_at).estimated_head();

} catch (const datasets::InputError&) {
  return std::nullopt;
}

std::unique_ptr<RecordingReader> open_lvm_by_blocks(const std::string& path,
                                                    const ImportOptions& options) {
  auto counted = std::make_unique<LvmReader>(path, options);
  if (counted->count()) return std::make_unique<LargeLvm>(std::move(counted));
  return LvmReader(path, options).read(true);
}

}  // namespace impactrig::acquisition
