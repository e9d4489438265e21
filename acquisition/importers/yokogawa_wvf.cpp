// SPDX-License-Identifier: BSD-3-Clause
// Waveforms of Yokogawa DL oscilloscopes and WE7000: a head in text (.hdr), samples in the .wvf
// beside it.
//
// Source: Yokogawa, Technical Information TI 7000-21 E (1998), and the description of the fields in
// IM 707713-61E (2003).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <utility>

#include "acquisition/importers/column_heads.hpp"
#include "acquisition/importers/date_time.hpp"
#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/header_fields.hpp"
#include "acquisition/importers/mapped_file.hpp"
#include "acquisition/importers/marked_numbers.hpp"
#include "acquisition/importers/number.hpp"
#include "acquisition/importers/start_times.hpp"
#include "acquisition/importers/stored_numbers.hpp"
#include "acquisition/importers/text_file.hpp"
#include "acquisition/importers/text_table.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::InputError;
using datasets::Record;
using datasets::SourcePosition;

namespace {

constexpr std::string_view signature = "//YOKOGAWA ASCII FILE FORMAT";

/// A key of the head and its values.
struct Field {
  std::vector<std::string_view> values;
  int line = 0;
};

/// "$Group1" and what stands below it.
struct Section {
  std::string name;
  int line = 0;
  std::map<std::string, Field> fields;
};

/// Numbers as they are stored that mean something else; NaN where there are none.
struct BeyondRange {
  double above = std::nan("");    ///< and all that are larger
  double below = std::nan("");    ///< and all that are smaller
  double illegal = std::nan("");  ///< no sample

  bool holds(double raw) const { return raw >= above || raw <= below || raw == illegal; }
};

/// One trace of a group.
struct Trace {
  Channel channel;
  NumberKind kind = NumberKind::i16;
  std::uint64_t samples = 0;  ///< of a block
  BeyondRange beyond;

  std::uint64_t bytes() const { return samples * size_of(kind); }
};

/// Samples beyond the range of their input, by channels.
struct BeyondRangeRule {
  std::vector<BeyondRange> beyond;

  bool is_none(std::size_t channel, double stored) const { return beyond[channel].holds(stored); }

  std::string warning(const std::string& name, std::uint64_t found, std::uint64_t) const {
    return fmt::format("'{}': {} sample{} beyond the input's range or missing; marked as not valid",
                       name, found, found == 1 ? " is" : "s are");
  }
};

/// Reads a head and finds the samples that it describes.
class YokogawaHead {
 public:
  explicit YokogawaHead(const std::string& path) : path_(path), text_(path) { divide(); }

  std::unique_ptr<RecordingReader> open() {
    const Section& common = section("$PublicInfo");
    for (const auto& [key, field] : common.fields)
      if (!field.values.empty()) record_.attributes[key] = to_utf8(field.values.front());
    const bool by_blocks = one_of(common, "DataFormat", "trace", "block");
    big_endian_ = !one_of(common, "Endian", "big", "ltl");
    at_ = whole_number(common, "DataOffset", 0);
    samples_ = samples_file();
    record_.attributes["samples in"] = std::filesystem::path(samples_->path()).filename().string();
    for (const Section& group : sections_)
      if (group.name.starts_with("$Group")) take_group(group, by_blocks);
    if (record_.channels.empty()) fail(common.line, "the head describes no traces");
    starts_.tell(record_);
    const std::uint64_t size = samples_->bytes().size();
    if (size > at_)
      record_.warnings.push_back(fmt::format(
          "the file of samples has {} bytes more than the head describes: they are left out",
          size - at_));
    return std::make_unique<MarkedNumbers<BeyondRangeRule>>(
        reader_of_numbers(std::move(samples_), std::move(record_), std::move(stored_)),
        BeyondRangeRule{std::move(beyond_)});
  }

 private:
  [[noreturn]] void fail(int line, const std::string& problem) const {
    SourcePosition place;
    place.file = path_;
    place.line = line;
    throw InputError(place, problem);
  }

