// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/header_fields.hpp"
#include "acquisition/importers/number.hpp"
#include "acquisition/importers/stored_numbers.hpp"
#include "acquisition/importers/text_file.hpp"
#include "acquisition/importers/time_axis.hpp"
#include "datasets/units.hpp"

/// imc FAMOS raw files: keys "|XX,version,length,contents;" with the samples within a key of their
/// own, "|CS".
///
/// Source of the layout: imc, "FAMOS file format" (version 2), as RecordEvolution/IMCtermite and
/// Apollo3zehn/ImcFamosFile write it out.
namespace impactrig::acquisition {

using datasets::Channel;
using datasets::InputError;
using datasets::Record;

namespace {

constexpr double seconds_to_1970 = 315532800.0;  ///< 1980-01-01, imc's year 0, since 1970

/// One key, with its contents and where they lie.
struct Key {
  std::string_view name;
  int version = 0;
  std::string_view contents;
  std::uint64_t place = 0;  ///< of '|' [bytes]
  std::uint64_t contents_at = 0;
};

/// Walks along the parameters of a key, which commas separate.
class Parameters {
 public:
  explicit Parameters(std::string_view text) : text_(text) {}

  std::string_view next() {
    const std::size_t comma = std::min(text_.find(',', at_), text_.size());
    const std::string_view found =
        at_ <= text_.size() ? text_.substr(at_, comma - at_) : std::string_view();
    at_ = std::min(comma + 1, text_.size() + 1);
    return trimmed(found);
  }

  /// A length, then a text of that length, which may hold commas. A writer that quotes its texts
  /// counts them without the quotes.
  std::string text() {
    const auto length = integer_in(next());
    if (at_ > text_.size()) return {};
    std::string_view found = text_.substr(at_);
    const bool fits = length && *length >= 0 && static_cast<std::size_t>(*length) <= found.size() &&
                      (static_cast<std::size_t>(*length) == found.size() ||
                       found[static_cast<std::size_t>(*length)] == ',');
    found = found.substr(0, fits ? static_cast<std::size_t>(*length) : found.find(','));
    at_ += found.size() + 1;
    found = trimmed(found);
    if (!fits && found.size() >= 2 && found.front() == '"' && found.back() == '"')
      found = found.substr(1, found.size() - 2);
    return to_utf8(found);
  }

  bool at_end() const { return at_ >= text_.size(); }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
};

/// What the key CD says: x = start + i interval.
struct Abscissa {
  double interval = 0.0;
  double start = 0.0;
  bool stated_start = false;
  std::string unit;
};

/// What a key Cb says of one buffer.
struct Buffer {
  long samples_key = 0;  ///< number of the key CS
  std::uint64_t offset = 0;
  std::uint64_t bytes = 0;
  std::uint64_t first = 0;  ///< first sample in a buffer that is a ring [bytes]
  std::uint64_t filled = 0;
  double start = 0.0;                       ///< x of the first sample
  double add_time = 0.0;                    ///< [s] to the trigger time
  std::optional<std::uint64_t> samples_at;  ///< in the file, once its CS has come
  std::uint64_t samples_bytes = 0;
};

/// A component: one row of numbers.
struct Component {
  std::uint64_t place = 0;
  bool digital = false;
  int bytes = 0;
  int number_format = 0;
  std::uint64_t offset = 0;    ///< of the first number in a buffer [bytes]
  std::uint64_t count = 1;     ///< numbers side by side
  std::uint64_t distance = 0;  ///< bytes between such groups
  double factor = 1.0;
  double shift = 0.0;
  std::string unit;
  std::string name;
  std::string comment;
  std::string group;
  std::vector<Buffer> buffers;
  Abscissa abscissa;
  std::string trigger;  ///< ISO 8601, or ""
};

/// A group of components: one, or an y and its x.
struct Field {
  int type = 1;
  std::vector<Component> components;
};

constexpr std::array<std::string_view, 7> field_types = {
    "",
    "samples at equal distances",
    "samples over their own increasing x",
    "samples over their own x",
    "complex numbers (real and imaginary part)",
    "complex numbers (magnitude and phase)",
    "complex numbers (magnitude in dB and phase)"};

std::optional<NumberKind> kind_of(int format) {
  switch (format) {
    case 1:
      return NumberKind::u8;
    case 2:
      return NumberKind::i8;
    case 3:
      return NumberKind::u16;
    case 4:
      return NumberKind::i16;
    case 5:
      return NumberKind::u32;
    case 6:
      return NumberKind::i32;
    case 7:
      return NumberKind::f32;
    case 8:
      return NumberKind::f64;
    case 12:
      return NumberKind::u64;
    case 14:
      return NumberKind::i64;
    default:
      return std::nullopt;
  }
}

constexpr int six_bytes = 13;

std::string kind_name(int format) {
  if (format == 9) return "imc's transitional recording";
  if (format == 10) return "time stamps as text";
  if (format == 11) return "digital words";
  if (format == six_bytes) return "integers of 6 bytes";
  return fmt::format("numbers of format {}", format);
}

class ImcReader {
 public:
  explicit ImcReader(const std::string& path) : file_(std::make_unique<MappedFile>(path)) {}

