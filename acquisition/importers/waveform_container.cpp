// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/waveform_container.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>

#include "acquisition/importers/byte_cursor.hpp"
#include "acquisition/importers/header_fields.hpp"
#include "acquisition/importers/number.hpp"
#include "acquisition/importers/start_times.hpp"
#include "acquisition/importers/stored_numbers.hpp"
#include "acquisition/importers/text_file.hpp"
#include "acquisition/importers/time_axis.hpp"

/// A file header, then waveforms, each with a header and buffers, each of these with a header and
/// samples. Little-endian throughout.
///
/// Source of the layout: Agilent InfiniiVision 6000 Series User's Guide, "Binary Data (.bin)
/// Format"; Rigol MSO8000 Series User Guide, "Binary Data Format (.bin)" (headers of 128 bytes);
/// Rigol DHO1000 Series User Guide, tables 19.1 to 19.4 (version 03: sizes of 8 bytes).
namespace impactrig::acquisition {

using datasets::Channel;
using datasets::InputError;
using datasets::Record;

namespace {

constexpr std::array<std::string_view, 7> units = {"", "V", "s", "1", "A", "dB", "Hz"};

constexpr std::array<std::string_view, 7> waveform_types = {
    "unknown", "normal", "peak detect", "average", "horizontal histogram", "vertical histogram",
    "logic"};

/// What a buffer's type adds to the channel's name.
constexpr std::array<std::string_view, 7> buffer_names = {"",      "",        " max",    " min",
                                                          " time", " counts", " digital"};

std::string_view unit_of(std::uint32_t code) {
  return code < units.size() ? units[code] : std::string_view();
}

/// "2020-11-22", "2025-8-26" or "22 NOV 2020", and "19:02:34".
std::string started(std::string date, const std::string& time) {
  int year = 0;
  int month = 0;
  int day = 0;
  int hour = 0;
  int minute = 0;
  int second = 0;
  const bool clear = std::sscanf(time.c_str(), "%2d:%2d:%2d", &hour, &minute, &second) == 3;
  if (std::sscanf(date.c_str(), "%4d-%2d-%2d", &year, &month, &day) == 3) {
    const std::string iso = iso_time(year, month, day, hour, minute, second);
    if (!iso.empty()) return clear ? iso : iso.substr(0, 10);
  }
  std::replace(date.begin(), date.end(), ' ', '-');
  return iso_date(clear ? date + " " + time : date);
}

class ContainerReader {
 public:
  ContainerReader(std::unique_ptr<MappedFile> file, const WaveformContainer& format)
      : format_(format),
        file_(std::move(file)),
        in_(*file_) {}

  std::unique_ptr<RecordingReader> open() {
    const std::string version = fixed_text(in_.bytes(4, "the cookie").substr(2));
    wide_ = version == "03";
    if (!wide_ && version != "01" && version != "10")
      throw InputError(
          file_->byte_position(2),
          fmt::format("this is a {} waveform of version '{}', expected 01, 03 or 10: save it as "
                      "CSV on the oscilloscope",
                      format_.maker, version));
    record_.attributes["version"] = fmt::format("{}{}", format_.cookie, version);
    stated_size_ = read_size("the size of the file");
    const auto waveforms = in_.read<std::uint32_t>("the number of waveforms");
    for (std::uint32_t number = 1; number <= waveforms && !cut_; ++number) {
      const std::uint64_t start = in_.at();
      try {
        read_waveform(number);
      } catch (const InputError&) {
        // a header that is cut off behind whole waveforms; one that is wrong is told as it is
        if (record_.channels.empty() || !header_cut_) throw;
        record_.warnings.push_back(
            fmt::format("the file ends within the header of waveform {} of {} at byte {}", number,
                        waveforms, start));
        break;
      }
    }
    if (record_.channels.empty())
      record_.warnings.push_back("no recordings in this file: it has no waveforms");
    if (unnamed_)
      record_.warnings.push_back(
          "the waveforms have no names: they are numbered in their order, which need not be the "
          "oscilloscope's");
    starts_.tell(record_);
    name_segments();
    return reader_of_numbers(std::move(file_), std::move(record_), std::move(stored_));
  }

