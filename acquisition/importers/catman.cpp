// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>
#include <span>

#include "acquisition/importers/byte_cursor.hpp"
#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/header_fields.hpp"
#include "acquisition/importers/marked_numbers.hpp"
#include "acquisition/importers/number.hpp"
#include "acquisition/importers/stored_numbers.hpp"
#include "acquisition/importers/text_file.hpp"
#include "acquisition/importers/time_axis.hpp"
#include "datasets/units.hpp"

/// HBM catman binary export: a global section, a header a channel, then the channels' samples one
/// behind the other. Little-endian throughout.
///
/// Source of the layout: HBM, "catman binary file format" (catmanBinaryFormat.xls, as it is
/// distributed with leonbohmann/APReader).
namespace impactrig::acquisition {

using datasets::Channel;
using datasets::InputError;
using datasets::Record;

namespace {

/// The versions with the header described; older ones lack parts of it.
constexpr int first_id = 5010;
constexpr int id_of_reserved_texts = 5011, id_of_sensors = 5012;  ///< the first with them
constexpr int last_id = 5020;

/// catman's value for an overflow, a broken wire, an input without a sensor.
constexpr double overflow = -1000000.0;

constexpr double days_to_1970 = 25569.0;  ///< the NOW format counts days from 1899-12-30

/// A channel's header.
struct CatmanChannel {
  Channel channel;
  std::uint64_t length = 0;
  double stated = 0.0;    ///< the interval as it is written [ms]
  double interval = 0.0;  ///< [s], 0 not stated
  int precision = 8;      ///< bytes a number
  int format = 0;         ///< 0 and 4 numeric
  int data_width = 8;     ///< of a string [bytes]
  bool time = false;
};

/// Samples that are the overflow value.
struct OverflowRule {
  std::vector<std::pair<double, double>> scales;  ///< and offsets, of the channels

  bool is_none(std::size_t channel, double stored) const {
    const auto& [scale, offset] = scales[channel];
    return scale * stored + offset == overflow;
  }

  std::string warning(const std::string& name, std::uint64_t found, std::uint64_t samples) const {
    return fmt::format(
        "'{}': {} of {} samples are -1000000, catman's mark of an overflow or an open input; "
        "marked "
        "as not valid",
        name, found, samples);
  }
};

bool names_time(std::string_view name) {
  std::string start(name.substr(0, 5));
  for (char& c : start) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return start.starts_with("time") || start.starts_with("zeit") || start.starts_with("temps");
}

class CatmanReader {
 public:
  explicit CatmanReader(std::unique_ptr<MappedFile> file) : file_(std::move(file)), in_(*file_) {}

  std::unique_ptr<RecordingReader> open() {
    read_global();
    for (int i = 0; i < n_channels_; ++i) headers_.push_back(read_channel_header());
    if (in_.at() > data_offset_)
      throw InputError(file_->byte_position(2),
                       fmt::format("the samples are said to begin at byte {}, within the header of "
                                   "{} bytes",
                                   data_offset_, in_.at()));
    std::uint64_t at = data_offset_;
    for (const CatmanChannel& header : headers_) at = place(header, at);
    set_clocks();
    OverflowRule rule;
    for (const Channel& channel : record_.channels)
      rule.scales.emplace_back(channel.scale, channel.offset);
    return std::make_unique<MarkedNumbers<OverflowRule>>(
        reader_of_numbers(std::move(file_), std::move(record_), std::move(stored_)),
        std::move(rule));
  }

 private:
  /// A text with its length before it.
  template <typename Length>
  std::string text(std::string_view what) {
    const std::uint64_t place = in_.at();
    const auto length = in_.read<Length>(what);
    if (length < 0)
      throw InputError(file_->byte_position(place),
                       fmt::format("the length of {} is {}, expected 0 or more", what, length));
    return std::string(in_.bytes(static_cast<std::uint64_t>(length), what));
  }

