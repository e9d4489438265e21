// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/lvm_recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>

#include "acquisition/importers/column_heads.hpp"
#include "acquisition/importers/header_fields.hpp"
#include "acquisition/importers/number.hpp"
#include "acquisition/importers/stated_units.hpp"
#include "acquisition/importers/text_file.hpp"
#include "acquisition/importers/time_axis.hpp"
#include "datasets/input_error.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::InputError;
using datasets::SampleClock;

namespace {

constexpr std::size_t most_warnings = 100;
constexpr double latest_start = 1e9;  ///< [s]; larger ones count since 1904

bool alike(const LvmSegment& a, const LvmSegment& b) {
  return std::ranges::equal(a.parts, b.parts, [](const LvmPart& one, const LvmPart& other) {
    return one.name == other.name && one.unit == other.unit &&
           one.x_dimension == other.x_dimension && one.x_unit == other.x_unit &&
           one.delta == other.delta && one.later == other.later && one.x.empty() == other.x.empty();
  });
}

double first_x(const LvmPart& part) {
  return part.x.empty() ? part.x0.value_or(0.0) : part.x.front();
}

double step_of(const LvmPart& part) {
  const std::uint64_t n = part.x.size();
  if (n > 1) return (part.x.back() - part.x.front()) / static_cast<double>(n - 1);
  return part.delta.value_or(0.0);
}

/// Whether `next`, shifted, goes on where `part` ends: within half a step.
bool continues(const LvmPart& part, const LvmPart& next, double shift) {
  const double step = step_of(part);
  if (!(step > 0.0) || part.values.empty() || next.values.empty()) return false;
  const double end = part.x.empty() ? first_x(part) + step * static_cast<double>(part.values.size())
                                    : part.x.back() + step;
  return std::abs(first_x(next) + shift - end) <= 0.5 * step;
}

void append(LvmPart& part, LvmPart&& next, double shift) {
  if (part.invalid.empty() && !next.invalid.empty()) part.invalid.append(part.values.size(), 0);
  if (!part.invalid.empty() && next.invalid.empty()) next.invalid.append(next.values.size(), 0);
  part.invalid.append(std::move(next.invalid));
  part.values.append(std::move(next.values));
  part.missing += next.missing;
  next.x.each([&](std::span<const double> piece) {
    for (const double x : piece) part.x.push_back(x + shift);
  });
  part.x.settle();
  part.check.agrees = part.check.agrees && next.check.agrees;
  if (part.said && next.said && *next.said < std::numeric_limits<std::uint64_t>::max() - *part.said)
    *part.said += *next.said;
  else
    part.said.reset();
}

/// The round rate [Hz] that a Delta_X of few decimals must stand for: "0.000977" is 1/1024 s. None
/// when the rate is an integer as it stands, or nothing is rounder.
std::optional<double> rate_meant(std::string_view text, double delta) {
  const std::size_t mark = text.find_first_of(".,");
  const bool fixed = mark != std::string_view::npos &&
                     text.find_first_not_of("0123456789", mark + 1) == std::string_view::npos;
  if (!fixed || !(delta > 0.0)) return std::nullopt;
  const double stated = 1.0 / delta;
  if (std::abs(stated - std::round(stated)) <= 1e-9 * stated) return std::nullopt;
  const double half = 0.5 * std::pow(10.0, -static_cast<double>(text.size() - mark - 1));
  if (!(half < delta)) return std::nullopt;
  const double low = std::ceil(1.0 / (delta + half));
  const double high = std::floor(1.0 / (delta - half));
  // a number with one or two digits is rounded so much that nothing can be said
  if (!(low >= 1.0) || high - low > 0.01 * stated || high - low > 1000.0) return std::nullopt;
  std::optional<double> best;
  double best_odd = 0.0;
  for (double rate = low; rate <= high; rate += 1.0) {
    double odd = rate;
    for (const double factor : {2.0, 5.0})
      while (std::fmod(odd, factor) == 0.0) odd /= factor;
    if (!best || odd < best_odd) {
      best = rate;
      best_odd = odd;
    }
  }
  return best && best_odd < 100.0 ? best : std::nullopt;
}

}  // namespace

double operator-(const LvmMoment& a, const LvmMoment& b) {
  return static_cast<double>(a.seconds - b.seconds) + (a.fraction - b.fraction);
}

void LvmRecording::warn(std::string text) {
  if (record_.warnings.size() < most_warnings &&
      std::ranges::find(record_.warnings, text) == record_.warnings.end())
    record_.warnings.push_back(std::move(text));
}

void LvmRecording::say(std::string_view key, std::string_view value) {
  if (!value.empty()) record_.attributes.emplace(to_utf8(key), to_utf8(value));
}

void LvmRecording::add(LvmSegment&& segment, bool one_heading) {
  for (LvmPart& part : segment.parts) part.settle();
  if (!segment.goes_on) check_counts(segment, one_heading);
  join(std::move(segment));
}