 private:
  /// Segments are waveforms of the same name, each with the time from its own trigger.
  void name_segments() {
    std::map<std::string, int> names;
    for (const Channel& channel : record_.channels) ++names[channel.name];
    bool told = false;
    for (Channel& channel : record_.channels) {
      const auto segment = channel.attributes.find("segment");
      if (names[channel.name] < 2 || segment == channel.attributes.end()) continue;
      if (!told)
        record_.warnings.push_back(
            fmt::format("'{}' comes in {} segments: each is a channel, with the time from its own "
                        "trigger",
                        channel.name, names[channel.name]));
      told = true;
      channel.name += ", segment " + segment->second;
    }
  }

  std::uint64_t read_size(std::string_view what) {
    return wide_ ? in_.read<std::uint64_t>(what) : in_.read<std::uint32_t>(what);
  }

  /// The header of a waveform, as it stands in the file.
  struct Header {
    std::uint32_t size = 0;  ///< [bytes]
    std::uint32_t type = 0;
    std::uint32_t buffers = 0;
    std::uint32_t points = 0;
    std::uint32_t count = 0;  ///< hits
    double interval = 0.0;
    double origin = 0.0;
    std::uint32_t x_unit = 0;
    std::uint32_t y_unit = 0;
    std::string date;
    std::string time;
    std::string frame;
    std::string label;
    double time_tag = 0.0;  ///< [s]
    std::uint32_t segment = 0;
  };

  void read_waveform(std::uint32_t number) {
    const Header header = read_header(number);
    const Channel channel = channel_of(header, number);
    const std::string start = started(header.date, header.time);
    if (record_.started.empty()) record_.started = start;
    if (header.segment < 2) starts_.add(start);
    set_attribute(record_, "instrument", header.frame);
    for (std::uint32_t b = 0; b < header.buffers && !cut_; ++b) {
      header_cut_ = true;
      read_buffer(channel, header.points);
    }
  }

  /// Leaves the cursor behind the header.
  Header read_header(std::uint32_t number) {
    const std::string_view what = "a waveform's header";
    header_cut_ = true;
    const std::uint64_t start = in_.at();
    Header header;
    header.size = in_.read<std::uint32_t>(what);
    constexpr std::uint32_t shortest = 128;  // without time tag and segment index
    if (header.size < shortest) {
      header_cut_ = false;
      throw InputError(file_->byte_position(start),
                       fmt::format("the header of waveform {} is said to have {} bytes, expected "
                                   "{} or more",
                                   number, header.size, shortest));
    }
    header.type = in_.read<std::uint32_t>(what);
    header.buffers = in_.read<std::uint32_t>(what);
    header.points = in_.read<std::uint32_t>(what);
    header.count = in_.read<std::uint32_t>(what);
    in_.skip(4 + 8);  // what the screen showed
    header.interval = meant_by_float(in_.read<double>(what));
    header.origin = meant_by_float(in_.read<double>(what));
    header.x_unit = in_.read<std::uint32_t>(what);
    header.y_unit = in_.read<std::uint32_t>(what);
    header.date = fixed_text(in_.bytes(16, what));
    header.time = fixed_text(in_.bytes(16, what));
    header.frame = fixed_text(in_.bytes(24, what));
    header.label = fixed_text(in_.bytes(16, what));
    if (header.size >= 140) {
      header.time_tag = in_.read<double>(what);
      header.segment = in_.read<std::uint32_t>(what);
    }
    in_.seek(start);
    in_.bytes(header.size, what);
    refuse_several_files(header, start);
    return header;
  }

  /// An export of several files begins like a waveform; its stated size gives it away.
  void refuse_several_files(const Header& header, std::uint64_t start) {
    if (format_.cookie != "RG" || header.size != 144 || stated_size_ == file_->bytes().size())
      return;
    header_cut_ = false;
    throw InputError(
        file_->byte_position(start),
        fmt::format("this export ({}) is several files in one, whose samples are bytes "
                    "without their scale, and is not read: save it anew, or as CSV",
                    header.frame.substr(0, header.frame.find(':'))));
  }