  void read_global() {
    const auto id = id_ = in_.read<std::int16_t>("the file ID");
    if (id < first_id || id > last_id)
      throw InputError(file_->byte_position(0),
                       fmt::format("the file ID is {}, expected {} to {}: export it from catman "
                                   "anew, or as ASCII",
                                   id, first_id, last_id));
    record_.attributes["file ID"] = fmt::format("{}", id);
    const auto offset = in_.read<std::int32_t>("the place of the samples");
    if (offset < 0)
      throw InputError(file_->byte_position(2),
                       fmt::format("the samples are said to begin at byte {}", offset));
    data_offset_ = static_cast<std::uint64_t>(offset);
    record_.title = to_utf8(trimmed(text<std::int16_t>("the file's comment")));
    for (int i = 0; id >= id_of_reserved_texts && i < 32; ++i)
      text<std::int16_t>("a reserved text");
    const std::uint64_t place = in_.at();
    n_channels_ = in_.read<std::int16_t>("the number of channels");
    if (n_channels_ < 0)
      throw InputError(file_->byte_position(place),
                       fmt::format("the number of channels is {}", n_channels_));
    if (static_cast<std::uint64_t>(n_channels_) > most_channels)
      throw InputError(file_->byte_position(place),
                       fmt::format("the file has {} channels, at most {} are read: export it in "
                                   "parts",
                                   n_channels_, most_channels));
    const auto longest = in_.read<std::int32_t>("the maximum channel length");
    if (longest != 0)
      record_.warnings.push_back(fmt::format(
          "the file states a maximum channel length of {} samples, most state 0: channels may have "
          "been cut at that length",
          longest));
    in_.bytes(4 * static_cast<std::uint64_t>(n_channels_), "the places of the channels' lengths");
    const auto reduction = in_.read<std::int32_t>("the reduction factor");
    if (reduction != 0)
      record_.warnings.push_back(fmt::format(
          "the file states a reduction factor of {}, most state 0: its samples may be one of {} "
          "recorded, or what was made of so many, and impacts between them be lost",
          reduction, reduction));
  }

  CatmanChannel read_channel_header() {
    const std::string_view what = "a channel's header";
    CatmanChannel header;
    in_.bytes(2, what);  // place in catman's data base
    const std::uint64_t place = in_.at();
    const auto length = in_.read<std::int32_t>(what);
    Channel& channel = header.channel;
    channel.name = to_utf8(trimmed(text<std::int16_t>("a channel's name")));
    if (channel.name.empty()) channel.name = fmt::format("channel {}", headers_.size() + 1);
    if (length < 0)
      throw InputError(file_->byte_position(place),
                       fmt::format("'{}' is said to have {} samples", channel.name, length));
    header.length = static_cast<std::uint64_t>(length);
    set_unit(channel, to_utf8(trimmed(text<std::int16_t>("a channel's unit"))));
    set_attribute(channel, "comment", to_utf8(trimmed(text<std::int16_t>("a channel's comment"))));
    header.format = in_.read<std::int16_t>(what);
    header.data_width = in_.read<std::int16_t>(what);
    const auto date = in_.read<double>(what);
    if (record_.started.empty()) {
      // days in double precision are known to a microsecond: no more than milliseconds of them
      record_.started = iso_time_utc(std::round((date - days_to_1970) * 86400.0 * 1e3) / 1e3);
      if (!record_.started.empty()) record_.started.pop_back();  // of the computer's own clock
    }
    read_extended_header(header);
    in_.skip(2);  // kinds of linearisation and scaling
    const auto points = in_.read<std::uint8_t>(what);
    in_.bytes(8 * std::uint64_t{points}, "a channel's scaling");
    in_.bytes(2, what);  // thermocouple
    set_attribute(channel, "formula", to_utf8(trimmed(text<std::int16_t>("a channel's formula"))));
    const std::string sensor =
        id_ >= id_of_sensors ? text<std::int32_t>("a channel's sensor") : std::string();
    if (sensor.size() >= 52)
      set_attribute(channel, "sensor", fixed_text(std::string_view(sensor).substr(2, 50)));
    header.time = names_time(channel.name) &&
                  datasets::quantity_of_unit(channel.unit) == datasets::Quantity::time;
    return header;
  }

  /// VB_DB_CHANHEADER; its numbers are not always filled.
  void read_extended_header(CatmanChannel& header) {
    const auto size = in_.read<std::int32_t>("the length of a channel's extended header");
    if (size < 141)
      throw InputError(file_->byte_position(in_.at() - 4),
                       fmt::format("'{}': the extended header has {} bytes, expected 141 or more",
                                   header.channel.name, size));
    const std::uint64_t start = in_.at();
    in_.bytes(static_cast<std::uint64_t>(size), "a channel's extended header");
    const std::uint64_t end = in_.at();
    in_.seek(start + 8);
    const auto interval = in_.read<double>("the sample interval");  // [ms]
    if (interval > 1e-9 && interval < 1e9) {
      header.stated = interval;
      header.interval = meant_by_float(interval) * 1e-3;
    }
    in_.seek(start + 52);
    set_attribute(header.channel, "amplifier",
                  fixed_text(in_.bytes(32, "an amplifier's serial number")));
    in_.seek(start + 140);
    const auto precision = in_.read<std::uint8_t>("the precision");
    constexpr std::array<int, 3> bytes = {8, 4, 2};
    if (precision >= bytes.size())
      throw InputError(
          file_->byte_position(start + 140),
          fmt::format("'{}': the precision is {}, expected 0 (8 bytes), 1 (4 bytes) or 2 (2 bytes)",
                      header.channel.name, precision));
    header.precision = bytes[precision];
    in_.seek(end);
  }