void LvmRecording::finish(bool multi, bool whole) {
  if (segments_.empty())
    warn("there is no segment with samples in this file: there are no channels");
  if (segments_.size() > 1 && whole)
    warn(
        fmt::format("the file has {} segments that do not continue each other in time: channels "
                    "of the later ones are named '... (segment n)'",
                    segments_.size()));
  for (const LvmSegment& segment : segments_) tell_times_among(segment);
  for (LvmSegment& segment : segments_) deliver(segment, multi);
  check_stated_units(options_.units, record_.channels.size(), "channels", path_);
}

void LvmRecording::check_counts(const LvmSegment& segment, bool one_heading) {
  std::map<std::pair<std::uint64_t, std::uint64_t>, std::string> differ;  // names by counts
  for (const LvmPart& part : segment.parts) {
    const std::uint64_t n = part.samples();
    if (!part.said || *part.said == n) continue;
    std::string& names = differ[{*part.said, n}];
    if (names.size() < 200)
      names += fmt::format("{}'{}'", names.empty() ? "" : ", ", part.name);
    else if (!names.ends_with("..."))
      names += ", ...";
  }
  for (const auto& [counts, names] : differ) {
    const auto [said, n] = counts;
    warn(fmt::format("{}: the header declares {} samples, there are {}{}", names, said, n,
                     n > said && one_heading
                         ? ": packets without a header of their own follow, and whether time "
                           "passed between them is not told"
                         : ""));
  }
}

/// X values begin anew at the date and time of each segment, or go on from those of the first, as
/// the difference tells. Those that count since 1904 have the first one's moment twice.
double LvmRecording::shift_of(const LvmSegment& segment) const {
  if (segment.parts.empty()) return 0.0;
  const LvmSegment& first = segments_.empty() ? segment : segments_.front();
  if (!segment.moment || !first.moment) return 0.0;
  const double start = first_x(first.parts.front());
  const double origin = start > latest_start ? -start : 0.0;
  const double later = *segment.moment - *first.moment;
  const bool goes_on =
      later > 0.0 && std::abs(first_x(segment.parts.front()) - start - later) < 0.01 * later;
  return goes_on ? origin : origin + later;
}

/// Joined by its X values, which leave no room for what its date and time say; their clock may be
/// that of the writing.
void LvmRecording::tell_of_later_stamp(const LvmSegment& segment, double shift) {
  const double late = shift_of(segment) - shift;
  if (late > 1.0)
    warn(
        fmt::format("segment {} goes on where the one before ends by its X values, but its date "
                    "and time are {:.6g} s later: the X values are taken",
                    segment.first, late));
}

void LvmRecording::join(LvmSegment&& segment) {
  const double own = shift_of(segment);
  if (!segments_.empty() && alike(segments_.back(), segment)) {
    LvmSegment& before = segments_.back();
    for (const double shift : {before.shift, own}) {
      bool goes_on = !before.parts.empty();
      for (std::size_t c = 0; c < before.parts.size() && goes_on; ++c)
        goes_on = continues(before.parts[c], segment.parts[c], shift - before.shift);
      if (!goes_on) continue;
      tell_of_later_stamp(segment, shift);
      for (std::size_t c = 0; c < before.parts.size(); ++c)
        append(before.parts[c], std::move(segment.parts[c]), shift - before.shift);
      ++before.joined;
      before.goes_on = segment.goes_on;
      return;
    }
  }
  segment.shift = own;
  segments_.push_back(std::move(segment));
}

/// Writers without an X column may have their times among the channels, and another Delta_X.
void LvmRecording::tell_times_among(const LvmSegment& segment) {
  for (const LvmPart& times : segment.parts) {
    const auto seconds = datasets::conversion(times.unit.empty() ? "s" : times.unit, "s");
    if (!is_time_name(times.name) || !seconds || !times.x.empty() || times.values.size() < 3)
      continue;
    TimeAxisCheck check(times.values.front(), times.values.back(), times.values.size());
    times.values.each([&check](std::span<const double> piece) { check.add(piece); });
    const double step = check.axis().clock.interval * seconds->factor;
    if (!check.uniform() || !(step > 0.0)) continue;
    std::string others;
    for (const LvmPart& part : segment.parts)
      if (&part != &times && part.x.empty() && part.delta && part.x_unit.empty() &&
          std::abs(*part.delta - step) > 1e-3 * step && others.size() < 200)
        others += fmt::format("{}'{}' ({})", others.empty() ? "" : ", ", part.name, *part.delta);
    if (!others.empty())
      warn(
          fmt::format("'{}' holds times in steps of {:.6g} s, but Delta_X is another for {}: the "
                      "clocks are those of Delta_X (--sample-rate {:.9g} states the other)",
                      times.name, step, others, 1.0 / step));
  }
}

