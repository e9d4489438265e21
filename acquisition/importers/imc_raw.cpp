// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/header_fields.hpp"
#include "acquisition/importers/imc_fields.hpp"
#include "acquisition/importers/stored_numbers.hpp"
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
    contents_ = read_imc_fields(*file_, record_);
    bool over_own_x = false;
    for (const ImcField& field : contents_.fields) {
      if (field.type == 1) {
        for (const ImcComponent& component : field.components) add_component(component);
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
    for (const std::string& sentence : contents_.left_out) record_.warnings.push_back(sentence);
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

  static std::string name_of(const ImcComponent& one, std::size_t number) {
    return one.name.empty() ? fmt::format("channel {}", number + 1) : one.name;
  }

  void refuse(const ImcComponent& one, const std::string& what) {
    const std::string sentence =
        fmt::format("'{}' {}, which is not read", name_of(one, record_.channels.size()), what);
    contents_.left_out.push_back(sentence);
    if (refused_.empty()) {
      refused_ = sentence + ": export it from FAMOS as ASCII";
      refused_at_ = one.place;
    }
  }

  /// Where the numbers of a buffer lie. Empty when its samples are not in the file.
  StoredNumbers numbers_of(const ImcComponent& one, const ImcBuffer& buffer, NumberKind kind,
                           std::uint64_t width, std::uint64_t within, const std::string& name) {
    StoredNumbers numbers(kind, contents_.big_endian);
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
  bool readable(const ImcComponent& one, bool six_bytes_too = false) {
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

  Channel channel_of(const ImcComponent& one, const ImcBuffer& buffer) {
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

  void limit_channels(const ImcComponent& one) const {
    if (record_.channels.size() >= most_channels)
      fail(one.place, fmt::format("the file has more than {} channels or events: save it in parts",
                                  most_channels));
  }

  void add_component(const ImcComponent& one) {
    if (!readable(one)) return;
    const NumberKind kind = *kind_of(one.number_format);
    if (one.buffers.empty()) {
      refuse(one, "has no buffer of samples ('Cb')");
      return;
    }
    for (std::size_t b = 0; b < one.buffers.size(); ++b) {
      const ImcBuffer& buffer = one.buffers[b];
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
  std::vector<double> values_of(const ImcComponent& one) {
    Record record;
    std::vector<StoredChannel> parts;
    const ImcBuffer& buffer = one.buffers.front();
    const bool split = one.number_format == six_bytes;
    const NumberKind kind = split ? NumberKind::u32 : *kind_of(one.number_format);
    const std::uint64_t low = split && contents_.big_endian ? 2 : 0;
    parts.push_back({numbers_of(one, buffer, kind, split ? 6 : size_of(kind), low, one.name)});
    if (split)
      parts.push_back(
          {numbers_of(one, buffer, NumberKind::u16, 6, contents_.big_endian ? 0 : 4, one.name)});
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

  void add_over_own_x(const ImcField& field) {
    const ImcComponent& one = field.components.front();
    if (field.components.size() != 2 || one.buffers.size() != 1 ||
        field.components[1].buffers.size() != 1 || !one.buffers.front().samples_at ||
        !field.components[1].buffers.front().samples_at) {
      refuse(one, fmt::format("is an x-y data set of {} components in several buffers",
                              field.components.size()));
      return;
    }
    const ImcComponent& x = field.components[1];
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
  ImcContents contents_;
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