  void divide() {
    const std::string_view text = text_.bytes();
    const char* at = text.data();
    const char* const end = at + text.size();
    for (int line = 1; at != end; ++line) {
      auto words = cells_of(take_line(at, end), ' ');
      if (words.empty() || words.front().starts_with("//")) continue;
      if (words.front().starts_with('$')) {
        sections_.push_back({to_utf8(words.front()), line, {}});
      } else if (!sections_.empty()) {
        Field& field = sections_.back().fields[to_utf8(words.front())];
        field.values.assign(words.begin() + 1, words.end());
        field.line = line;
      }
    }
  }

  const Section& section(const std::string& name) const {
    const auto found = std::ranges::find(sections_, name, &Section::name);
    if (found == sections_.end()) fail(1, fmt::format("expected a section {}", name));
    return *found;
  }

  const Field& field(const Section& of, const std::string& key) const {
    const auto found = of.fields.find(key);
    if (found == of.fields.end() || found->second.values.empty())
      fail(of.line, fmt::format("expected '{}' in the section {}", key, of.name));
    return found->second;
  }

  /// Which of two words a field holds: false the first, true the second.
  bool one_of(const Section& of, const std::string& key, std::string_view first,
              std::string_view second) const {
    const Field& says = field(of, key);
    const std::string word = lowered(says.values.front());
    if (word != first && word != second)
      fail(says.line, fmt::format("{}: expected '{}' or '{}', found '{}'", key, first, second,
                                  to_utf8(says.values.front())));
    return word == second;
  }

  /// The value of a trace.
  std::string_view value(const Section& group, const std::string& key, std::size_t trace) const {
    const Field& says = field(group, key);
    if (trace >= says.values.size())
      fail(says.line,
           fmt::format("{}: expected a value a trace, found {}", key, says.values.size()));
    return says.values[trace];
  }

  double number(const Section& group, const std::string& key, std::size_t trace) const {
    const std::string_view cell = value(group, key, trace);
    const auto found = number_in(cell, {'.', false});
    if (!found || !std::isfinite(*found))
      fail(field(group, key).line,
           fmt::format("{}: expected a number, found '{}'", key, to_utf8(cell)));
    return *found;
  }

  std::uint64_t whole_number(const Section& of, const std::string& key, std::size_t trace) const {
    const Field& says = field(of, key);
    constexpr long most = 1L << 40;  // products of three such are not made
    const std::string_view cell = trace < says.values.size() ? says.values[trace] : "nothing";
    const auto found = integer_in(cell);
    if (!found || *found < 0 || *found > most)
      fail(says.line, fmt::format("{}: expected a whole number, found '{}'", key, to_utf8(cell)));
    return static_cast<std::uint64_t>(*found);
  }

  /// The .wvf beside the head.
  std::unique_ptr<MappedFile> samples_file() const {
    const std::string beside = samples_of_yokogawa_wvf(path_);
    if (!beside.empty()) return std::make_unique<MappedFile>(beside);
    fail(0,
         fmt::format("this head describes samples in '{}' beside it, which is not there",
                     std::filesystem::path(path_).replace_extension(".wvf").filename().string()));
  }

  NumberKind kind_of(const Section& group, std::size_t trace) const {
    const std::string word = lowered(value(group, "VDataType", trace));
    constexpr std::array<std::pair<std::string_view, NumberKind>, 10> kinds = {
        {{"is1", NumberKind::i8},
         {"is2", NumberKind::i16},
         {"is4", NumberKind::i32},
         {"iu1", NumberKind::u8},
         {"iu2", NumberKind::u16},
         {"iu4", NumberKind::u32},
         {"fs4", NumberKind::f32},
         {"fu4", NumberKind::f32},
         {"fs8", NumberKind::f64},
         {"fu8", NumberKind::f64}}};
    for (const auto& [name, kind] : kinds)
      if (name == word) return kind;
    fail(
        field(group, "VDataType").line,
        fmt::format("VDataType: samples of the type '{}' are not read: save the waveform as CSV on "
                    "the oscilloscope, with its times",
                    to_utf8(value(group, "VDataType", trace))));
  }

  /// A number that stands for none, where the head states one ("NAN" where it does not).
  double mark(const Section& group, const std::string& key, std::size_t trace) const {
    const auto found = group.fields.find(key);
    if (found == group.fields.end() || trace >= found->second.values.size()) return std::nan("");
    return number_in(found->second.values[trace], {'.', false}).value_or(std::nan(""));
  }

