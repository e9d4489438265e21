// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/header_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <limits>

#include "acquisition/importers/number.hpp"
#include "acquisition/importers/text_file.hpp"
#include "acquisition/importers/time_axis.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::InputError;
using datasets::Record;

std::string fixed_text(std::string_view field) {
  return to_utf8(trimmed(field.substr(0, field.find('\0'))));
}

double meant_by_float(double value) {
  if (!std::isfinite(value) || std::abs(value) > std::numeric_limits<float>::max()) return value;
  const auto single = static_cast<float>(value);
  if (static_cast<double>(single) != value) return value;
  return number_in(fmt::format("{}", single)).value_or(value);
}

std::string input_name(std::string_view label) {
  std::string_view digits = label;
  for (const std::string_view prefix : {"channel", "chan", "ch", "c"}) {
    if (digits.size() <= prefix.size()) continue;
    bool same = true;
    for (std::size_t i = 0; i < prefix.size(); ++i)
      same = same && std::tolower(static_cast<unsigned char>(digits[i])) == prefix[i];
    if (!same) continue;
    digits.remove_prefix(prefix.size());
    break;
  }
  digits = trimmed(digits);
  const bool input =
      digits.size() == 1 && std::isdigit(static_cast<unsigned char>(digits.front())) != 0;
  return input ? fmt::format("CH {}", digits) : std::string(label);
}

void set_attribute(Channel& channel, std::string_view name, std::string_view text) {
  if (!text.empty()) channel.attributes[std::string(name)] = text;
}

void set_attribute(Record& record, std::string_view name, std::string_view text) {
  if (!text.empty()) record.attributes[std::string(name)] = text;
}

void set_unit(Channel& channel, std::string_view unit) {
  channel.unit = unit;
  channel.quantity = datasets::quantity_of_unit(unit);
}

void tell_unusable_interval(Channel& channel, double interval, std::string_view unit) {
  if (interval > 0.0 && std::isfinite(interval)) return;
  channel.attributes[std::string(unusable_clock)] =
      fmt::format("a sample interval of {:.9g} {}", interval, unit.empty() ? "s" : unit);
}

void tell_unusable_rate(Channel& channel, double rate) {
  if (rate > 0.0 && std::isfinite(rate)) return;
  channel.attributes[std::string(unusable_clock)] = fmt::format("a sample rate of {:.9g} Hz", rate);
}

void set_axis(Channel& channel, double start, double interval, std::string_view unit) {
  const auto to_seconds = datasets::conversion(unit, "s");
  if (unit.empty() || to_seconds) tell_unusable_interval(channel, interval, unit);
  if (!std::isfinite(start)) start = 0.0;
  if (!std::isfinite(interval)) interval = 0.0;
  if (unit.empty() || to_seconds) {
    const double factor = to_seconds ? to_seconds->factor : 1.0;
    channel.attributes["domain"] = "time";
    channel.clock.start = factor == 1.0 ? start : start * factor;
    channel.clock.interval = interval <= 0.0 ? 0.0 : factor == 1.0 ? interval : interval * factor;
    return;
  }
  const bool frequency = datasets::quantity_of_unit(unit) == datasets::Quantity::frequency;
  set_abscissa(channel, frequency ? "frequency" : "other", unit, start, interval);
}

void set_scale(Channel& channel, double scale, double offset, const MappedFile& file,
               std::uint64_t place) {
  if (!std::isfinite(scale) || !std::isfinite(offset))
    throw InputError(file.byte_position(place),
                     fmt::format("'{}': scale {} and offset {} are no numbers to scale samples by",
                                 channel.name, scale, offset));
  channel.scale = scale;
  channel.offset = offset;
}

void undo_zero_scale(Channel& channel, Record& record) {
  if (channel.scale != 0.0) return;
  record.warnings.push_back(
      fmt::format("'{}': the header states a scale of 0: its numbers are as they are stored, "
                  "without a unit",
                  channel.name));
  channel.scale = 1.0;
  channel.offset = 0.0;
  set_unit(channel, "");
}

std::string iso_time(int year, int month, int day, int hour, int minute, double second) {
  using namespace std::chrono;
  const year_month_day date{std::chrono::year(year), std::chrono::month(unsigned(month)),
                            std::chrono::day(unsigned(day))};
  if (year < 1 || year > 9999 || month < 1 || month > 12 || day < 1 || day > 31 || !date.ok())
    return {};
  if (hour < 0 || hour > 23 || minute < 0 || minute > 59 || !(second >= 0.0) || second >= 61.0)
    return {};
  // no more than microseconds, truncated: rounding could give 60 s
  auto micros = static_cast<long>(second * 1e6 + 1e-3);
  if (second < 60.0) micros = std::min(micros, 59999999L);
  std::string text = fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}", year, month, day, hour,
                                 minute, micros / 1000000);
  if (micros % 1000000 != 0) {
    text += fmt::format(".{:06}", micros % 1000000);
    while (text.back() == '0') text.pop_back();
  }
  return text;
}

std::string iso_time_utc(double seconds) {
  using namespace std::chrono;
  if (!(seconds > 0.0) || seconds > 7258118400.0) return {};  // the year 2200
  const auto whole = static_cast<std::int64_t>(seconds);
  const sys_days date = floor<days>(sys_seconds(std::chrono::seconds(whole)));
  const year_month_day calendar(date);
  const std::int64_t of_day = whole - sys_seconds(date).time_since_epoch().count();
  std::string text =
      iso_time(int(calendar.year()), int(unsigned(calendar.month())), int(unsigned(calendar.day())),
               int(of_day / 3600), int(of_day / 60 % 60),
               double(of_day % 60) + (seconds - static_cast<double>(whole)));
  return text.empty() ? text : text + "Z";
}

StoredNumbers numbers_at(const MappedFile& file, std::uint64_t offset, std::uint64_t announced,
                         NumberKind kind, bool big_endian, std::string_view channel,
                         Record& record) {
  const std::uint64_t width = size_of(kind);
  const std::uint64_t there = numbers_there(file, offset, width, kind, announced);
  if (there < announced) record.warnings.push_back(cut_off(channel, there, announced));
  StoredNumbers numbers(kind, big_endian);
  numbers.add({offset, there, width});
  return numbers;
}

std::string cut_off(std::string_view channel, std::uint64_t there, std::uint64_t announced) {
  return fmt::format("'{}': the file ends after {} of {} samples", channel, there, announced);
}

}  // namespace impactrig::acquisition
