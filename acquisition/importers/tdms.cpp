// SPDX-License-Identifier: BSD-3-Clause
// NI TDMS. Layout: National Instruments, "TDMS File Format Internal Structure" (2023).
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "acquisition/importers/byte_cursor.hpp"
#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/tdms_changes.hpp"
#include "acquisition/importers/tdms_chunks.hpp"
#include "acquisition/importers/tdms_objects.hpp"
#include "acquisition/importers/tdms_recording.hpp"
#include "acquisition/importers/text_file.hpp"

namespace impactrig::acquisition {

using datasets::Record;

namespace {

constexpr std::uint64_t lead_in_size = 28;
constexpr std::uint64_t unfinished = ~std::uint64_t{0};

// Table of contents of a segment.
constexpr std::uint32_t has_metadata = 0x02;
constexpr std::uint32_t has_new_list = 0x04;
constexpr std::uint32_t has_raw_data = 0x08;
constexpr std::uint32_t is_interleaved = 0x20;
constexpr std::uint32_t is_big_endian = 0x40;

// What stands in place of the length of a raw data index.
constexpr std::uint32_t no_raw_data = 0xFFFFFFFF;
constexpr std::uint32_t same_as_before = 0;

// Limits, so that memory and time grow with the file alone.
constexpr std::size_t most_objects = 100000;
constexpr std::size_t most_properties = 500000;

/// "/'Group'/'Dr. T''s Channel'" taken apart; none when it is no path.
std::optional<std::vector<std::string>> path_parts(std::string_view path) {
  std::vector<std::string> parts;
  if (path == "/") return parts;
  while (!path.empty()) {
    if (!path.starts_with("/'")) return std::nullopt;
    path.remove_prefix(2);
    std::string part;
    for (;;) {
      const std::size_t quote = path.find('\'');
      if (quote == std::string_view::npos) return std::nullopt;
      part += path.substr(0, quote);
      path.remove_prefix(quote + 1);
      if (!path.starts_with('\'')) break;
      part += '\'';
      path.remove_prefix(1);
    }
    parts.push_back(to_utf8(part));
  }
  return parts;
}

class TdmsReader {
 public:
  TdmsReader(const std::string& path, const ImportOptions& options)
      : file_(std::make_unique<MappedFile>(path)),
        options_(options),
        size_(file_->bytes().size()),
        chunks_(*file_, objects_),
        changes_(*file_, objects_, options.sample_rate.has_value()) {}

  std::unique_ptr<RecordingReader> open() {
    for (std::uint64_t at = 0; at < size_;) {
      const std::optional<std::uint64_t> next = read_segment(at);
      if (!next) break;
      at = *next;
    }
    for (std::string& warning : changes_.warnings()) warn(std::move(warning));
    return tdms_recording(std::move(file_), objects_, std::move(record_), options_);
  }

 private:
  [[noreturn]] void fail(std::uint64_t at, std::string_view problem) const {
    fail_in_tdms(*file_, at, problem);
  }

  void warn(std::string sentence) {
    if (std::ranges::find(record_.warnings, sentence) == record_.warnings.end())
      record_.warnings.push_back(std::move(sentence));
  }

  /// A segment whose lead-in has been read.
  struct Segment {
    std::uint32_t contents = 0;
    std::uint64_t begin = 0;   ///< behind the lead-in
    std::uint64_t data = 0;    ///< its raw data
    std::uint64_t end = 0;     ///< in the file
    std::uint64_t length = 0;  ///< announced, from `begin` on
    bool cut = false;          ///< ends with the file

    bool has(std::uint32_t what) const { return (contents & what) != 0; }

    bool open_end() const { return length == unfinished; }
  };

  /// Reads the head of a segment; returns where the next one begins, none where reading ends.
  std::optional<std::uint64_t> read_segment(std::uint64_t at) {
    ByteCursor in(*file_, false, at);
    if (!begins_segment(in)) return std::nullopt;
    const std::optional<Segment> segment = read_lead_in(in, at);
    if (!segment) return std::nullopt;
    changes_.next_segment();
    if (segment->has(has_metadata)) {
      read_list(in, segment->has(has_new_list));
      if (in.at() > segment->data)
        fail(segment->data,
             fmt::format("the head of the segment at byte {} is {} bytes longer than announced", at,
                         in.at() - segment->data));
    }
    if (segment->has(has_raw_data) && segment->end > segment->data)
      read_data(*segment);
    else if (segment->has(has_raw_data) && segment->cut)
      changes_.forget();
    if (segment->has(has_raw_data)) tell_cut(*segment);
    return segment->end;
  }

  /// Whether there is a whole lead-in and its tag. What follows other segments and is none is told.
  bool begins_segment(ByteCursor& in) {
    const std::uint64_t at = in.at();
    if (size_ - at < lead_in_size) {
      if (at == 0)
        fail(size_,
             fmt::format("the file ends within the lead-in of the first segment, after {} of "
                         "{} bytes",
                         size_, lead_in_size));
      warn(fmt::format("the file ends within a segment's lead-in: the last {} bytes are left out",
                       size_ - at));
      return false;
    }
    const std::string_view tag = in.bytes(4, "a segment's tag");
    if (tag == "TDSm") return true;
    if (at == 0)
      fail(at,
           fmt::format("expected a segment, which begins with 'TDSm', found '{}'", to_utf8(tag)));
    warn(
        fmt::format("at byte {} no segment begins where one was announced: the last {} bytes are "
                    "left out",
                    at, size_ - at));
    return false;
  }

