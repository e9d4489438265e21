// SPDX-License-Identifier: BSD-3-Clause
// NI TDMS. Layout: National Instruments, "TDMS File Format Internal Structure" (2023); the digital
// line scaler (0x126A in files, 0x1369 in that text) and the types of DAQmx scalers as files have
// them.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <unordered_map>

#include "acquisition/importers/byte_cursor.hpp"
#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/stored_numbers.hpp"
#include "acquisition/importers/tdms_scaling.hpp"
#include "acquisition/importers/text_file.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::InputError;
using datasets::Quantity;
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
constexpr std::uint32_t format_changing_scaler = 0x1269;
constexpr std::uint32_t digital_line_scaler = 0x126A;
constexpr std::uint32_t digital_line_scaler_as_documented = 0x1369;

// Limits, so that memory and time grow with the file alone.
constexpr std::size_t most_objects = 100000;
constexpr std::size_t most_properties = 500000;
constexpr std::uint64_t most_chunk_bytes = std::uint64_t{1} << 46;  // of one channel: 70 TB

/// What the numbers of a type are to us.
enum class Role { number, complex, time, text, nothing, unsupported };

struct Type {
  std::uint32_t code;
  std::string_view name;
  Role role;
  NumberKind kind;
  std::uint32_t size;  ///< [bytes]; 0 text and nothing
};

constexpr std::uint32_t text_type = 0x20;
constexpr std::uint32_t time_type = 0x44;
constexpr std::uint32_t daqmx_raw_type = 0xFFFFFFFF;

constexpr std::array<Type, 20> types = {{
    {0x00, "void", Role::nothing, NumberKind::u8, 0},                               //
    {0x01, "8-bit integer", Role::number, NumberKind::i8, 1},                       //
    {0x02, "16-bit integer", Role::number, NumberKind::i16, 2},                     //
    {0x03, "32-bit integer", Role::number, NumberKind::i32, 4},                     //
    {0x04, "64-bit integer", Role::number, NumberKind::i64, 8},                     //
    {0x05, "unsigned 8-bit integer", Role::number, NumberKind::u8, 1},              //
    {0x06, "unsigned 16-bit integer", Role::number, NumberKind::u16, 2},            //
    {0x07, "unsigned 32-bit integer", Role::number, NumberKind::u32, 4},            //
    {0x08, "unsigned 64-bit integer", Role::number, NumberKind::u64, 8},            //
    {0x09, "single precision", Role::number, NumberKind::f32, 4},                   //
    {0x0A, "double precision", Role::number, NumberKind::f64, 8},                   //
    {0x0B, "extended precision", Role::unsupported, NumberKind::f64, 0},            //
    {0x19, "single precision with unit", Role::number, NumberKind::f32, 4},         //
    {0x1A, "double precision with unit", Role::number, NumberKind::f64, 8},         //
    {0x1B, "extended precision with unit", Role::unsupported, NumberKind::f64, 0},  //
    {0x20, "text", Role::text, NumberKind::u8, 0},                                  //
    {0x21, "boolean", Role::number, NumberKind::u8, 1},                             //
    {0x44, "time stamp", Role::time, NumberKind::i64, 16},                          //
    {0x08000C, "complex single precision", Role::complex, NumberKind::f32, 8},      //
    {0x10000D, "complex double precision", Role::complex, NumberKind::f64, 16},     //
}};

const Type* type_of(std::uint32_t code) {
  const auto found = std::ranges::find(types, code, &Type::code);
  return found == types.end() ? nullptr : &*found;
}

/// The types of DAQmx scalers, by their code.
constexpr std::array<NumberKind, 10> daqmx_kinds = {
    NumberKind::u8,  NumberKind::i8,  NumberKind::u16, NumberKind::i16, NumberKind::u32,
    NumberKind::i32, NumberKind::u64, NumberKind::i64, NumberKind::f32, NumberKind::f64};

/// Where a DAQmx channel's numbers lie within a row of one of the raw buffers.
struct Scaler {
  std::uint32_t id;
  NumberKind kind;
  std::uint32_t buffer;
  std::uint32_t offset;  ///< [bytes]
  int bit;               ///< of a digital line, from 0; -1 the whole number
};

/// What a chunk of raw data holds of a channel.
struct RawIndex {
  const Type* type = nullptr;  ///< null for DAQmx raw data
  std::uint64_t count = 0;     ///< values in a chunk
  std::uint64_t bytes = 0;     ///< in a chunk; DAQmx: shared, 0
  bool daqmx = false;
  std::vector<Scaler> scalers{};
  std::vector<std::uint32_t> widths{};  ///< of the rows of each raw buffer [bytes]
};

/// The numbers of a channel from one scaler (DAQmx), or all it has.
struct Source {
  std::uint32_t id = TdmsScaling::raw_data;
  int bit = -1;
  StoredNumbers numbers{};
  StoredNumbers imaginary{};
};