  std::unique_ptr<RecordingReader> open() {
    while (const auto key = next_key()) read_key(*key);
    finish_field();
    if (!seen_format_)
      throw InputError(file_->byte_position(0), "expected the key '|CF' of an imc FAMOS file");
    bool over_own_x = false;
    for (const Field& field : fields_) {
      if (field.type == 1) {
        for (const Component& component : field.components) add_component(component);
      } else if (field.type == 2 || field.type == 3) {
        over_own_x = true;
        add_over_own_x(field);
      } else {
        refuse(field.components.front(),
               fmt::format("holds {}",
                           field.type >= 4 && field.type <= 6
                               ? std::string(field_types[static_cast<std::size_t>(field.type)])
                               : fmt::format("data of type {}", field.type)));
      }
    }
    if (record_.channels.empty()) {
      if (!refused_.empty()) throw InputError(file_->byte_position(refused_at_), refused_);
      record_.warnings.push_back("no recordings in this file: it has no channels with samples");
    }
    for (const std::string& sentence : left_out_) record_.warnings.push_back(sentence);
    auto reader = reader_of_numbers(std::move(file_), std::move(record_), std::move(stored_));
    if (!over_own_x) return reader;
    // such channels are small: their times are numbers of any kind, with a scale
    Record whole = read_into_memory(*reader);
    for (auto& [index, axis] : axes_) whole.channels[index].clock = std::move(axis.clock);
    return reader_of(std::move(whole));
  }

 private:
  [[noreturn]] void fail(std::uint64_t place, const std::string& problem) const {
    throw InputError(file_->byte_position(place), problem);
  }