void LvmRecording::deliver(LvmSegment& segment, bool multi) {
  for (LvmPart& part : segment.parts) {
    Channel channel;
    channel.name = part.name;
    if (segment.first > 1) channel.name += fmt::format(" (segment {})", segment.first);
    const std::size_t index = record_.channels.size();
    channel.unit = index < options_.units.size() && !options_.units[index].empty()
                       ? options_.units[index]
                       : part.unit;
    channel.quantity = datasets::quantity_of_unit(channel.unit);
    if (!part.y_dimension.empty()) channel.attributes["Y_Dimension"] = part.y_dimension;
    if (segment.joined > 1) channel.attributes["segments"] = fmt::format("{}", segment.joined);
    if (part.said) channel.attributes["Samples"] = fmt::format("{}", *part.said);
    StoredChannel stored;
    const bool own_x = multi || part.x.empty();
    set_clock(part, segment.shift + (own_x ? part.later : 0.0), multi, channel, stored);
    if (part.missing > 0 && !segment.goes_on)
      warn(fmt::format("'{}': {} of {} values {} missing; marked as not valid", channel.name,
                       part.missing, part.values.size(), part.missing == 1 ? "is" : "are"));
    if (spool_) {
      stored.samples = part.values.stored();
      stored.invalid = part.invalid.stored();
      stored_.push_back(std::move(stored));
    } else {
      channel.raw = part.values.take();
      channel.valid = part.invalid.take();
      for (std::uint8_t& mark : channel.valid) mark = mark == 0 ? 1 : 0;
    }
    record_.channels.push_back(std::move(channel));
  }
}

std::unique_ptr<RecordingReader> LvmRecording::reader() {
  if (!spool_) return reader_of(std::move(record_));
  return reader_of_numbers(spool_->map(), std::move(record_), std::move(stored_));
}

void LvmRecording::set_clock(LvmPart& part, double shift, bool multi, Channel& channel,
                             StoredChannel& stored) {
  const std::string dimension = lowered(part.x_dimension);
  const bool time = dimension.empty() || dimension == "time";
  if (!time) {
    set_abscissa(channel, dimension, part.x_unit, first_x(part), step_of(part));
    return;
  }
  double factor = 1.0;
  if (!part.x_unit.empty()) {
    const auto conversion = datasets::conversion(part.x_unit, "s");
    if (conversion)
      factor = conversion->factor;
    else
      warn(fmt::format("the X unit '{}' is not one of time: times are taken as s", part.x_unit));
  }
  SampleClock& clock = channel.clock;
  const double delta = part.delta.value_or(0.0);
  if (!part.delta_text.empty()) channel.attributes["Delta_X"] = part.delta_text;
  bool gaps = false;
  part.x.each([&gaps](std::span<const double> piece) {
    gaps = gaps || !std::ranges::all_of(piece, [](double value) { return std::isfinite(value); });
  });
  if (gaps)
    warn(fmt::format("'{}': X values are missing: {}", channel.name,
                     delta > 0.0 ? "Delta_X is used" : "the X column is not used"));
  if (part.x.empty() || gaps) {
    clock.start = part.x0.value_or(0.0) * factor + shift;
    clock.interval = delta * factor;
    if (!part.delta && !part.delta_text.empty())
      set_attribute(channel, unusable_clock, fmt::format("'Delta_X' as '{}'", part.delta_text));
    tell_rate_meant(part);
    return;
  }
  if (delta > 0.0 && part.check.agrees) {
    clock.start = part.x.front() * factor + shift;
    clock.interval = delta * factor;
    return;
  }
  take_x_column(part, factor, shift, multi, channel, stored);
}

void LvmRecording::take_x_column(LvmPart& part, double factor, double shift, bool multi,
                                 Channel& channel, StoredChannel& stored) {
  SampleClock& clock = channel.clock;
  const double delta = part.delta.value_or(0.0);
  TimeAxisCheck check(part.x.front(), part.x.back(), part.x.size());
  part.x.each([&check](std::span<const double> piece) { check.add(piece); });
  TimeAxis axis = check.axis();
  const bool restarts = axis.warning.starts_with("time does not increase");
  if (delta > 0.0 && restarts)
    warn(
        fmt::format("'{}': the X column restarts: {}; recordings follow each other, and how much "
                    "time passed between them is not told (--sample-rate {:.9g} joins them end to "
                    "end)",
                    channel.name, axis.warning, 1.0 / (delta * factor)));
  else if (delta > 0.0)
    warn(fmt::format("{}Delta_X is {:.9g} but the X column steps by {:.9g}: the X column is used",
                     multi ? "'" + channel.name + "': " : std::string(), delta,
                     axis.clock.interval));
  if (!axis.warning.empty() && !(delta > 0.0 && restarts))
    warn(fmt::format("'{}': {}", channel.name, axis.warning));
  clock = std::move(axis.clock);
  clock.start = clock.start * factor + shift;
  clock.interval *= factor;
  if (check.uniform()) return;
  const auto to_seconds = [factor, shift](std::span<double> times) {
    for (double& x : times) x = x * factor + shift;
  };
  if (spool_) {
    stored.times = part.x.stored();
    stored.times_scaling = to_seconds;
  } else {
    clock.times = part.x.take();
    to_seconds(clock.times);
  }
}

void LvmRecording::tell_rate_meant(const LvmPart& part) {
  const auto rate = rate_meant(part.delta_text, part.delta.value_or(0.0));
  if (rate)
    warn(
        fmt::format("Delta_X is printed as {}, which stands for 1/{} s too: --sample-rate {} "
                    "states that",
                    part.delta_text, *rate, *rate));
}

}  // namespace impactrig::acquisition