struct Object {
  std::string path;
  std::string group;
  std::string name;
  int depth = 0;  ///< 0 the file, 1 a group, 2 a channel
  TdmsProperties properties{};
  std::optional<RawIndex> index{};
  bool listed = false;  ///< in the list of the segment at hand
  bool has_data = false;
  const Type* type = nullptr;  ///< of the raw data so far
  std::vector<Source> sources{};
  std::uint64_t texts = 0;
  std::uint64_t first_value = 0;  ///< byte offsets of a time stamp channel's ends
  std::uint64_t last_value = 0;
};

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
        size_(file_->bytes().size()) {}

  std::unique_ptr<RecordingReader> open() {
    for (std::uint64_t at = 0; at < size_;) {
      const std::optional<std::uint64_t> next = read_segment(at);
      if (!next) break;
      at = *next;
    }
    describe();
    return reader_of_numbers(std::move(file_), std::move(record_), std::move(stored_));
  }

 private:
  [[noreturn]] void fail(std::uint64_t at, std::string_view problem) const {
    throw InputError(file_->byte_position(std::min(at, size_)), problem);
  }

  void warn(std::string sentence) {
    if (std::ranges::find(record_.warnings, sentence) == record_.warnings.end())
      record_.warnings.push_back(std::move(sentence));
  }

  /// Counts steps that a file of few bytes could ask for again and again.
  void spend(std::uint64_t steps, std::uint64_t at) {
    steps_ += steps;
    if (steps_ > 10000000 + 64 * size_)
      fail(at, "the list of channels changes in so many segments that reading it would not end");
  }

  /// Reads the head of a segment; returns where the next one begins, none where reading ends.
  std::optional<std::uint64_t> read_segment(std::uint64_t at) {
    if (size_ - at < lead_in_size) {
      if (at == 0)
        fail(size_,
             fmt::format("the file ends within the lead-in of the first segment, after {} of "
                         "{} bytes",
                         size_, lead_in_size));
      warn(fmt::format("the file ends within a segment's lead-in: the last {} bytes are left out",
                       size_ - at));
      return std::nullopt;
    }
    ByteCursor in(*file_, false, at);
    const std::string_view tag = in.bytes(4, "a segment's tag");
    if (tag != "TDSm") {
      if (at == 0)
        fail(at,
             fmt::format("expected a segment, which begins with 'TDSm', found '{}'", to_utf8(tag)));
      warn(
          fmt::format("at byte {} no segment begins where one was announced: the last {} bytes are "
                      "left out",
                      at, size_ - at));
      return std::nullopt;
    }
    const auto contents = in.read<std::uint32_t>("a segment's contents");
    in.set_big_endian((contents & is_big_endian) != 0);
    const auto version = in.read<std::uint32_t>("a segment's version");
    if (version != 4712 && version != 4713)
      warn(fmt::format("a segment is of version {}, known are 4712 and 4713", version));
    const auto length = in.read<std::uint64_t>("a segment's length");
    const auto raw_offset = in.read<std::uint64_t>("the place of a segment's raw data");
    const std::uint64_t begin = in.at();
    const bool open_end = length == unfinished;
    const bool cut = open_end || length > size_ - begin;
    const std::uint64_t end = cut ? size_ : begin + length;
    if (raw_offset > end - begin) {
      if (!cut)
        fail(begin, fmt::format("the raw data of a segment are announced {} bytes behind its head, "
                                "the segment has {}",
                                raw_offset, end - begin));
      if (objects_.empty()) fail(size_, "the file ends within the head of the first segment");
      warn(fmt::format("the file ends within the head of the segment at byte {}: it is left out",
                       at));
      return std::nullopt;
    }
    const std::uint64_t data = begin + raw_offset;
    if ((contents & has_metadata) != 0) {
      read_list(in, (contents & has_new_list) != 0);
      if (in.at() > data)
        fail(data,
             fmt::format("the head of the segment at byte {} is {} bytes longer than announced", at,
                         in.at() - data));
    }
    if ((contents & has_raw_data) != 0 && end > data) {
      place_data(contents, data, end - data, cut);
      if (open_end)
        warn("the recording was not closed (aborted?): its last segment is read as far as it goes");
      else if (cut)
        warn(fmt::format(
            "the file ends {} bytes before its last segment does: what is there is read",
            length - (size_ - begin)));
    }
    return end;
  }

  std::string_view text(ByteCursor& in, std::string_view what) {
    const auto length = in.read<std::uint32_t>(what);
    return in.bytes(length, what);
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
    Object made;
    made.path = to_utf8(path.substr(0, 200));
    made.depth = static_cast<int>(parts->size());
    if (made.depth > 0) made.group = parts->front();
    if (made.depth > 1) made.name = parts->back();
    by_path_.emplace(path, objects_.size());
    if (made.depth == 1) groups_.emplace(made.group, objects_.size());
    objects_.push_back(std::move(made));
    return objects_.size() - 1;
  }

  void read_list(ByteCursor& in, bool new_list) {
    if (new_list) {
      spend(list_.size(), in.at());
      for (const std::size_t i : list_) objects_[i].listed = objects_[i].has_data = false;
      list_.clear();
      changed_ = true;
    }
    const auto count = in.read<std::uint32_t>("the number of objects in a segment");
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint64_t at = in.at();
      const std::size_t which = object(text(in, "the path of an object"), at);
      read_index(in, objects_[which]);
      if (!objects_[which].listed) {
        objects_[which].listed = true;
        list_.push_back(which);
      }
      read_properties(in, objects_[which]);
    }
  }

  void read_index(ByteCursor& in, Object& object) {
    const std::uint64_t at = in.at();
    const auto header = in.read<std::uint32_t>("a raw data index");
    const bool has_data = header != no_raw_data;
    changed_ = changed_ || has_data != object.has_data;
    object.has_data = has_data;
    if (!has_data) return;
    if (header == same_as_before) {
      if (!object.index)
        fail(at,
             fmt::format("{} refers to an earlier raw data index and there is none", object.path));
      return;
    }
    changed_ = true;
    RawIndex index;
    if (header == format_changing_scaler || header == digital_line_scaler ||
        header == digital_line_scaler_as_documented)
      index = daqmx_index(in, object, header != format_changing_scaler);
    else
      index = plain_index(in, object);
    object.index = std::move(index);
  }

  const Type& known_type(std::uint32_t code, const Object& object, std::uint64_t at) const {
    const Type* const type = type_of(code);
    if (type == nullptr)
      fail(at, fmt::format("{} has data of the unknown type 0x{:X}", object.path, code));
    return *type;
  }

  std::uint64_t counted(ByteCursor& in, const Object& object) {
    const std::uint64_t at = in.at();
    const auto dimensions = in.read<std::uint32_t>("the dimensions of raw data");
    if (dimensions != 1)
      fail(at, fmt::format("{} has data of {} dimensions, 1 is expected", object.path, dimensions));
    return in.read<std::uint64_t>("the number of values in a chunk");
  }

  RawIndex plain_index(ByteCursor& in, const Object& object) {
    const std::uint64_t at = in.at();
    RawIndex index;
    index.type = &known_type(in.read<std::uint32_t>("the type of raw data"), object, at);
    index.count = counted(in, object);
    if (index.type->role == Role::unsupported && index.count > 0)
      fail(at,
           fmt::format("{} has numbers of {}, whose width in a file is not published: convert the "
                       "channel to double precision with the program that wrote it",
                       object.path, index.type->name));
    if (index.type->role == Role::text) {
      index.bytes = in.read<std::uint64_t>("the size of texts");
      if (index.bytes > most_chunk_bytes)
        fail(at, fmt::format("{} announces {} bytes of text in a chunk", object.path, index.bytes));
      return index;
    }
    if (index.type->size == 0) {
      index.count = 0;
      return index;
    }
    if (index.count > most_chunk_bytes / index.type->size)
      fail(at, fmt::format("{} announces {} values of {} bytes in a chunk", object.path,
                           index.count, index.type->size));
    index.bytes = index.count * index.type->size;
    return index;
  }

  RawIndex daqmx_index(ByteCursor& in, const Object& object, bool digital) {
    const std::uint64_t at = in.at();
    RawIndex index;
    index.daqmx = true;
    const auto type = in.read<std::uint32_t>("the type of raw data");
    if (type != daqmx_raw_type) known_type(type, object, at);
    index.count = counted(in, object);
    const auto scalers = in.read<std::uint32_t>("the number of DAQmx scalers");
    for (std::uint32_t i = 0; i < scalers; ++i) {
      const std::uint64_t here = in.at();
      Scaler scaler{};
      const auto kind = in.read<std::uint32_t>("the type of a DAQmx scaler");
      if (kind >= daqmx_kinds.size())
        fail(here, fmt::format("{} has a DAQmx scaler of the unknown type {}", object.path, kind));
      scaler.kind = daqmx_kinds[kind];
      scaler.buffer = in.read<std::uint32_t>("the raw buffer of a DAQmx scaler");
      scaler.offset = in.read<std::uint32_t>("the offset of a DAQmx scaler");
      scaler.bit = -1;
      if (digital) {
        scaler.bit = static_cast<int>(scaler.offset % 8);
        scaler.offset /= 8;
        in.skip(1);  // sample format bitmap
      } else {
        in.skip(4);
      }
      scaler.id = in.read<std::uint32_t>("the scale of a DAQmx scaler");
      index.scalers.push_back(scaler);
    }
    const auto widths = in.read<std::uint32_t>("the number of raw buffers");
    for (std::uint32_t i = 0; i < widths; ++i)
      index.widths.push_back(in.read<std::uint32_t>("the width of a raw buffer"));
    for (const Scaler& scaler : index.scalers) {
      const std::uint64_t last = std::uint64_t{scaler.offset} + size_of(scaler.kind);
      if (scaler.buffer >= index.widths.size())
        fail(at, fmt::format("{} is in the raw buffer {} of {}", object.path, scaler.buffer,
                             index.widths.size()));
      if (last > index.widths[scaler.buffer])
        fail(at, fmt::format("{} lies in bytes {} to {} of the rows of a raw buffer, which have {}",
                             object.path, scaler.offset, last - 1, index.widths[scaler.buffer]));
      if (index.count > most_chunk_bytes / index.widths[scaler.buffer])
        fail(at, fmt::format("{} announces {} values of {} bytes in a chunk", object.path,
                             index.count, index.widths[scaler.buffer]));
    }
    return index;
  }

  void read_properties(ByteCursor& in, Object& object) {
    const auto count = in.read<std::uint32_t>("the number of properties");
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::string name = to_utf8(text(in, "the name of a property"));
      const std::uint64_t at = in.at();
      const auto code = in.read<std::uint32_t>("the type of a property");
      std::optional<TdmsProperty> value = read_value(in, code);
      if (!value)
        fail(at, fmt::format("the property '{}' of {} is of the type 0x{:X}, which is not read",
                             name, object.path, code));
      if (object.properties.insert_or_assign(name, std::move(*value)).second &&
          ++properties_ > most_properties)
        fail(at, fmt::format("there are more than {} properties", most_properties));
    }
  }

  std::optional<TdmsProperty> read_value(ByteCursor& in, std::uint32_t code) {
    constexpr std::string_view what = "the value of a property";
    switch (code) {
      case 0x00:
        return std::string();
      case 0x01:
        return std::int64_t{in.read<std::int8_t>(what)};
      case 0x02:
        return std::int64_t{in.read<std::int16_t>(what)};
      case 0x03:
        return std::int64_t{in.read<std::int32_t>(what)};
      case 0x04:
        return in.read<std::int64_t>(what);
      case 0x05:
        return std::uint64_t{in.read<std::uint8_t>(what)};
      case 0x06:
        return std::uint64_t{in.read<std::uint16_t>(what)};
      case 0x07:
        return std::uint64_t{in.read<std::uint32_t>(what)};
      case 0x08:
        return in.read<std::uint64_t>(what);
      case 0x09:
      case 0x19:
        return double{in.read<float>(what)};
      case 0x0A:
      case 0x1A:
        return in.read<double>(what);
      case text_type:
        return to_utf8(text(in, what));
      case 0x21:
        return std::string(in.read<std::uint8_t>(what) != 0 ? "true" : "false");
      case time_type:
        return read_time(in);
      case 0x08000C: {
        const float re = in.read<float>(what);
        return fmt::format("{}{:+}i", re, in.read<float>(what));
      }
      case 0x10000D: {
        const double re = in.read<double>(what);
        return fmt::format("{}{:+}i", re, in.read<double>(what));
      }
      default:
        return std::nullopt;
    }
  }

  static TdmsTime read_time(ByteCursor& in) {
    constexpr std::string_view what = "a time stamp";
    TdmsTime time;
    if (in.big_endian()) time.seconds = in.read<std::int64_t>(what);
    time.fraction = in.read<std::uint64_t>(what);
    if (!in.big_endian()) time.seconds = in.read<std::int64_t>(what);
    return time;
  }

  /// The rows of a raw buffer in a chunk.
  struct Buffer {
    std::uint64_t rows = 0;
    std::uint64_t width = 0;
  };

  /// Makes active_, chunk_bytes_ and buffers_ fit the list of objects.
  void arrange(std::uint64_t at) {
    spend(list_.size(), at);
    active_.clear();
    buffers_.clear();
    chunk_bytes_ = 0;
    std::size_t daqmx = 0;
    for (const std::size_t i : list_) {
      const Object& object = objects_[i];
      if (!object.has_data || !object.index) continue;
      const RawIndex& index = *object.index;
      if (index.daqmx) {
        ++daqmx;
        active_.push_back(i);
        add_to_buffers(object, at);
      } else if (index.bytes > 0) {
        active_.push_back(i);
        chunk_bytes_ += index.bytes;
      }
    }
    if (daqmx > 0 && daqmx != active_.size())
      fail(at, "a segment mixes DAQmx raw data with other data");
    daqmx_ = daqmx > 0;
    for (const Buffer& buffer : buffers_) chunk_bytes_ += buffer.rows * buffer.width;
    changed_ = false;
  }

  void add_to_buffers(const Object& object, std::uint64_t at) {
    const RawIndex& index = *object.index;
    if (buffers_.empty())
      for (const std::uint32_t width : index.widths) buffers_.push_back({0, width});
    spend(index.widths.size(), at);
    const bool alike = std::ranges::equal(index.widths, buffers_, {}, {}, &Buffer::width);
    if (!alike)
      fail(at, fmt::format(
                   "{} states rows of {} bytes in the DAQmx raw data, the channels before it {}",
                   object.path, widths_text(index.widths), widths_text(buffers_)));
    for (const Scaler& scaler : index.scalers) {
      Buffer& buffer = buffers_[scaler.buffer];
      if (buffer.rows != 0 && buffer.rows != index.count)
        fail(at, fmt::format("{} states {} rows in a DAQmx raw buffer, the channels before it {}",
                             object.path, index.count, buffer.rows));
      buffer.rows = index.count;
    }
  }

  static std::string widths_text(const std::vector<std::uint32_t>& widths) {
    return fmt::format("{}", fmt::join(widths, " + "));
  }

  static std::string widths_text(const std::vector<Buffer>& buffers) {
    std::vector<std::uint32_t> widths;
    for (const Buffer& buffer : buffers) widths.push_back(static_cast<std::uint32_t>(buffer.width));
    return widths_text(widths);
  }

  /// Notes where the raw data of a segment lie: `total` bytes from `data` on.
  void place_data(std::uint32_t contents, std::uint64_t data, std::uint64_t total, bool cut) {
    if (changed_) arrange(data);
    big_endian_ = (contents & is_big_endian) != 0;
    if (chunk_bytes_ == 0) {
      warn(fmt::format("{} bytes of raw data from byte {} on belong to no channel", total, data));
      return;
    }
    const std::uint64_t chunks = total / chunk_bytes_;
    const std::uint64_t rest = total % chunk_bytes_;
    if (rest > 0) spend(active_.size(), data);
    if (daqmx_) {
      place_buffers(data, chunks, buffers_);
      if (rest > 0) place_buffers(data + chunks * chunk_bytes_, 1, buffers_within(rest));
    } else if ((contents & is_interleaved) != 0) {
      place_rows(data, total);
    } else {
      place_blocks(data, chunks);
      if (rest > 0) place_part(data + chunks * chunk_bytes_, rest, cut);
    }
    if (rest > 0 && !cut)
      warn(fmt::format(
          "the {} bytes of raw data from byte {} on are no whole number of chunks of {} "
          "bytes: the last one is read in part",
          total, data, chunk_bytes_));
  }

  /// Each channel's values of a chunk lie together.
  void place_blocks(std::uint64_t data, std::uint64_t chunks) {
    if (chunks == 0) return;
    const bool alone = active_.size() == 1;
    for (const std::size_t i : active_) {
      const RawIndex& index = *objects_[i].index;
      if (alone && index.type->role != Role::text)
        add(objects_[i], data, index.count * chunks, 1);
      else
        add(objects_[i], data, index.count, chunks);
      data += index.bytes;
    }
  }

  /// A chunk that is not whole. In a file that was cut off the channels are there one after the
  /// other; else each has the same share of its values, as npTDMS found in files of its users.
  void place_part(std::uint64_t data, std::uint64_t rest, bool cut) {
    const std::uint64_t end = data + rest;
    for (const std::size_t i : active_) {
      const RawIndex& index = *objects_[i].index;
      if (index.type->role == Role::text) {
        if (end - data < index.bytes) return;
        add(objects_[i], data, index.count, 1);
        data += index.bytes;
        continue;
      }
      const auto share = static_cast<std::uint64_t>(static_cast<long double>(index.count) *
                                                    static_cast<long double>(rest) /
                                                    static_cast<long double>(chunk_bytes_));
      const std::uint64_t there = (end - data) / index.type->size;
      const std::uint64_t count = std::min({cut ? index.count : share, index.count, there});
      if (count > 0) add(objects_[i], data, count, 1);
      data += count * index.type->size;
      if (cut && count < index.count) return;
    }
  }

  /// One value of each channel, then the next of each.
  void place_rows(std::uint64_t data, std::uint64_t total) {
    std::uint64_t width = 0;
    const std::uint64_t count = objects_[active_.front()].index->count;
    for (const std::size_t i : active_) {
      const Object& object = objects_[i];
      if (object.index->type->role == Role::text)
        fail(data, fmt::format("{} has texts among interleaved data", object.path));
      if (object.index->count != count)
        fail(data,
             fmt::format("{} has {} values in a chunk of interleaved data, the channels before "
                         "it {}",
                         object.path, object.index->count, count));
      width += object.index->type->size;
    }
    const std::uint64_t rows = total / width;
    if (rows == 0) return;
    for (const std::size_t i : active_) {
      add(objects_[i], data, rows, 1, width);
      data += objects_[i].index->type->size;
    }
  }

  std::vector<Buffer> buffers_within(std::uint64_t rest) const {
    std::vector<Buffer> there;
    for (Buffer buffer : buffers_) {
      if (buffer.width > 0) buffer.rows = std::min(buffer.rows, rest / buffer.width);
      rest -= buffer.rows * buffer.width;
      there.push_back(buffer);
      if (buffer.rows < buffers_[there.size() - 1].rows) rest = 0;
    }
    return there;
  }

  void place_buffers(std::uint64_t data, std::uint64_t chunks, const std::vector<Buffer>& buffers) {
    if (chunks == 0) return;
    std::vector<std::uint64_t> begins;
    for (std::uint64_t at = data; const Buffer& buffer : buffers) {
      begins.push_back(at);
      at += buffer.rows * buffer.width;
    }
    for (const std::size_t i : active_) {
      Object& object = objects_[i];
      for (const Scaler& scaler : object.index->scalers) {
        const Buffer& buffer = buffers[scaler.buffer];
        if (buffer.rows == 0) continue;
        Source& source = source_of(object, scaler.id, scaler.kind, scaler.bit, data);
        NumberRun run{begins[scaler.buffer] + scaler.offset, buffer.rows, buffer.width, chunks,
                      chunk_bytes_};
        if (buffers.size() == 1 || chunks == 1) {  // the rows of all chunks follow each other
          run.count *= chunks;
          run.repeats = 1;
        }
        run.other_order = source.numbers.big_endian() != big_endian_;
        source.numbers.add(run);
      }
    }
  }

  Source& source_of(Object& object, std::uint32_t id, NumberKind kind, int bit, std::uint64_t at) {
    for (Source& source : object.sources) {
      const bool raw = source.id == TdmsScaling::raw_data;
      if (raw != (id == TdmsScaling::raw_data))
        fail(at, fmt::format("the type of {} changes within the file", object.path));
      if (source.id != id) continue;
      if (source.numbers.kind() != kind || source.bit != bit)
        fail(at, fmt::format("the type of {} changes within the file", object.path));
      return source;
    }
    if (object.sources.size() == 64)
      fail(at, fmt::format("{} has more than 64 DAQmx scalers", object.path));
    object.sources.push_back({id, bit, StoredNumbers(kind, big_endian_)});
    return object.sources.back();
  }

  /// `count` values from `at` on, each `stride` bytes behind the other (0: side by side), `chunks`
  /// times.
  void add(Object& object, std::uint64_t at, std::uint64_t count, std::uint64_t chunks,
           std::uint64_t stride = 0) {
    const Type& type = *object.index->type;
    if (object.type != nullptr && object.type != &type)
      fail(at, fmt::format("the type of {} changes within the file, from {} to {}", object.path,
                           object.type->name, type.name));
    object.type = &type;
    if (type.role == Role::text) {
      object.texts += count * chunks;
      return;
    }
    if (stride == 0) stride = type.size;
    Source& source = source_of(object, TdmsScaling::raw_data, type.kind, -1, at);
    NumberRun run{at, count, stride, chunks, chunk_bytes_};
    run.other_order = source.numbers.big_endian() != big_endian_;
    if (type.role == Role::time) {
      if (run.other_order)
        fail(at, fmt::format("the byte order of the time stamps {} changes within the file",
                             object.path));
      if (source.numbers.size() == 0) object.first_value = at;
      object.last_value = at + (count - 1) * stride + (chunks - 1) * chunk_bytes_;
      run.offset += 4;  // see set_time_stamps
    }
    source.numbers.add(run);
    if (type.role == Role::complex) {
      run.offset += type.size / 2;
      if (source.imaginary.size() == 0)
        source.imaginary = StoredNumbers(type.kind, source.numbers.big_endian());
      source.imaginary.add(run);
    }
  }

  // From here on: what the file says becomes a record.

  const TdmsProperties* properties_of_group(const std::string& group) const {
    const auto found = groups_.find(group);
    return found == groups_.end() ? nullptr : &objects_[found->second].properties;
  }

  void describe() {
    const TdmsProperties* file = nullptr;
    for (const Object& object : objects_)
      if (object.depth == 0) file = &object.properties;
    if (file != nullptr) {
      for (const auto& [name, value] : *file) record_.attributes[name] = text_of(value);
      for (const char* const name : {"name", "title"})
        if (const auto title = file->find(name); title != file->end() && record_.title.empty())
          record_.title = text_of(title->second);
    }
    for (const Object& object : objects_)
      if (object.depth == 1)
        for (const auto& [name, value] : object.properties)
          record_.attributes[object.group + "/" + name] = text_of(value);
    for (const Object& object : objects_)
      if (object.depth == 2) add_channel(object, file);
    if (record_.channels.empty())
      warn("no recordings in this file: it has no channel with numbers");
    set_uniform_clocks();
    set_clocks_by_channels();
    tell_same_names();
  }

  void add_channel(const Object& object, const TdmsProperties* file) {
    if (object.texts > 0) {
      warn(fmt::format("'{}' holds {} texts: it is left out", object.name, object.texts));
      return;
    }
    Channel channel;
    StoredChannel stored;
    channel.name = object.name;
    channel.attributes["group"] = object.group;
    for (const auto& [name, value] : object.properties)
      if (!name.starts_with("NI_Scale[")) channel.attributes[name] = text_of(value);
    const auto unit = object.properties.find("unit_string");
    if (unit != object.properties.end()) channel.unit = text_of(unit->second);
    const TdmsProperties* scales = &object.properties;
    if (!states_scales(*scales)) scales = properties_of_group(object.group);
    if (scales == nullptr || !states_scales(*scales)) scales = file;
    if (object.type != nullptr && object.type->role == Role::time)
      set_time_stamps(object, channel, stored);
    else
      set_numbers(object, scales, channel, stored);
    set_quantity(channel);
    record_.channels.push_back(std::move(channel));
    stored_.push_back(std::move(stored));
    channels_.push_back(&object);
  }

  void set_quantity(Channel& channel) {
    const auto [known, added] = quantities_.try_emplace(channel.unit, Quantity::unknown);
    if (added) known->second = datasets::quantity_of_unit(channel.unit);
    channel.quantity = known->second;
  }

  void set_numbers(const Object& object, const TdmsProperties* scales, Channel& channel,
                   StoredChannel& stored) {
    TdmsScaling scaling;
    if (scales != nullptr) scaling = tdms_scaling(*scales);
    if (object.sources.empty()) return;
    const Source* source = &object.sources.front();
    if (scaling.problem.empty() && !scaling.what.empty()) {
      const auto found = std::ranges::find(object.sources, scaling.source, &Source::id);
      if (found != object.sources.end())
        source = &*found;
      else if (object.sources.size() > 1)
        scaling.problem = fmt::format("its scales begin with the raw signal {}, which is not there",
                                      scaling.source);
    } else if (scaling.problem.empty() && object.sources.size() > 1) {
      warn(fmt::format("'{}' has {} raw signals and no scale that joins them: the first is read",
                       object.name, object.sources.size()));
    }
    if (scaling.problem.empty() && source->imaginary.size() > 0 && !scaling.what.empty())
      scaling.problem = "its numbers are complex";
    stored.samples = source->numbers;
    stored.imaginary = source->imaginary;
    std::function<void(std::span<double>)> function;
    if (!scaling.problem.empty()) {
      warn(fmt::format("'{}' is read unscaled, without its unit{}: {}", channel.name,
                       channel.unit.empty() ? "" : fmt::format(" '{}'", channel.unit),
                       scaling.problem));
      channel.unit.clear();
    } else if (scaling.function) {
      function = scaling.function;
    } else {
      channel.scale = scaling.scale;
      channel.offset = scaling.offset;
    }
    if (!scaling.what.empty() && scaling.problem.empty())
      channel.attributes["scales"] = scaling.what;
    if (source->bit >= 0) {
      function = [bit = source->bit, next = std::move(function)](std::span<double> x) {
        for (double& value : x)  // integers of 32 bits at most, or exact below 2^53
          value = std::fmod(std::floor(std::ldexp(value, -bit)), 2.0) != 0.0 ? 1.0 : 0.0;
        if (next) next(x);
      };
    }
    stored.scaling = std::move(function);
  }

  TdmsTime time_at(std::uint64_t at, bool big_endian) const {
    ByteCursor in(*file_, big_endian, at);
    return read_time(in);
  }

  /// Time stamps become seconds since the first of them. Of their 128 bits (64 of seconds, 64 of
  /// fraction) 64 in the middle are read: 24 of seconds and 40 of fraction give 1 ns within 97 days
  /// of the first, else 32 and 32 give 0.5 µs within 68 years.
  void set_time_stamps(const Object& object, Channel& channel, StoredChannel& stored) {
    const StoredNumbers& found = object.sources.front().numbers;
    const bool big_endian = found.big_endian();
    const TdmsTime first = time_at(object.first_value, big_endian);
    const TdmsTime last = time_at(object.last_value, big_endian);
    constexpr double days_90 = 90.0 * 86400.0;
    const double span = static_cast<double>(last.seconds) - static_cast<double>(first.seconds);
    const bool fine = std::abs(span) < days_90;
    StoredNumbers numbers(NumberKind::u64, big_endian);
    for (NumberRun run : found.runs()) {
      if (fine) run.offset += big_endian ? 1 : ~std::uint64_t{0};  // a byte less of seconds
      numbers.add(run);
    }
    const double unit = std::ldexp(1.0, fine ? -40 : -32);  // [s]
    const double all = std::ldexp(1.0, fine ? 24 : 32);     // [s], where the bits begin again
    double zero = 0.0;
    read_numbers(*file_, numbers, 0, {&zero, 1});
    stored.samples = numbers;
    stored.scaling = [unit, all, zero](std::span<double> x) {
      for (double& value : x) {
        value = (value - zero) * unit;
        if (value < -0.5 * all) value += all;
        if (value >= 0.5 * all) value -= all;
      }
    };
    channel.unit = "s";
    channel.attributes["first time stamp"] = iso_text(first);
    channel.attributes["counted from"] = "its first time stamp";
  }

  static std::optional<TdmsTime> start_of(const Object& object) {
    const auto stated = object.properties.find("wf_start_time");
    if (stated == object.properties.end()) return std::nullopt;
    const auto* const time = std::get_if<TdmsTime>(&stated->second);
    if (time == nullptr || iso_text(*time).empty()) return std::nullopt;
    return *time;
  }

  /// Uniform clocks from the waveform properties. Channels share a time origin: the earliest start.
  void set_uniform_clocks() {
    const auto before = [](const TdmsTime& a, const TdmsTime& b) {
      return a.seconds != b.seconds ? a.seconds < b.seconds : a.fraction < b.fraction;
    };
    std::optional<TdmsTime> earliest;
    for (const Object* const object : channels_)
      if (const auto start = start_of(*object); start && (!earliest || before(*start, *earliest)))
        earliest = start;
    if (earliest) record_.started = iso_text(*earliest);
    bool different = false;
    for (std::size_t i = 0; i < channels_.size(); ++i) {
      const auto number = [&](const char* name) {
        const double value = number_of(channels_[i]->properties, name).value_or(0.0);
        return std::isfinite(value) ? value : 0.0;
      };
      datasets::SampleClock& clock = record_.channels[i].clock;
      clock.start = number("wf_start_offset");
      clock.interval = std::max(0.0, number("wf_increment"));
      const auto start = start_of(*channels_[i]);
      if (!start) continue;
      const double later = static_cast<double>(start->seconds - earliest->seconds) +
                           std::ldexp(static_cast<double>(start->fraction), -64) -
                           std::ldexp(static_cast<double>(earliest->fraction), -64);
      // writers carry the start along in double precision: what is small against a step is none
      if (std::abs(later) <= 1e-3 * clock.interval) continue;
      different = true;
      clock.start += later;
    }
    if (different) warn("channels start at different times: time 0 is the start of the earliest");
  }

  /// Times from a channel: the one the user states, else the only one of time stamps in a group.
  void set_clocks_by_channels() {
    if (options_.time_column == "none") return;
    if (options_.time_column) {
      const Channel* const stated = record_.find(*options_.time_column);
      if (stated == nullptr)
        fail(0, fmt::format("there is no channel '{}' to take times from", *options_.time_column));
      const auto t = static_cast<std::size_t>(stated - record_.channels.data());
      std::vector<std::size_t> group;
      for (std::size_t i = 0; i < channels_.size(); ++i)
        if (channels_[i]->group == channels_[t]->group) group.push_back(i);
      take_times(t, group, true);
      return;
    }
    std::map<std::string, std::vector<std::size_t>> groups;
    std::map<std::string, std::vector<std::size_t>> stamps;
    for (std::size_t i = 0; i < channels_.size(); ++i) {
      groups[channels_[i]->group].push_back(i);
      if (is_time_stamps(i)) stamps[channels_[i]->group].push_back(i);
    }
    for (const auto& [group, found] : stamps) {
      if (found.size() == 1) {
        take_times(found.front(), groups[group], false);
      } else {
        for (const std::size_t i : found) take_times(i, {i}, false);
      }
    }
  }

  bool is_time_stamps(std::size_t i) const {
    return channels_[i]->type != nullptr && channels_[i]->type->role == Role::time;
  }

  /// Gives the channels of as many values as channel `t` its values as times; `all`: even those
  /// that have a clock.
  void take_times(std::size_t t, const std::vector<std::size_t>& channels, bool all) {
    const std::uint64_t n = stored_[t].samples.size();
    if (n == 0 || stored_[t].imaginary.size() > 0) return;
    const Channel& times = record_.channels[t];
    double factor = 1.0;
    if (times.unit != "s") {
      const auto conversion = datasets::conversion(times.unit, "s");
      if (conversion)
        factor = conversion->factor;
      else
        warn(fmt::format("the times in '{}' are taken as seconds: its unit is '{}'", times.name,
                         times.unit));
    }
    const auto seconds = [scaling = stored_[t].scaling, scale = times.scale * factor,
                          offset = times.offset * factor](std::span<double> x) {
      if (scaling) scaling(x);
      if (scale == 1.0 && offset == 0.0) return;
      for (double& value : x) value = scale * value + offset;
    };
    datasets::SampleClock clock;
    StoredChannel found;
    const std::string warning = set_stored_times(*file_, stored_[t].samples, seconds, clock, found);
    bool used = false;
    for (const std::size_t i : channels) {
      Channel& channel = record_.channels[i];
      if (stored_[i].samples.size() != n || (channel.clock.interval > 0.0 && !all)) continue;
      channel.clock.start = clock.start;
      channel.clock.interval = clock.interval;
      stored_[i].times = found.times;
      stored_[i].times_scaling = found.times_scaling;
      if (i == t) continue;
      channel.attributes["times from"] = times.name;
      used = true;
    }
    if (!warning.empty()) warn(fmt::format("times from '{}': {}", times.name, warning));
    if (used && !all)
      warn(
          fmt::format("channels of '{}' state no sample interval: their times are the time stamps "
                      "in '{}' (--time-column none leaves them out)",
                      channels_[t]->group, times.name));
    if (!used && all)
      warn(
          fmt::format("no other channel of its group has as many values as '{}': it gives no times",
                      times.name));
  }

  void tell_same_names() {
    std::set<std::string> names;
    for (const Channel& channel : record_.channels)
      if (!names.insert(channel.name).second) {
        warn(fmt::format("several groups have a channel '{0}': state the group too, '{1}/{0}'",
                         channel.name, channel.attributes.at("group")));
        return;
      }
  }

  std::unique_ptr<MappedFile> file_;
  const ImportOptions& options_;
  std::uint64_t size_;
  Record record_;
  std::vector<StoredChannel> stored_;
  std::vector<const Object*> channels_;  // of record_

  std::vector<Object> objects_;  // in the order of their first mention
  std::unordered_map<std::string_view, std::size_t> by_path_;  // paths lie in the file
  std::map<std::string, std::size_t> groups_;
  std::size_t properties_ = 0;
  std::uint64_t steps_ = 0;
  std::map<std::string, Quantity> quantities_;

  std::vector<std::size_t> list_;    // objects of the segment at hand, in the order of their data
  bool changed_ = true;              // since arrange():
  std::vector<std::size_t> active_;  // those of list_ that have data
  std::vector<Buffer> buffers_;
  std::uint64_t chunk_bytes_ = 0;
  bool daqmx_ = false;
  bool big_endian_ = false;
};

}  // namespace

int recognises_tdms(std::string_view, std::string_view head) {
  return head.starts_with("TDSm") ? 100 : 0;
}

std::unique_ptr<RecordingReader> open_tdms(const std::string& path, const ImportOptions& options) {
  return TdmsReader(path, options).open();
}

}  // namespace impactrig::acquisition