  std::optional<Key> next_key() {
    const std::string_view bytes = file_->bytes();
    while (at_ < bytes.size() && (bytes[at_] == ' ' || bytes[at_] == '\r' || bytes[at_] == '\n' ||
                                  bytes[at_] == '\t' || bytes[at_] == '\0'))
      ++at_;
    if (at_ >= bytes.size()) return std::nullopt;
    Key key;
    key.place = at_;
    if (bytes[at_] != '|')
      fail(at_, fmt::format("expected a key that begins with '|', found '{}'",
                            to_utf8(bytes.substr(at_, 1))));
    // "|CF,2,1,": name, version and length
    const std::string_view start = bytes.substr(at_, 64);
    std::array<std::size_t, 3> commas{};
    std::size_t from = 0;
    for (std::size_t& comma : commas) {
      comma = start.find(',', from);
      if (comma == std::string_view::npos) {
        if (start.size() < 64 && fields_ready()) return cut_key(key);
        fail(at_, "expected '|XX,version,length,' of a key");
      }
      from = comma + 1;
    }
    key.name = start.substr(1, commas[0] - 1);
    const auto version = integer_in(start.substr(commas[0] + 1, commas[1] - commas[0] - 1));
    const auto length = integer_in(start.substr(commas[1] + 1, commas[2] - commas[1] - 1));
    if (key.name.size() != 2 || !version || !length || *length < 0 || *version < 0 ||
        *version > 1000)
      fail(at_, fmt::format("expected a key, its version and its length, found '{}'",
                            to_utf8(start.substr(0, commas[2]))));
    key.version = static_cast<int>(*version);
    key.contents_at = at_ + commas[2] + 1;
    const auto size = static_cast<std::uint64_t>(*length);
    const std::uint64_t there =
        bytes.size() - std::min<std::uint64_t>(bytes.size(), key.contents_at);
    if (size > there && key.name != "CS") {
      if (fields_ready()) return cut_key(key);
      fail(at_, fmt::format("the file ends within the key '{}'", to_utf8(key.name)));
    }
    key.contents = bytes.substr(key.contents_at, std::min(size, there));
    at_ = key.contents_at + key.contents.size();
    if (at_ < bytes.size() && bytes[at_] != ';')
      fail(at_, fmt::format("expected ';' behind the key '{}', found '{}'", to_utf8(key.name),
                            to_utf8(bytes.substr(at_, 1))));
    ++at_;
    return key;
  }

  /// True when there is something to read in front of a key that is cut off.
  bool fields_ready() const { return samples_seen_; }

  std::optional<Key> cut_key(const Key& key) {
    left_out_.push_back(fmt::format(
        "the file ends within the key at byte {}: what follows is left out", key.place));
    return std::nullopt;
  }

  double number(Parameters& parameters, const Key& key, std::string_view what) const {
    const std::string_view text = parameters.next();
    const auto value = number_in(text);
    if (!value || !std::isfinite(*value))
      fail(key.place, fmt::format("{}: expected {}, found '{}'", to_utf8(key.name), what,
                                  to_utf8(text.substr(0, 40))));
    return *value;
  }

  std::uint64_t count(Parameters& parameters, const Key& key, std::string_view what) const {
    const std::string_view text = parameters.next();
    const auto value = integer_in(text);
    if (!value || *value < 0)
      fail(key.place, fmt::format("{}: expected {}, found '{}'", to_utf8(key.name), what,
                                  to_utf8(text.substr(0, 40))));
    return static_cast<std::uint64_t>(*value);
  }

  void read_key(const Key& key) {
    Parameters in(key.contents);
    if (key.name == "CF") {
      read_format(key, in);
    } else if (!seen_format_) {
      fail(key.place, "expected the key '|CF' of an imc FAMOS file");
    } else if (key.name == "CK") {
      in.next();
      if (integer_in(in.next()) != 1)
        record_.warnings.push_back("the file was not closed by the program that wrote it");
    } else if (key.name == "NO") {
      in.next();
      set_attribute(record_, "origin", in.text());
      set_attribute(record_, "origin comment", in.text());
    } else if (key.name == "CB") {
      in.next();
      group_ = in.text();
    } else if (key.name == "CG") {
      finish_field();
      in.next();
      field_ = Field{};
      field_.type = static_cast<int>(std::min<std::uint64_t>(count(in, key, "a type"), 100));
      abscissa_ = {};
    } else if (key.name == "CD") {
      read_abscissa(key, in);
    } else if (key.name == "NT") {
      read_trigger(key, in);
    } else if (key.name == "CC") {
      start_component(key, in);
    } else if (key.name == "CP") {
      read_packing(key, in);
    } else if (key.name == "Cb") {
      read_buffers(key, in);
    } else if (key.name == "CR") {
      read_range(key, in);
    } else if (key.name == "CN") {
      read_name(in);
    } else if (key.name == "CS") {
      read_samples(key, in);
    }
    // other keys (texts, colours, properties, single values) are no part of a recording
  }

