// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/pair_histories.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "acquisition/conditioning/trace.hpp"
#include "datasets/input_error.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Channel;
using datasets::InputError;
using datasets::UnitConversion;

/// Times further apart than this part of a step are not the same.
constexpr double same_instant = 1e-3;

[[noreturn]] void refuse(const NamedChannel& side, const std::string& problem) {
  throw InputError(whole_file(side.file),
                   fmt::format("channel '{}' {}", side.channel.name, problem));
}

std::string unit_text(const Channel& channel) {
  return channel.unit.empty() ? "without a unit" : fmt::format("in '{}'", channel.unit);
}

/// How the two channels' units become one.
struct CommonUnit {
  std::string unit;
  UnitConversion measured, predicted;
};

CommonUnit common_unit(const NamedChannel& measured, const NamedChannel& predicted) {
  const std::string& unit = measured.channel.unit;
  const std::string si(si_unit(measured.channel.quantity));
  if (!si.empty()) {
    const auto m = datasets::conversion(unit, si);
    const auto p = datasets::conversion(predicted.channel.unit, si);
    // an offset (degrees Celsius) would change what is large and what is small
    if (m && p && m->offset == 0.0 && p->offset == 0.0) return {si, *m, *p};
  }
  if (unit == predicted.channel.unit) return {unit, {}, {}};
  if (const auto p = datasets::conversion(predicted.channel.unit, unit)) return {unit, {}, *p};
  refuse(predicted, fmt::format("is {}, the measured '{}' {}, and one cannot be converted into the "
                                "other; state the sensors' sensitivities (--rig), compare other "
                                "channels (--channel, --predicted-channel), or state the units of "
                                "a text (--units, --predicted-units)",
                                unit_text(predicted.channel), measured.channel.name,
                                unit_text(measured.channel)));
}

/// Sound samples of a channel with their times, ascending.
struct Series {
  std::vector<double> times, values;
  std::vector<double> unsound;  ///< times between the first and the last sound sample
  bool uniform = true;
  double start = 0.0, interval = 0.0;  ///< of the whole channel
};

Series series_of(const NamedChannel& side, const UnitConversion& unit, double shift) {
  const Channel& channel = side.channel;
  if (channel.complex())
    refuse(side,
           "holds complex numbers, so it is a spectrum; choose a channel that is a time history");
  if (const auto domain = channel.attributes.find("domain");
      domain != channel.attributes.end() && domain->second != "time")
    refuse(side, fmt::format("is over {}, not over time; choose a channel that is a time history",
                             domain->second));
  if (channel.size() == 0) refuse(side, "has no samples; choose another channel");
  Series series;
  series.uniform = channel.clock.uniform();
  series.start = channel.clock.start + shift;
  series.interval = channel.clock.interval;
  if (series.uniform && !(series.interval > 0.0 && std::isfinite(series.interval)))
    refuse(side, "has no times; state the sample rate (--sample-rate, --predicted-sample-rate)");
  double before = -std::numeric_limits<double>::infinity();
  std::vector<double> unsound;
  for (std::size_t i = 0; i < channel.size(); ++i) {
    const double time = channel.clock.time(i) + shift;
    if (!(time > before))
      refuse(side, fmt::format("has times that do not increase: {:.9g} s after {:.9g} s at sample "
                               "{}",
                               time, before, i));
    before = time;
    const double value = unit.factor * channel.value(i) + unit.offset;
    if (channel.is_valid(i) && std::isfinite(value)) {
      series.times.push_back(time);
      series.values.push_back(value);
    } else if (!series.times.empty()) {
      unsound.push_back(time);
    }
  }
  if (series.times.empty()) refuse(side, "has no sound sample; choose another channel");
  for (const double time : unsound)
    if (time < series.times.back()) series.unsound.push_back(time);
  return series;
}

/// Times start + i interval, i < size.
struct Base {
  double start = 0.0, interval = 0.0;
  std::size_t size = 0;

  double time(std::size_t i) const { return start + interval * static_cast<double>(i); }

  double last() const { return time(size - 1); }
};

/// The measured channel's times from `from` to `to`.
Base base_of(const Series& measured, double from, double to) {
  const double slack = same_instant * measured.interval;
  Base base;
  base.interval = measured.interval;
  if (measured.uniform) {
    const double first = std::ceil((from - slack - measured.start) / measured.interval);
    const double last = std::floor((to + slack - measured.start) / measured.interval);
    base.start = measured.start + first * measured.interval;
    base.size = last >= first ? static_cast<std::size_t>(last - first) + 1 : 0;
    return base;
  }
  const auto first = std::ranges::lower_bound(measured.times, from);
  const auto end = std::ranges::upper_bound(measured.times, to);
  if (end - first < 2) return base;
  base.start = *first;
  base.size = static_cast<std::size_t>(end - first);
  base.interval = (*(end - 1) - *first) / static_cast<double>(base.size - 1);
  return base;
}

/// Whether the series' clock shows the base's instants.
bool has_instants(const Series& series, const Base& base) {
  if (!series.uniform) return false;
  const auto off = [&](double time) {
    const double index = (time - series.start) / series.interval;
    return std::abs(index - std::round(index)) * series.interval;
  };
  const double steps =
      std::abs(base.interval - series.interval) * static_cast<double>(base.size - 1);
  const double slack = same_instant * base.interval;
  return steps < slack && off(base.start) < slack && off(base.last()) < slack;
}