  /// The lead-in behind its tag; none where the file ends within the head of a segment.
  std::optional<Segment> read_lead_in(ByteCursor& in, std::uint64_t at) {
    Segment segment;
    segment.contents = in.read<std::uint32_t>("a segment's contents");
    in.set_big_endian(segment.has(is_big_endian));
    const auto version = in.read<std::uint32_t>("a segment's version");
    if (version != 4712 && version != 4713)
      warn(fmt::format("a segment is of version {}, known are 4712 and 4713", version));
    segment.length = in.read<std::uint64_t>("a segment's length");
    const auto raw_offset = in.read<std::uint64_t>("the place of a segment's raw data");
    segment.begin = in.at();
    segment.cut = segment.open_end() || segment.length > size_ - segment.begin;
    segment.end = segment.cut ? size_ : segment.begin + segment.length;
    segment.data = segment.begin + raw_offset;
    if (raw_offset <= segment.end - segment.begin) return segment;
    if (!segment.cut)
      fail(segment.begin,
           fmt::format("the raw data of a segment are announced {} bytes behind its head, "
                       "the segment has {}",
                       raw_offset, segment.end - segment.begin));
    if (objects_.empty()) fail(size_, "the file ends within the head of the first segment");
    warn(
        fmt::format("the file ends within the head of the segment at byte {}: it is left out", at));
    return std::nullopt;
  }

  void read_data(const Segment& segment) {
    changes_.before_data(segment.data);
    std::string warning = chunks_.place(segment.has(is_big_endian), segment.has(is_interleaved),
                                        segment.data, segment.end - segment.data, segment.cut);
    if (!warning.empty()) warn(std::move(warning));
  }

  void tell_cut(const Segment& segment) {
    if (segment.open_end())
      warn("the recording was not closed (aborted?): its last segment is read as far as it goes");
    else if (segment.cut)
      warn(fmt::format("the file ends {} bytes before its last segment does: what is there is read",
                       segment.length - (size_ - segment.begin)));
  }

  std::size_t object(std::string_view path, std::uint64_t at) {
    const auto known = by_path_.find(path);
    if (known != by_path_.end()) return known->second;
    const auto parts = path_parts(path);
    if (!parts || parts->size() > 2)
      fail(at, fmt::format("expected the path of a group or channel, found '{}'",
                           to_utf8(path.substr(0, 80))));
    if (objects_.size() == most_objects)
      fail(at, fmt::format("there are more than {} groups and channels", most_objects));
    TdmsObject made;
    made.path = to_utf8(path.substr(0, 200));
    made.depth = static_cast<int>(parts->size());
    if (made.depth > 0) made.group = parts->front();
    if (made.depth > 1) made.name = parts->back();
    by_path_.emplace(path, objects_.size());
    objects_.push_back(std::move(made));
    return objects_.size() - 1;
  }

  void read_list(ByteCursor& in, bool new_list) {
    if (new_list) chunks_.start_list(in.at());
    const auto count = in.read<std::uint32_t>("the number of objects in a segment");
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint64_t at = in.at();
      const std::size_t which = object(read_tdms_text(in, "the path of an object"), at);
      read_index(in, objects_[which]);
      chunks_.list(which);
      read_properties(in, which);
    }
  }

  void read_index(ByteCursor& in, TdmsObject& object) {
    const std::uint64_t at = in.at();
    const auto header = in.read<std::uint32_t>("a raw data index");
    const bool has_data = header != no_raw_data;
    if (has_data != object.has_data) chunks_.set_changed();
    object.has_data = has_data;
    if (!has_data) return;
    if (header == same_as_before) {
      if (!object.index)
        fail(at,
             fmt::format("{} refers to an earlier raw data index and there is none", object.path));
      return;
    }
    chunks_.set_changed();
    object.index = read_tdms_index(*file_, in, header, object);
  }

  void read_properties(ByteCursor& in, std::size_t which) {
    const auto count = in.read<std::uint32_t>("the number of properties");
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::string name = to_utf8(read_tdms_text(in, "the name of a property"));
      const std::uint64_t at = in.at();
      const auto code = in.read<std::uint32_t>("the type of a property");
      std::optional<TdmsProperty> value = read_tdms_value(in, code);
      if (!value)
        fail(at, fmt::format("the property '{}' of {} is of the type 0x{:X}, which is not read",
                             name, objects_[which].path, code));
      if (changes_.set(which, name, std::move(*value)) && ++properties_ > most_properties)
        fail(at, fmt::format("there are more than {} properties", most_properties));
    }
  }

  std::unique_ptr<MappedFile> file_;
  const ImportOptions& options_;
  std::uint64_t size_;
  Record record_;
  std::vector<TdmsObject> objects_;  // in the order of their first mention
  std::unordered_map<std::string_view, std::size_t> by_path_;  // paths lie in the file
  std::size_t properties_ = 0;
  TdmsChunks chunks_;
  TdmsChanges changes_;
};

}  // namespace

int recognises_tdms(std::string_view, std::string_view head) {
  return head.starts_with("TDSm") ? 100 : 0;
}

std::unique_ptr<RecordingReader> open_tdms(const std::string& path, const ImportOptions& options) {
  return TdmsReader(path, options).open();
}

}  // namespace impactrig::acquisition