  void read_format(const Key& key, Parameters& in) {
    if (key.version != 2)
      fail(key.place, fmt::format("this is an imc FAMOS file of version {}, expected 2: save it "
                                  "anew with FAMOS, or as ASCII",
                                  key.version));
    const std::uint64_t processor = count(in, key, "a processor");
    if (processor != 1 && processor != 2)
      fail(key.place, fmt::format("CF: expected the processor 1 (Intel) or 2 (Motorola), found {}",
                                  processor));
    big_endian_ = processor == 2;
    seen_format_ = true;
    record_.attributes["byte order"] = big_endian_ ? "big-endian" : "little-endian";
  }

  void read_abscissa(const Key& key, Parameters& in) {
    abscissa_ = {};
    abscissa_.interval = number(in, key, "a distance");
    const auto calibrated = integer_in(in.next());
    abscissa_.unit = in.text();
    if (calibrated == 0) abscissa_.unit.clear();
    if (key.version == 2) {
      for (int i = 0; i < 3; ++i) in.next();  // reduction, events, sorting
      abscissa_.start = number(in, key, "an x of the first sample");
      abscissa_.stated_start = true;
    }
    if (component_) component_->abscissa = abscissa_;
  }

  void read_trigger(const Key& key, Parameters& in) {
    std::array<int, 5> parts{};  // day, month, year, hour, minute
    for (int& part : parts)
      part = static_cast<int>(std::min<std::uint64_t>(count(in, key, "a date"), 9999));
    const double second = number(in, key, "a second");
    trigger_ = iso_time(parts[2], parts[1], parts[0], parts[3], parts[4], second);
    if (component_) component_->trigger = trigger_;
  }

  void start_component(const Key& key, Parameters& in) {
    finish_component();
    in.next();  // index
    component_ = Component{};
    component_->place = key.place;
    component_->digital = integer_in(in.next()) == 2;
    component_->group = group_;
    component_->abscissa = abscissa_;
    component_->trigger = trigger_;
  }

  Component& component(const Key& key) {
    if (!component_)
      fail(key.place,
           fmt::format("the key '{}' stands outside of a component ('CC')", to_utf8(key.name)));
    return *component_;
  }

  void read_packing(const Key& key, Parameters& in) {
    Component& one = component(key);
    in.next();  // reference of the buffer
    one.bytes =
        static_cast<int>(std::min<std::uint64_t>(count(in, key, "the bytes of a number"), 1000));
    one.number_format =
        static_cast<int>(std::min<std::uint64_t>(count(in, key, "a format of numbers"), 1000));
    in.next();  // significant bits
    in.next();  // mask
    one.offset = count(in, key, "the place of the first number");
    one.count = count(in, key, "a number of numbers");
    one.distance = count(in, key, "a distance of numbers");
  }

  void read_buffers(const Key& key, Parameters& in) {
    Component& one = component(key);
    const std::uint64_t buffers = count(in, key, "a number of buffers");
    const std::uint64_t user_bytes = count(in, key, "the bytes of user information");
    for (std::uint64_t i = 0; i < buffers; ++i) {
      if (in.at_end())
        fail(key.place, fmt::format("Cb: {} buffers are announced, {} found", buffers, i));
      Buffer buffer;
      in.next();  // its reference
      buffer.samples_key = static_cast<long>(count(in, key, "the number of a key CS"));
      buffer.offset = count(in, key, "the place of a buffer");
      buffer.bytes = count(in, key, "the bytes of a buffer");
      buffer.first = count(in, key, "the place of the first sample");
      buffer.filled = count(in, key, "the filled bytes of a buffer");
      in.next();
      buffer.start = number(in, key, "the x of the first sample");
      buffer.add_time = number(in, key, "a time");
      if (user_bytes > 0 || !in.at_end()) in.next();
      one.buffers.push_back(buffer);
    }
  }