  /// Describes a channel's samples and returns where the next channel's begin.
  std::uint64_t place(const CatmanChannel& header, std::uint64_t at) {
    if (header.format != 0 && header.format != 4) {
      record_.warnings.push_back(fmt::format("'{}' holds {}, which is not read",
                                             header.channel.name,
                                             header.format == 1 ? "texts" : "binary objects"));
      const auto width = static_cast<std::uint64_t>(std::max(header.data_width, 0));
      return at + header.length * width;
    }
    if (header.length == 0) {
      record_.warnings.push_back(fmt::format("'{}' has no samples", header.channel.name));
      return at;
    }
    Channel channel = header.channel;
    NumberKind kind = header.precision == 8 ? NumberKind::f64 : NumberKind::f32;
    if (header.precision == 2) {
      kind = NumberKind::i16;
      if (numbers_there(*file_, at, 8, NumberKind::f64, 2) == 2) {
        in_.seek(at);
        const auto low = in_.read<double>("a channel's range");
        const auto high = in_.read<double>("a channel's range");
        set_scale(channel, (high - low) / 32767.0, low, *file_, at);
      }
      at += 16;
    }
    const StoredNumbers numbers =
        numbers_at(*file_, at, header.length, kind, false, channel.name, record_);
    if (numbers.size() == 0 && record_.channels.empty())
      throw InputError(file_->byte_position(file_->bytes().size()),
                       "the file ends before its first sample");
    stored_.push_back({numbers});
    record_.channels.push_back(std::move(channel));
    read_.push_back(&header);
    return at + header.length * size_of(kind);
  }

  double value(std::size_t index, std::uint64_t sample) {
    const StoredNumbers& numbers = stored_[index].samples;
    in_.seek(numbers.runs().front().offset + sample * size_of(numbers.kind()));
    const double raw = numbers.kind() == NumberKind::f64   ? in_.read<double>("a time")
                       : numbers.kind() == NumberKind::f32 ? in_.read<float>("a time")
                                                           : in_.read<std::int16_t>("a time");
    return record_.channels[index].scale * raw + record_.channels[index].offset;
  }

  /// What a time channel's numbers are rounded to.
  double resolution(std::size_t index, double largest) {
    switch (stored_[index].samples.kind()) {
      case NumberKind::f32:
        return std::abs(largest) * 0x1p-23;
      case NumberKind::i16:
        return std::abs(record_.channels[index].scale);
      default:
        return std::abs(largest) * 0x1p-50;
    }
  }

  /// True when a time channel says what the header does: looked at in up to 4096 places. A lost
  /// sample shifts all times behind it.
  bool agrees(std::size_t index, double interval) {
    const std::uint64_t n = stored_[index].samples.size();
    const double first = value(index, 0);
    const std::uint64_t step = std::max<std::uint64_t>(1, n / 4096);
    for (std::uint64_t i = 0; i < n; i += step) {
      const std::uint64_t sample = i + step >= n ? n - 1 : i;
      const double time = value(index, sample);
      const double expected = first + interval * static_cast<double>(sample);
      // half an interval at the most, however coarse the numbers are
      const double tolerance = std::min(1e-3 * interval + resolution(index, time), 0.5 * interval);
      if (!(std::abs(time - expected) <= tolerance)) return false;
    }
    return true;
  }

  /// The interval that a time channel's header states, or a channel of the same length and clock
  /// with more digits.
  double interval_of(std::size_t index) const {
    const double stated = read_[index]->interval;
    for (const CatmanChannel* other : read_)
      if (other->length == read_[index]->length &&
          std::abs(other->interval / stated - 1.0) < 1e-6 &&
          static_cast<float>(other->stated) != other->stated)
        return other->interval;
    return stated;
  }

