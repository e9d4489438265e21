// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/clock_words.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "acquisition/importers/column_heads.hpp"
#include "acquisition/importers/number.hpp"
#include "acquisition/importers/text_file.hpp"
#include "acquisition/importers/time_words.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

namespace {

constexpr auto time_words = std::to_array<std::string_view>(
    {"t",           "time",         "times",      "time_s",    "t_s",         "tvec",
     "zeit",        "timestamp",    "timestamps", "x_time",    "timevector",  "time_vector",
     "timevec",     "time_vec",     "timeaxis",   "time_axis", "time_domain", "elapsed",
     "elapsedtime", "elapsed_time", "laufzeit",   "tm",        "time_rel",    "rel_time",
     "t_rel",       "tout"});  // Simulink, beside yout
constexpr auto interval_words = std::to_array<std::string_view>(
    {"dt", "ts", "sampleinterval", "sample_interval", "deltat", "delta_t", "delta_x",
     "samplinginterval", "sampling_interval", "sampleperiod", "sample_period", "samplingperiod",
     "sampling_period", "timestep", "time_step",
     "tinterval",  // PicoScope
     "xinc"});     // Infiniium
constexpr auto rate_words = std::to_array<std::string_view>({"fs",
                                                             "sr",
                                                             "f_s",
                                                             "fsamp",
                                                             "srate",
                                                             "sfreq",
                                                             "fsample",
                                                             "samprate",
                                                             "samp_rate",
                                                             "samplerate",
                                                             "sample_rate",
                                                             "samplingrate",
                                                             "sampling_rate",
                                                             "time_sample_rate",
                                                             "samplefreq",
                                                             "sample_freq",
                                                             "samplingfreq",
                                                             "sampling_freq",
                                                             "samplefrequency",
                                                             "sample_frequency",
                                                             "samplingfrequency",
                                                             "sampling_frequency",
                                                             "abtastrate",
                                                             "abtastfrequenz"});
constexpr auto start_words =
    std::to_array<std::string_view>({"t0", "t_start", "start_time", "starttime",
                                     "tstart",  // PicoScope, beside Tinterval
                                     "xorg"});  // Infiniium, beside XInc

template <std::size_t N>
bool among(const std::array<std::string_view, N>& words, std::string_view name) {
  return std::ranges::find(words, name) != words.end();
}

/// "time" and "us" of "run.time_us", "dt" and "ms" of "dt_ms", "fs" and "Hz" of "fs_Hz".
ColumnHead last_head(std::string_view name) {
  using datasets::Quantity;
  const std::size_t end = end_of_group(name);
  ColumnHead head = split_head(end == std::string_view::npos ? name : name.substr(end + 1));
  if (head.name.ends_with("Hz") && !head.name.ends_with("_Hz"))  // "sampleRateHz"
    if (std::string word = head.name.substr(0, head.name.size() - 2);
        head.unit.empty() && among(rate_words, lowered(word)))
      return {std::move(word), "Hz", ""};
  const std::size_t line = head.name.rfind('_');
  if (!head.unit.empty() || line == std::string::npos) return head;
  const std::string word = lowered(head.name.substr(0, line));
  const std::string unit = head.name.substr(line + 1);
  const Quantity quantity = datasets::quantity_of_unit(unit);
  if ((quantity == Quantity::time && (among(interval_words, word) || among(start_words, word))) ||
      (quantity == Quantity::frequency && among(rate_words, word))) {
    head.name.resize(line);
    head.unit = unit;
  }
  return head;
}

}  // namespace

std::size_t end_of_group(std::string_view name) {
  const char close = name.empty() ? ' ' : name.back();
  if (close == ')') name = name.substr(0, name.rfind('('));
  if (close == ']') name = name.substr(0, name.rfind('['));
  return name.find_last_of("./");
}

std::string last_word(std::string_view name) {
  return lowered(last_head(name).name);
}

bool is_interval_word(std::string_view word) {
  return among(interval_words, word);
}

bool is_rate_word(std::string_view word) {
  return among(rate_words, word);
}

bool is_start_word(std::string_view word) {
  return among(start_words, word);
}

std::string unit_by_name(std::string_view name) {
  return last_head(name).unit;
}

bool is_named_as_time(std::string_view name) {
  const std::string word = last_word(name);
  return among(time_words, word) || !unit_named(word).empty();
}

namespace {

/// Of a rate or an interval, with what is one of its unit in seconds, or its period is.
std::optional<double> interval_of(bool rate, double seconds, double value) {
  const double interval = rate ? seconds / value : seconds * value;
  return interval > 0.0 && std::isfinite(interval) ? std::optional(interval) : std::nullopt;
}

struct NamedClock {
  bool rate;
  std::string unit;
};

/// None of words that are dates as often, or of an axis that may be another than time.
std::optional<NamedClock> clock_of_name(std::string_view name) {
  std::string joined(name);
  std::ranges::replace(joined, ' ', '_');
  const ColumnHead spaced = last_head(name), head = last_head(joined);
  std::string word = lowered(spaced.name);
  std::ranges::replace(word, ' ', '_');
  const std::string unit = spaced.unit.empty() ? head.unit : spaced.unit;
  if (spaced.unit.empty()) word = lowered(head.name);
  if (word == "ts" || word == "delta_x" || word.starts_with('x')) return std::nullopt;
  if (among(rate_words, word)) return NamedClock{true, unit};
  if (among(interval_words, word)) return NamedClock{false, unit};
  return std::nullopt;
}

std::optional<double> in_unit(const NamedClock& clock, const std::string& unit, double value) {
  if (unit.empty()) return interval_of(clock.rate, 1.0, value);
  if (const auto time = datasets::conversion(unit, "s"))
    return interval_of(false, time->factor, value);
  if (const auto rate = datasets::conversion(unit, "Hz"))
    return interval_of(true, 1.0 / rate->factor, value);
  return std::nullopt;
}

}  // namespace

std::optional<double> interval_by_name(std::string_view name, double value) {
  const std::optional<NamedClock> clock = clock_of_name(name);
  return clock ? in_unit(*clock, clock->unit, value) : std::nullopt;
}

std::optional<double> interval_by_name(std::string_view name, std::string_view text) {
  const std::optional<NamedClock> clock = clock_of_name(name);
  if (!clock) return std::nullopt;
  double value = 0.0;
  const char* const behind = scan_number(text.data(), text.data() + text.size(), {}, value);
  if (behind == text.data()) return std::nullopt;
  const std::string_view unit =
      trimmed(text.substr(static_cast<std::size_t>(behind - text.data())));
  return in_unit(*clock, unit.empty() ? clock->unit : std::string(unit), value);
}

}  // namespace impactrig::acquisition