  void read_range(const Key& key, Parameters& in) {
    Component& one = component(key);
    const bool scaled = integer_in(in.next()) == 1;
    const double factor = number(in, key, "a factor");
    const double shift = number(in, key, "an offset");
    if (scaled) {
      one.factor = factor;
      one.shift = shift;
    }
    const auto calibrated = integer_in(in.next());
    const std::string unit = in.text();
    if (calibrated != 0) one.unit = unit;
  }

  void read_name(Parameters& in) {
    if (!component_) return;  // of a text or a single value
    in.next();                // group
    in.next();
    in.next();  // bit
    component_->name = in.text();
    component_->comment = in.text();
  }

  /// "|CS,1,length,number,samples;": buffers that waited for this number now know their place.
  void read_samples(const Key& key, Parameters& in) {
    finish_field();
    const std::size_t comma = key.contents.find(',');
    const auto index = integer_in(in.next());
    if (comma == std::string_view::npos || !index)
      fail(key.place, "CS: expected the number of the key, then samples");
    for (const auto& [field, component, number] : waiting_[*index]) {
      Buffer& buffer = fields_[field].components[component].buffers[number];
      buffer.samples_at = key.contents_at + comma + 1;
      buffer.samples_bytes = key.contents.size() - comma - 1;
    }
    waiting_.erase(*index);
    samples_seen_ = true;
  }

  void finish_component() {
    if (!component_) return;
    field_.components.push_back(std::move(*component_));
    component_.reset();
  }

  void finish_field() {
    finish_component();
    if (!field_.components.empty()) {
      for (std::size_t c = 0; c < field_.components.size(); ++c)
        for (std::size_t b = 0; b < field_.components[c].buffers.size(); ++b)
          waiting_[field_.components[c].buffers[b].samples_key].push_back({fields_.size(), c, b});
      fields_.push_back(std::move(field_));
    }
    field_ = Field{};
  }

  static std::string name_of(const Component& one, std::size_t number) {
    return one.name.empty() ? fmt::format("channel {}", number + 1) : one.name;
  }

  void refuse(const Component& one, const std::string& what) {
    const std::string sentence =
        fmt::format("'{}' {}, which is not read", name_of(one, record_.channels.size()), what);
    left_out_.push_back(sentence);
    if (refused_.empty()) {
      refused_ = sentence + ": export it from FAMOS as ASCII";
      refused_at_ = one.place;
    }
  }

  /// Where the numbers of a buffer lie. Empty when its samples are not in the file.
  StoredNumbers numbers_of(const Component& one, const Buffer& buffer, NumberKind kind,
                           std::uint64_t width, std::uint64_t within, const std::string& name) {
    StoredNumbers numbers(kind, big_endian_);
    const std::uint64_t filled = std::min(buffer.filled, buffer.bytes);
    const std::uint64_t stride = width * one.count + one.distance;
    if (!buffer.samples_at) return numbers;
    const std::uint64_t available =
        buffer.samples_bytes - std::min(buffer.samples_bytes, buffer.offset);
    const auto add = [&](std::uint64_t from, std::uint64_t bytes) {
      // whole numbers of [from, from + bytes) of the buffer
      const std::uint64_t there = std::min(bytes, available - std::min(available, from));
      const std::uint64_t skipped = one.offset + within;
      if (there < skipped + size_of(kind)) return;
      const std::uint64_t count = (there - skipped - size_of(kind)) / stride + 1;
      numbers.add({*buffer.samples_at + buffer.offset + from + skipped, count, stride});
    };
    // a ring begins anywhere
    if (buffer.first < buffer.bytes && filled > buffer.bytes - buffer.first) {
      add(buffer.first, buffer.bytes - buffer.first);
      add(0, filled - (buffer.bytes - buffer.first));
    } else {
      add(buffer.first, filled);
    }
    const std::uint64_t announced =
        filled < one.offset + width ? 0 : (filled - one.offset - width) / stride + 1;
    if (within == 0 && numbers.size() < announced)
      record_.warnings.push_back(cut_off(name, numbers.size(), announced));
    return numbers;
  }