  /// The channel of a waveform, without its samples.
  Channel channel_of(const Header& header, std::uint32_t number) {
    Channel channel;
    channel.name = header.label.empty() ? fmt::format("CH {}", number) : input_name(header.label);
    if (header.label.empty()) unnamed_ = true;
    if (header.segment > 0) channel.attributes["segment"] = fmt::format("{}", header.segment);
    set_attribute(channel, "label", header.label);
    set_attribute(channel, "waveform type",
                  header.type < waveform_types.size() ? waveform_types[header.type] : "unknown");
    if (header.count > 1) channel.attributes["hits"] = fmt::format("{}", header.count);
    if (header.time_tag != 0.0)
      channel.attributes["time tag"] = fmt::format("{} s", header.time_tag);
    set_unit(channel, unit_of(header.y_unit));
    set_axis(channel, format_.origin_before_trigger ? 0.0 - header.origin : header.origin,
             header.interval, unit_of(header.x_unit));
    return channel;
  }

  void read_buffer(Channel channel, std::uint64_t points) {
    const std::string_view what = "a buffer's header";
    const std::uint64_t start = in_.at();
    const auto header_size = in_.read<std::uint32_t>(what);
    const auto type = in_.read<std::uint16_t>(what);
    const auto width = in_.read<std::uint16_t>(what);
    const std::uint64_t bytes = read_size(what);
    const std::uint64_t shortest = in_.at() - start;
    header_cut_ = false;
    if (header_size < shortest)
      throw InputError(file_->byte_position(start),
                       fmt::format("'{}': the header of its buffer is said to have {} bytes, "
                                   "expected {} or more",
                                   channel.name, header_size, shortest));
    if (width != 1 && width != 4)
      throw InputError(file_->byte_position(start + 6),
                       fmt::format("'{}': a buffer of {} bytes a point is not read, expected 4 "
                                   "(single precision) or 1 (digital)",
                                   channel.name, width));
    if (record_.channels.size() >= most_channels)
      throw InputError(
          file_->byte_position(start),
          fmt::format("the file has more than {} waveforms: save it in parts", most_channels));
    channel.name += type < buffer_names.size() && width == 4 ? buffer_names[type]
                    : width == 1                             ? " digital"
                                                             : "";
    if (type == 4) set_unit(channel, "s");
    if (type == 5 || width == 1) set_unit(channel, "");
    const NumberKind kind = width == 4 ? NumberKind::f32 : NumberKind::u8;
    const std::uint64_t announced = bytes / width;
    if (announced != points)
      record_.warnings.push_back(fmt::format("'{}': {} points are announced, its buffer has {}",
                                             channel.name, points, announced));
    const std::uint64_t offset = start + header_size;
    const StoredNumbers numbers =
        numbers_at(*file_, offset, announced, kind, false, channel.name, record_);
    cut_ = numbers.size() < announced;
    if (announced > 0 && numbers.size() == 0 && record_.channels.empty())
      throw InputError(file_->byte_position(file_->bytes().size()),
                       "the file ends before its first sample");
    stored_.push_back({numbers});
    record_.channels.push_back(std::move(channel));
    in_.seek(offset);
    in_.skip(bytes);
  }

  WaveformContainer format_;
  std::unique_ptr<MappedFile> file_;
  ByteCursor in_;
  bool wide_ = false;
  bool cut_ = false;
  bool header_cut_ = false;
  bool unnamed_ = false;
  std::uint64_t stated_size_ = 0;
  Record record_;
  std::vector<StoredChannel> stored_;
  StartTimes starts_;
};

}  // namespace

std::unique_ptr<RecordingReader> open_waveform_container(std::unique_ptr<MappedFile> file,
                                                         const WaveformContainer& format) {
  return ContainerReader(std::move(file), format).open();
}

}  // namespace impactrig::acquisition