  Trace trace_of(const Section& group, std::size_t trace) const {
    Trace made;
    made.channel.name = input_name(to_utf8(value(group, "TraceName", trace)));
    made.kind = kind_of(group, trace);
    made.samples = whole_number(group, "BlockSize", trace);
    made.channel.scale = number(group, "VResolution", trace);
    made.channel.offset = number(group, "VOffset", trace);
    set_unit(made.channel, to_utf8(value(group, "VUnit", trace)));
    set_axis(made.channel, number(group, "HOffset", trace), number(group, "HResolution", trace),
             to_utf8(value(group, "HUnit", trace)));
    made.beyond = {mark(group, "VPlusOverData", trace), mark(group, "VMinusOverData", trace),
                   mark(group, "VIllegalData", trace)};
    if (made.beyond.above <= made.beyond.below) made.beyond = {};
    return made;
  }

  /// Samples lie trace after trace with all blocks of each, or block after block with all traces.
  void take_group(const Section& group, bool by_blocks) {
    const std::uint64_t traces = whole_number(group, "TraceNumber", 0);
    const std::uint64_t blocks = whole_number(group, "BlockNumber", 0);
    if (traces > most_channels || blocks > most_channels ||
        record_.channels.size() + traces * blocks > most_channels)
      fail(group.line, fmt::format("{} traces of {} blocks are more than {} channels", traces,
                                   blocks, most_channels));
    std::vector<Trace> made;
    for (std::size_t t = 0; t < traces; ++t) made.push_back(trace_of(group, t));
    std::uint64_t all = 0;  // bytes of one block of all traces
    for (const Trace& trace : made) all += trace.bytes();
    std::uint64_t before = 0;  // bytes of one block of the traces before
    for (const Trace& trace : made) {
      for (std::uint64_t b = 0; b < blocks; ++b)
        add(trace, b, blocks,
            at_ + (by_blocks ? b * all + before : blocks * before + b * trace.bytes()));
      before += trace.bytes();
    }
    at_ += blocks * all;
    if (at_ > std::uint64_t{1} << 62) fail(group.line, "the head describes more than a file holds");
    take_starts(group);
  }

  void add(const Trace& trace, std::uint64_t block, std::uint64_t blocks, std::uint64_t at) {
    Channel channel = trace.channel;
    if (blocks > 1) channel.name += fmt::format(", block {}", block + 1);
    StoredChannel stored;
    stored.samples =
        numbers_at(*samples_, at, trace.samples, trace.kind, big_endian_, channel.name, record_);
    stored_.push_back(std::move(stored));
    beyond_.push_back(trace.beyond);
    record_.channels.push_back(std::move(channel));
  }

  /// When the first block of each trace was recorded.
  void take_starts(const Section& group) {
    const auto date = group.fields.find("Date");
    const auto time = group.fields.find("Time");
    if (date == group.fields.end() || time == group.fields.end()) return;
    const auto& dates = date->second.values;
    const auto& times = time->second.values;
    for (std::size_t i = 0; i < std::min(dates.size(), times.size()); ++i) {
      const auto found = date_time_in(fmt::format("{} {}", dates[i], times[i]));
      if (!found) continue;
      if (record_.started.empty()) record_.started = found->iso();
      starts_.add(found->iso());
    }
  }

  std::string path_;
  StartTimes starts_;
  MappedFile text_;
  std::vector<Section> sections_;
  Record record_;
  std::unique_ptr<MappedFile> samples_;
  std::vector<StoredChannel> stored_;
  std::vector<BeyondRange> beyond_;
  std::uint64_t at_ = 0;  ///< of the next group's samples
  bool big_endian_ = false;
};

}  // namespace

int recognises_yokogawa_wvf(std::string_view, std::string_view head) {
  return head.starts_with(signature) ? 100 : 0;
}

std::string samples_of_yokogawa_wvf(const std::string& path) {
  for (const char* const ending : {".wvf", ".WVF"}) {
    std::filesystem::path beside(path);
    beside.replace_extension(ending);
    if (std::filesystem::exists(beside)) return beside.string();
  }
  return {};
}

std::unique_ptr<RecordingReader> open_yokogawa_wvf(const std::string& path, const ImportOptions&) {
  return YokogawaHead(path).open();
}

}  // namespace impactrig::acquisition