  /// A component whose numbers can be read, else none (and a sentence).
  bool readable(const Component& one, bool six_bytes_too = false) {
    if (one.digital) {
      refuse(one, "is digital");
      return false;
    }
    const auto kind = kind_of(one.number_format);
    if (!kind && !(six_bytes_too && one.number_format == six_bytes)) {
      refuse(one, fmt::format("holds {}", kind_name(one.number_format)));
      return false;
    }
    const int width = kind ? static_cast<int>(size_of(*kind)) : 6;
    if (one.bytes != width)
      fail(one.place,
           fmt::format("'{}': numbers of format {} have {} bytes, the key CP states {}",
                       name_of(one, record_.channels.size()), one.number_format, width, one.bytes));
    if (one.count != 1) {
      refuse(one, fmt::format("is stored in groups of {} numbers", one.count));
      return false;
    }
    if (one.distance > (std::uint64_t{1} << 31) || one.offset > (std::uint64_t{1} << 31))
      fail(one.place, fmt::format("'{}': its numbers are said to lie {} bytes apart, the first at "
                                  "{}",
                                  name_of(one, record_.channels.size()), one.distance, one.offset));
    return true;
  }

  Channel channel_of(const Component& one, const Buffer& buffer) {
    Channel channel;
    channel.name = name_of(one, record_.channels.size());
    set_unit(channel, one.unit);
    set_scale(channel, one.factor, one.shift, *file_, one.place);
    set_attribute(channel, "comment", one.comment);
    set_attribute(channel, "group", one.group);
    std::string trigger = one.trigger;
    if (trigger == "1980-01-01T00:00:00" && buffer.add_time > 0.0) {
      // devices write the seconds since 1980, in their own time zone
      trigger = iso_time_utc(seconds_to_1970 + buffer.add_time);
      if (!trigger.empty()) trigger.pop_back();
    } else if (buffer.add_time != 0.0) {
      channel.attributes["add time"] = fmt::format("{} s", buffer.add_time);
    }
    set_attribute(channel, "trigger time", trigger);
    if (record_.started.empty()) record_.started = trigger;
    return channel;
  }

  void limit_channels(const Component& one) const {
    if (record_.channels.size() >= most_channels)
      fail(one.place, fmt::format("the file has more than {} channels or events: save it in parts",
                                  most_channels));
  }

  void add_component(const Component& one) {
    if (!readable(one)) return;
    const NumberKind kind = *kind_of(one.number_format);
    if (one.buffers.empty()) {
      refuse(one, "has no buffer of samples ('Cb')");
      return;
    }
    for (std::size_t b = 0; b < one.buffers.size(); ++b) {
      const Buffer& buffer = one.buffers[b];
      limit_channels(one);
      Channel channel = channel_of(one, buffer);
      if (one.buffers.size() > 1) channel.name += fmt::format(", event {}", b + 1);
      const StoredNumbers numbers = numbers_of(one, buffer, kind, size_of(kind), 0, channel.name);
      if (!buffer.samples_at) {
        refuse(one, "has no samples in the file ('CS')");
        continue;
      }
      const double start =
          buffer.start != 0.0 || !one.abscissa.stated_start ? buffer.start : one.abscissa.start;
      set_axis(channel, start, one.abscissa.interval, one.abscissa.unit);
      stored_.push_back({numbers});
      record_.channels.push_back(std::move(channel));
    }
  }