/// Values at the base's instants by straight lines; `exact`: at the nearest sound sample where that
/// is the instant.
std::vector<double> at_instants(const Series& series, const Base& base, bool exact) {
  std::vector<double> result(base.size);
  std::size_t next = 0;
  for (std::size_t i = 0; i < base.size; ++i) {
    const double time = base.time(i), slack = exact ? same_instant * base.interval : 0.0;
    while (next < series.times.size() && series.times[next] < time - slack) ++next;
    if (next == series.times.size()) {
      result[i] = series.values.back();
      continue;
    }
    const double after = series.times[next];
    if (next == 0 || after <= time + slack) {
      result[i] = series.values[next];
      continue;
    }
    const double before = series.times[next - 1];
    const double part = (time - before) / (after - before);
    result[i] = (1.0 - part) * series.values[next - 1] + part * series.values[next];
  }
  return result;
}

std::size_t count_within(const std::vector<double>& times, const Base& base) {
  return static_cast<std::size_t>(std::ranges::upper_bound(times, base.last()) -
                                  std::ranges::lower_bound(times, base.start));
}

void refuse_mostly_unsound(const NamedChannel& side, const Series& series, const Base& base,
                           std::size_t unsound) {
  const std::size_t all = unsound + count_within(series.times, base);
  if (10 * unsound > all)
    refuse(side, fmt::format("is not sound at {} of the {} samples compared, too many to bridge; "
                             "choose a window without them (--from, --to)",
                             unsound, all));
}

std::string bridged_note(const NamedChannel& side, std::size_t count) {
  return fmt::format(
      "{}: {} of the samples of '{}' {} not sound (missing, clipped or not finite) and {} bridged "
      "by straight lines",
      side.file, count, side.channel.name, count == 1 ? "is" : "are", count == 1 ? "was" : "were");
}

std::string resampled_note(const NamedChannel& side, const Series& series, const Base& base) {
  const bool same_step =
      series.uniform && std::abs(series.interval - base.interval) * static_cast<double>(base.size) <
                            same_instant * base.interval;
  std::string own;
  if (!series.uniform)
    own = fmt::format("its own steps are uneven, {:.6g} s on average", series.interval);
  else if (same_step)
    own = fmt::format("its own lie {:+.3g} s beside them",
                      std::remainder(series.start - base.start, base.interval));
  else
    own = fmt::format("its own step is {:.6g} s", series.interval);
  std::string note =
      fmt::format("{}: '{}' was resampled by straight lines to {} instants {:.6g} s apart; {}",
                  side.file, side.channel.name, base.size, base.interval, own);
  if (series.interval < 0.75 * base.interval)
    note += ", so that what it has above half the new rate is folded back unless it was filtered";
  return note;
}

/// What of the measured samples in the window is not compared; "" when nothing is left out.
std::string cut_note(const NamedChannel& measured, const NamedChannel& predicted, const Series& m,
                     const Series& p, const Base& base, const PairingOptions& options) {
  const double from = std::max(m.times.front(), options.from);
  const double to = std::min(m.times.back(), options.to);
  if (base.start <= from + base.interval && base.last() >= to - base.interval) return "";
  return fmt::format(
      "{}: '{}' is compared from {:.6g} s to {:.6g} s only, where {} has sound samples ({:.6g} s "
      "to "
      "{:.6g} s)",
      measured.file, measured.channel.name, base.start, base.last(), predicted.file,
      p.times.front(), p.times.back());
}

}  // namespace

PairedHistories pair_histories(const NamedChannel& measured, const NamedChannel& predicted,
                               const PairingOptions& options) {
  const CommonUnit unit = common_unit(measured, predicted);
  const Series m = series_of(measured, unit.measured, 0.0);
  const Series p = series_of(predicted, unit.predicted, options.shift);
  const double from = std::max({m.times.front(), p.times.front(), options.from});
  const double to = std::min({m.times.back(), p.times.back(), options.to});
  const Base base = base_of(m, from, to);
  if (base.size < 2)
    throw InputError(
        whole_file(predicted.file),
        fmt::format(
            "'{}' from {:.6g} s to {:.6g} s and the measured '{}' of {} from {:.6g} s to "
            "{:.6g} s have {} instants in common{}; if they count their times from "
            "different events, --shift moves the predicted history",
            predicted.channel.name, p.times.front(), p.times.back(), measured.channel.name,
            measured.file, m.times.front(), m.times.back(), base.size == 0 ? "no" : "too few",
            std::isfinite(options.from) || std::isfinite(options.to) ? " within the window" : ""));
  PairedHistories result;
  result.unit = unit.unit;
  result.start = base.start;
  result.interval = base.interval;
  result.measured_resampled = !m.uniform;
  result.predicted_resampled = !has_instants(p, base);
  result.measured = at_instants(m, base, !result.measured_resampled);
  result.predicted = at_instants(p, base, !result.predicted_resampled);
  result.measured_bridged = count_within(m.unsound, base);
  result.predicted_bridged = count_within(p.unsound, base);
  refuse_mostly_unsound(measured, m, base, result.measured_bridged);
  refuse_mostly_unsound(predicted, p, base, result.predicted_bridged);
  if (std::string note = cut_note(measured, predicted, m, p, base, options); !note.empty())
    result.notes.push_back(std::move(note));
  if (result.measured_resampled) result.notes.push_back(resampled_note(measured, m, base));
  if (result.predicted_resampled) result.notes.push_back(resampled_note(predicted, p, base));
  if (result.measured_bridged > 0)
    result.notes.push_back(bridged_note(measured, result.measured_bridged));
  if (result.predicted_bridged > 0)
    result.notes.push_back(bridged_note(predicted, result.predicted_bridged));
  return result;
}

}  // namespace impactrig::acquisition