  /// A time channel's clock; true when every time has to be kept.
  bool read_clock(std::size_t index, datasets::SampleClock& clock) {
    const auto seconds = datasets::conversion(record_.channels[index].unit, "s");
    const double factor = seconds ? seconds->factor : 1.0;
    const std::uint64_t n = stored_[index].samples.size();
    const double interval = interval_of(index);
    if (n == 0) return false;
    clock.start = value(index, 0) * factor;
    if (!std::isfinite(clock.start)) clock.start = 0.0;
    clock.interval = interval;
    if (n == 1 || (interval > 0.0 && agrees(index, interval / factor))) return false;
    std::vector<double> times(n);
    for (std::uint64_t i = 0; i < n; ++i) times[i] = value(index, i) * factor;
    TimeAxis axis = time_axis(std::move(times));
    clock.start = std::isfinite(axis.clock.start) ? axis.clock.start : 0.0;
    clock.interval =
        axis.clock.interval > 0.0 && std::isfinite(axis.clock.interval) ? axis.clock.interval : 0.0;
    if (!axis.warning.empty())
      record_.warnings.push_back(
          fmt::format("'{}': {}", record_.channels[index].name, axis.warning));
    return !axis.clock.uniform();
  }

  /// Gives a channel the times that a time channel stores, as seconds.
  void keep_times(std::size_t time, StoredChannel& channel) const {
    const Channel& described = record_.channels[time];
    const auto seconds = datasets::conversion(described.unit, "s");
    const double factor = seconds ? seconds->factor : 1.0;
    channel.times = stored_[time].samples.first(channel.samples.size());
    channel.times_scaling = [scale = described.scale, offset = described.offset,
                             factor](std::span<double> times) {
      for (double& t : times) t = factor * (scale * t + offset);
    };
  }

  /// The time channel of a channel: as long, and with the interval its header states; of several
  /// the last before it.
  std::optional<std::size_t> time_channel_of(std::size_t index) const {
    std::optional<std::size_t> best;
    int best_score = 0;
    for (std::size_t i = 0; i < read_.size(); ++i) {
      if (!read_[i]->time || read_[i]->length != read_[index]->length) continue;
      const double ratio = read_[i]->interval / read_[index]->interval;
      const int score = 1 + (std::abs(ratio - 1.0) < 1e-6 ? 2 : 0) + (i <= index ? 1 : 0);
      if (score < best_score) continue;
      best_score = score;
      best = i;
    }
    return best;
  }

  void set_clocks() {
    std::vector<datasets::SampleClock> clocks(read_.size());
    std::vector<char> keep(read_.size(), 0);
    for (std::size_t i = 0; i < read_.size(); ++i)
      if (read_[i]->time) keep[i] = read_clock(i, clocks[i]) ? 1 : 0;
    for (std::size_t i = 0; i < read_.size(); ++i) {
      Channel& channel = record_.channels[i];
      channel.attributes["domain"] = "time";
      const auto time = time_channel_of(i);
      if (!time) {
        channel.clock.interval = read_[i]->interval;
        continue;
      }
      channel.clock = clocks[*time];
      channel.attributes["time channel"] = record_.channels[*time].name;
      // a file that is cut may have fewer of either
      if (keep[*time] != 0 && stored_[*time].samples.size() >= stored_[i].samples.size())
        keep_times(*time, stored_[i]);
    }
  }

  std::unique_ptr<MappedFile> file_;
  ByteCursor in_;
  int id_ = 0;  ///< of the file's version
  std::uint64_t data_offset_ = 0;
  int n_channels_ = 0;
  std::vector<CatmanChannel> headers_;
  Record record_;
  std::vector<StoredChannel> stored_;
  std::vector<const CatmanChannel*> read_;  ///< of the channels in record_
};

}  // namespace

int recognises_catman(std::string_view file_name, std::string_view head) {
  if (head.size() < 8) return 0;
  const auto number = [head](std::size_t at) {
    return static_cast<unsigned>(static_cast<unsigned char>(head[at])) |
           static_cast<unsigned>(static_cast<unsigned char>(head[at + 1])) << 8;
  };
  if (number(0) < 5000 || number(0) > last_id) return 0;
  // the comment and 32 more texts follow each other; the first version has the channels at once
  std::size_t at = 6;
  if (number(0) == first_id) {
    at += 2 + number(at);
    if (at + 6 > head.size()) return file_name.ends_with(".bin") ? 60 : 0;
    const std::size_t channels = number(at), samples_at = number(2) | number(4) << 16U;
    return channels > 0 && samples_at > at + 10 + 4 * channels ? 100 : 0;
  }
  for (int i = 0; i < 33; ++i) {
    if (at + 2 > head.size()) return file_name.ends_with(".bin") ? 60 : 0;
    at += 2 + number(at);
  }
  return 100;
}

std::unique_ptr<RecordingReader> open_catman(const std::string& path, const ImportOptions&) {
  return CatmanReader(std::make_unique<MappedFile>(path)).open();
}

}  // namespace impactrig::acquisition