  /// All numbers of a component, as the file means them.
  std::vector<double> values_of(const Component& one) {
    Record record;
    std::vector<StoredChannel> parts;
    const Buffer& buffer = one.buffers.front();
    const bool split = one.number_format == six_bytes;
    const NumberKind kind = split ? NumberKind::u32 : *kind_of(one.number_format);
    const std::uint64_t low = split && big_endian_ ? 2 : 0;
    parts.push_back({numbers_of(one, buffer, kind, split ? 6 : size_of(kind), low, one.name)});
    if (split)
      parts.push_back({numbers_of(one, buffer, NumberKind::u16, 6, big_endian_ ? 0 : 4, one.name)});
    record.channels.resize(parts.size());
    const auto reader = reader_of_numbers(std::make_unique<MappedFile>(file_->path()),
                                          std::move(record), std::move(parts));
    const Record read = read_into_memory(*reader);
    std::vector<double> values = read.channels.front().values();
    if (split) {
      const std::vector<double> high = read.channels.back().values();
      values.resize(std::min(values.size(), high.size()));
      for (std::size_t i = 0; i < values.size(); ++i) values[i] += 0x1p32 * high[i];
    }
    for (double& value : values) value = one.factor * value + one.shift;
    return values;
  }

  void add_over_own_x(const Field& field) {
    const Component& one = field.components.front();
    if (field.components.size() != 2 || one.buffers.size() != 1 ||
        field.components[1].buffers.size() != 1 || !one.buffers.front().samples_at ||
        !field.components[1].buffers.front().samples_at) {
      refuse(one, fmt::format("is an x-y data set of {} components in several buffers",
                              field.components.size()));
      return;
    }
    const Component& x = field.components[1];
    if (!readable(one) || !readable(x, true)) return;
    limit_channels(one);
    Channel channel = channel_of(one, one.buffers.front());
    const NumberKind kind = *kind_of(one.number_format);
    StoredNumbers numbers =
        numbers_of(one, one.buffers.front(), kind, size_of(kind), 0, channel.name);
    std::vector<double> times = values_of(x);
    if (times.size() != numbers.size()) {
      refuse(one, fmt::format("has {} samples and {} x", numbers.size(), times.size()));
      return;
    }
    const auto seconds = datasets::conversion(x.unit, "s");
    if (!x.unit.empty() && !seconds) {
      refuse(one, fmt::format("is over '{}', which is no time", x.unit));
      return;
    }
    if (seconds && seconds->factor != 1.0)
      for (double& time : times) time *= seconds->factor;
    channel.attributes["domain"] = "time";
    if (std::any_of(times.begin(), times.end(), [](double time) { return !std::isfinite(time); })) {
      refuse(one, "has times that are not finite");
      return;
    }
    TimeAxis axis = time_axis(std::move(times));
    if (!axis.warning.empty())
      record_.warnings.push_back(fmt::format("'{}': {}", channel.name, axis.warning));
    axes_.emplace_back(record_.channels.size(), std::move(axis));
    stored_.push_back({std::move(numbers)});
    record_.channels.push_back(std::move(channel));
  }

  std::unique_ptr<MappedFile> file_;
  std::uint64_t at_ = 0;
  bool seen_format_ = false;
  bool samples_seen_ = false;
  bool big_endian_ = false;
  /// Buffers by the number of the key CS that has not come yet: field, component, buffer.
  std::map<long, std::vector<std::array<std::size_t, 3>>> waiting_;
  std::string group_;
  std::string trigger_;
  Abscissa abscissa_;
  Field field_;
  std::optional<Component> component_;
  std::vector<Field> fields_;
  std::vector<std::string> left_out_;
  std::string refused_;
  std::uint64_t refused_at_ = 0;
  Record record_;
  std::vector<StoredChannel> stored_;
  std::vector<std::pair<std::size_t, TimeAxis>> axes_;
};

}  // namespace

int recognises_imc_raw(std::string_view, std::string_view head) {
  return head.starts_with("|CF,") ? 100 : 0;
}

std::unique_ptr<RecordingReader> open_imc_raw(const std::string& path, const ImportOptions&) {
  return ImcReader(path).open();
}

}  // namespace impactrig::acquisition
