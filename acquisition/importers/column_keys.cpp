// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/column_keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "acquisition/importers/date_time.hpp"
#include "acquisition/importers/number.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

namespace {

/// A number and the unit behind it. The decimal mark is the table's, or the other one where only
/// that makes sense and cells do not end with it, or quotes hold it.
struct StatedValue {
  double value = 0.0;
  std::string_view unit;
};

std::optional<StatedValue> stated_value(std::string_view text, Dialect dialect) {
  const char other = dialect.decimal == ',' ? '.' : ',';
  const bool quoted = text.size() > 1 && text.starts_with('"') && text.ends_with('"');
  if (quoted) text = trimmed(text.substr(1, text.size() - 2));
  for (const char decimal : {dialect.decimal, other}) {
    if (decimal == dialect.delimiter && !quoted) continue;
    StatedValue stated;
    const char* const last = text.data() + text.size();
    const char* const end = scan_number(text.data(), last, {decimal, false}, stated.value);
    if (end == text.data() || (end != last && (*end == '.' || *end == ','))) continue;
    stated.unit = trimmed(std::string_view(end, static_cast<std::size_t>(last - end)));
    return stated;
  }
  return std::nullopt;
}

/// "51.200" where commas are decimal marks, "51,200" where points are: 51200 or 51.2.
bool is_ambiguous(std::string_view text, Dialect dialect) {
  const bool quoted = text.starts_with('"');
  text.remove_prefix(quoted ? 1 : 0);
  const char other = dialect.decimal == ',' ? '.' : ',';
  if (other == dialect.delimiter && !quoted) return false;  // it ends the cell
  const std::string_view number = text.substr(0, text.find_first_not_of("+-0123456789.,"));
  return number.find(other) != number.npos && has_thousands_separators(number);
}

/// True for a word of `words` in any case, with blanks or lines between its parts.
template <std::size_t N>
bool is_one_of(std::string_view key, const std::array<std::string_view, N>& words) {
  std::string word = lowered(key);
  std::ranges::replace(word, '_', ' ');
  return std::ranges::find(words, word) != words.end();
}

/// "kHz" for "kS/s", "kSa/s", "ksps" and "k samples/s".
std::string rate_unit(std::string_view unit) {
  constexpr std::array<std::string_view, 8> per_second = {
      "samples/s", "Samples/s", "samples/sec", "Samples/sec", "Sa/s", "S/s", "sps", "SPS"};
  for (const std::string_view word : per_second) {
    if (!unit.ends_with(word)) continue;
    const std::string_view prefix = trimmed(unit.substr(0, unit.size() - word.size()));
    if (prefix.empty() || prefix == "k" || prefix == "M" || prefix == "G")
      return std::string(prefix) + "Hz";
  }
  return std::string(unit);
}

/// The value of a key, or that of all columns where it is the same.
std::string_view value_of_all(std::string_view text, Dialect dialect) {
  auto cells = values_of_key(text, dialect.delimiter);
  std::erase(cells, std::string_view());
  const bool same = cells.size() > 1 && std::ranges::count(cells, cells.front()) ==
                                            static_cast<std::ptrdiff_t>(cells.size());
  // "Analog:2e-8,Digital:0"
  return same || text.starts_with("Analog:") ? cells.front() : text;
}

/// Warns where an interval is printed with a fixed number of decimals, as by OWON ("0.08uS") and
/// SignalExpress (dt in whole microseconds), and these leave it open by more than 1 %.
void tell_of_few_digits(const std::string& key, std::string_view text, TableHead& head) {
  const bool fixed = is_one_of(key, std::to_array<std::string_view>({"time interval"})) ||
                     (key == "dt" && head.attributes.contains("start times"));
  const std::string_view digits = text.substr(0, text.find_first_not_of("0123456789.,"));
  const std::size_t mark = digits.find_first_of(".,");
  if (!fixed || mark == digits.npos) return;
  std::string whole(digits);
  whole.erase(mark, 1);
  const auto units = integer_in(whole);  // of the last decimal
  constexpr long enough = 50;
  if (!units || *units <= 0 || *units >= enough) return;
  head.warnings.push_back(
      fmt::format("the header states '{}' as '{}', whose decimals leave it open by {:.0f} %: "
                  "--sample-rate states the rate",
                  key, text, 50.0 / static_cast<double>(*units)));
}

/// The time of the first sample, as Infiniium (XOrg), Yokogawa (HOffset) and Rigol (t0)
/// oscilloscopes state it.
void find_start(Dialect dialect, TableHead& head) {
  constexpr auto starts = std::to_array<std::string_view>(
      {"xorg", "x origin", "hoffset", "t0", "xstart", "x start", "x-axis first offset"});
  for (const auto& [key, text] : head.attributes) {
    if (head.start || !is_one_of(key, starts)) continue;
    const auto stated = stated_value(value_of_all(text, dialect), dialect);
    const auto seconds =
        datasets::conversion(stated && !stated->unit.empty() ? to_utf8(stated->unit) : "s", "s");
    if (stated && seconds) head.start = seconds->factor * stated->value;
  }
}

/// What a recorder kept from before its trigger, where the head states an interval and no start:
/// "Pretrigger samples" as a number, "Pre-trigger (ms)" as a time.
void find_pretrigger(Dialect dialect, TableHead& head) {
  constexpr auto counts = std::to_array<std::string_view>(
      {"pretrigger samples", "pre trigger samples", "pretrigger points", "pre trigger points",
       "samples before trigger", "trigger sample", "trigger index", "vortrigger samples"});
  constexpr auto times =
      std::to_array<std::string_view>({"pretrigger", "pre trigger", "pretrigger time",
                                       "pre trigger time", "vortrigger", "pretrigger duration"});
  for (const auto& [key, text] : head.attributes) {
    if (head.start || !head.interval) return;
    const ColumnHead says = split_head(key);
    std::string name = says.name;
    std::ranges::replace(name, '-', ' ');
    const auto stated = stated_value(value_of_all(text, dialect), dialect);
    if (!stated || is_ambiguous(text, dialect)) continue;
    const std::string unit =
        unit_of_times(stated->unit.empty() ? says.unit : to_utf8(stated->unit));
    const auto seconds = datasets::conversion(unit, "s");
    if (is_one_of(name, counts) && unit.empty() && stated->value >= 0.0)
      head.start = -stated->value * *head.interval;
    else if (is_one_of(name, times) && seconds && !unit.empty())
      head.start = -std::abs(seconds->factor * stated->value);
  }
}

/// The unit in a cell of its own behind a number, "2e-6,s", which is taken off `text`; "" where
/// there is none.
std::string take_unit_beside(Dialect dialect, std::string_view& text) {
  const auto is_number = [dialect](std::string_view cell) {
    return number_in(cell, {dialect.decimal, false}).has_value();
  };
  // above one column the table's own may be another
  for (const char delimiter : {dialect.delimiter, ';', ','}) {
    auto cells = values_of_key(text, delimiter);
    while (!cells.empty() && cells.back().empty()) cells.pop_back();
    if (delimiter == dialect.decimal || cells.size() != 2 || cells[1].empty() ||
        !is_number(cells[0]) || detail::is_digit(cells[1].front()))
      continue;
    text = cells[0];
    return std::string(cells[1]);
  }
  return {};
}

/// What the head states as the unit of times by a key of its own.
std::string horizontal_unit(const TableHead& head) {
  for (const auto& [key, value] : head.attributes) {
    if (!is_horizontal_unit_key(key)) continue;
    std::string unit = unit_of_times(value);
    if (datasets::quantity_of_unit(unit) == datasets::Quantity::time) return unit;
  }
  return {};
}

/// The sample interval that a key states, itself or by a rate [s]; none where it cannot be used,
/// which a warning or the head's `unusable_clock` says.
std::optional<double> stated_interval(const std::string& key, const std::string& text,
                                      const std::string& unit_of_key, bool is_interval,
                                      Dialect dialect, TableHead& head) {
  std::string_view one = value_of_all(text, dialect);
  const std::string beside = take_unit_beside(dialect, one);
  if (is_ambiguous(one, dialect)) {
    head.warnings.push_back(
        fmt::format("the header states '{}' as '{}', whose point may be a decimal mark or divide "
                    "thousands: it is not used (--sample-rate states it)",
                    key, text));
    return std::nullopt;
  }
  const auto stated = stated_value(without_channel(one), dialect);
  if (is_interval && stated) tell_of_few_digits(key, one, head);
  const std::string_view si = is_interval ? "s" : "Hz";
  std::string unit = !stated || stated->unit.empty() ? unit_of_key : std::string(stated->unit);
  if (unit.empty()) unit = beside;
  // Siglent's horizontal unit is that of its scale, beside intervals as "CH1:0.000002"
  const bool of_channel = without_channel(one).size() < one.size();
  if (unit.empty() && is_interval && !of_channel) unit = horizontal_unit(head);
  if (!is_interval && (unit == "k" || unit == "M")) unit += "Hz";
  unit = unit.empty() ? std::string(si) : is_interval ? unit_of_times(unit) : rate_unit(unit);
  const auto conversion = datasets::conversion(unit, si);
  if (stated && stated->value <= 0.0) {
    head.unusable_clock = fmt::format("'{}' as '{}'", key, text);
    return std::nullopt;
  }
  if (!stated || !(stated->value > 0.0) || !conversion) {
    head.warnings.push_back(
        fmt::format("the header states '{}' as '{}', which is not understood: it is not used "
                    "(--sample-rate states it)",
                    key, text));
    return std::nullopt;
  }
  const double converted = conversion->factor * stated->value + conversion->offset;
  return is_interval ? converted : 1.0 / converted;
}

/// "Rate,50000,Hz": a rate is one of samples where its unit says so and nothing else states one.
void find_rate_by_unit(Dialect dialect, TableHead& head) {
  if (head.interval) return;
  for (const auto& [key, text] : head.attributes) {
    const ColumnHead says = split_head(key);
    if (lowered(says.name) != "rate") continue;
    std::string_view one = value_of_all(text, dialect);
    const std::string beside = take_unit_beside(dialect, one);
    const auto stated = stated_value(one, dialect);
    if (!stated || !(stated->value > 0.0) || is_ambiguous(one, dialect)) continue;
    const std::string unit = rate_unit(!stated->unit.empty() ? to_utf8(stated->unit)
                                       : !says.unit.empty()  ? says.unit
                                                             : beside);
    const auto hertz = datasets::conversion(unit, "Hz");
    if (unit.ends_with("Hz") && hertz) head.interval = 1.0 / (hertz->factor * stated->value);
  }
}

/// "#CLOCK=10.0uS", as Hantek's oscilloscopes state the interval: a clock of another kind is no
/// time with a unit.
bool states_clock(std::string_view key, std::string_view text, Dialect dialect) {
  const auto stated = stated_value(text, dialect);
  return lowered(key) == "clock" && stated && stated->value > 0.0 &&
         datasets::quantity_of_unit(unit_of_times(stated->unit)) == datasets::Quantity::time;
}

constexpr auto interval_keys = std::to_array<std::string_view>({"sample interval",
                                                                "sampling interval",
                                                                "time interval",
                                                                "sample period",
                                                                "sampling period",
                                                                "delta t",
                                                                "delta x",
                                                                "dt",
                                                                "time increment",
                                                                "time step",
                                                                "timestep",
                                                                "abtastintervall",
                                                                "xinc",
                                                                "hresolution",
                                                                "sampling cycle",
                                                                "x-axis delta",
                                                                "cycle time",
                                                                "tinc",
                                                                "interval",
                                                                "采样间隔",
                                                                "采样周期",
                                                                "サンプリング周期",
                                                                "サンプリング間隔",
                                                                "период дискретизации",
                                                                "Период дискретизации"});

constexpr auto rate_keys = std::to_array<std::string_view>({"sample rate",
                                                            "sampling rate",
                                                            "samplerate",
                                                            "sample frequency",
                                                            "sampling frequency",
                                                            "samplingrate",
                                                            "fs",
                                                            "samplefrequency",
                                                            "samplingfrequency",
                                                            "acquisition rate",
                                                            "scan rate",
                                                            "scanrate",
                                                            "samples per second",
                                                            "abtastrate",
                                                            "abtastfrequenz",
                                                            "fréquence d'échantillonnage",
                                                            "fréquence d’échantillonnage",
                                                            "frequence d'echantillonnage",
                                                            "frequenza di campionamento",
                                                            "frecuencia de muestreo",
                                                            "采样率",
                                                            "采样频率",
                                                            "サンプリング周波数",
                                                            "частота дискретизации",
                                                            "Частота дискретизации"});

/// The interval that the keys of the head state, or the inverse of a rate; of several the first.
void take_stated_intervals(Dialect dialect, TableHead& head) {
  std::string stated_by;
  for (const auto& [key, text] : head.attributes) {
    const ColumnHead says = split_head(key);
    const bool is_interval =
        is_one_of(says.name, interval_keys) || states_clock(key, text, dialect);
    if (!is_interval && !is_one_of(says.name, rate_keys)) continue;
    const auto seconds = stated_interval(key, text, says.unit, is_interval, dialect, head);
    if (!seconds) continue;
    if (!head.interval) {
      head.interval = seconds;
      stated_by = key;
    } else if (std::abs(*seconds - *head.interval) > 1e-3 * *head.interval) {
      head.warnings.push_back(
          fmt::format("the header states a sample interval of {:.9g} s by '{}' and one of {:.9g} s "
                      "by '{}': the first is used",
                      *head.interval, stated_by, *seconds, key));
    }
  }
}

/// When the recording began, as a key states it or one for the day and one for the time; "" of
/// dates that may be two.
void find_date(TableHead& head) {
  constexpr auto keys = std::to_array<std::string_view>({"date time",
                                                         "datetime",
                                                         "date/time",
                                                         "date and time",
                                                         "start time",
                                                         "starttime",
                                                         "start date",
                                                         "date",
                                                         "recorded",
                                                         "timestamp",
                                                         "test date",
                                                         "acquired",
                                                         "acquisition date",
                                                         "measurement date",
                                                         "datum",
                                                         "datum/zeit",
                                                         "startzeit",
                                                         "startdatum",
                                                         "messbeginn",
                                                         "messdatum",
                                                         "t0",
                                                         "\u8a66\u9a13\u65e5\u6642",
                                                         "\u6e2c\u5b9a\u65e5\u6642"});
  const auto take = [&head](std::string_view text) {
    const auto date = date_time_in(text);
    if (head.started.empty() && date && date->has_date && date->has_time)
      head.started = date->iso();
  };
  for (const auto& [key, text] : head.attributes)
    if (is_one_of(key, keys) || lowered(key).starts_with("t0 - ")) take(text);
  constexpr auto pairs = std::to_array<std::pair<std::string_view, std::string_view>>(
      {{"date", "time"},
       {"start date", "start time"},
       {"acquisition date", "acquisition time"},
       {"test date", "test time"},
       {"datum", "uhrzeit"},
       {"datum", "zeit"},
       {"startdatum", "startzeit"}});
  const auto value_of = [&head](std::string_view wanted) {
    const auto found = std::ranges::find_if(head.attributes, [wanted](const auto& attribute) {
      return normalized_key(attribute.first) == wanted;
    });
    return found == head.attributes.end() ? std::string() : found->second;
  };
  for (const auto& [day, time] : pairs)
    if (const std::string of_day = value_of(day), of_time = value_of(time);
        !of_day.empty() && !of_time.empty())
      take(of_day + ' ' + of_time);
}

}  // namespace

std::vector<std::string_view> values_of_key(std::string_view text, char delimiter) {
  return cells_of(text, delimiter == '\t' ? ' ' : delimiter);
}

std::string normalized_key(std::string_view key) {
  std::string word = lowered(trimmed(key));
  while (!word.empty() && std::string_view(":= \t").find(word.back()) != std::string_view::npos)
    word.pop_back();
  std::ranges::replace_if(
      word, [](char c) { return c == '_' || c == '-'; }, ' ');
  return word;
}

bool is_horizontal_unit_key(std::string_view key) {
  constexpr auto words =
      std::to_array<std::string_view>({"horizontal units", "horizontal unit", "x units", "x unit",
                                       "xunits", "xunit", "hunit", "x axis unit", "x axis units"});
  return std::ranges::find(words, normalized_key(key)) != words.end();
}

bool is_vertical_unit_key(std::string_view key) {
  constexpr auto words = std::to_array<std::string_view>(
      {"vertical units", "vertical unit", "vert units", "y units", "y unit", "yunits", "yunit",
       "vunit", "unitname", "y axis unit", "y axis units", "amplitudeunit"});
  return std::ranges::find(words, normalized_key(key)) != words.end();
}

std::string unit_of_times(std::string_view unit) {
  const auto is_time = [](const std::string& text) {
    return datasets::quantity_of_unit(text) == datasets::Quantity::time;
  };
  std::string small = lowered(unit);
  return is_time(std::string(unit)) || !is_time(small) ? std::string(unit) : small;
}

void find_interval(Dialect dialect, TableHead& head) {
  take_stated_intervals(dialect, head);
  find_rate_by_unit(dialect, head);
  find_start(dialect, head);
  find_pretrigger(dialect, head);
  find_date(head);
}

void take_keys_among_names(std::vector<std::string_view>& names, TableHead& head) {
  while (!names.empty()) {
    const std::size_t equals = names.back().find('=');
    if (equals == 0 || equals == names.back().npos) return;
    const std::string_view value = trimmed(names.back().substr(equals + 1));
    double number = 0.0;
    if (scan_number(value.data(), value.data() + value.size(), {'.', false}, number) ==
        value.data())
      return;
    head.attributes[to_utf8(trimmed(names.back().substr(0, equals)))] = to_utf8(value);
    names.pop_back();
  }
}

namespace {

/// "Force" and "Vel" of "waveform	Force	Vel" over "time	Y[0]	Y[1]", as LabVIEW exports
/// waveforms to spreadsheets.
void take_names_of_waveforms(const TableLayout& layout, TableHead& head) {
  const auto names_nothing = [](const ColumnHead& column) {
    return column.name == "Y" || column.name.starts_with("Y[");
  };
  const auto waveform = head.attributes.find("waveform");
  if (waveform == head.attributes.end() || head.columns.size() < 2 ||
      !std::all_of(head.columns.begin() + 1, head.columns.end(), names_nothing))
    return;
  const auto names = values_of_key(waveform->second, layout.dialect.delimiter);
  const bool numbers =
      std::ranges::any_of(names, [](std::string_view name) { return name.starts_with('['); });
  if (names.size() + 1 != head.columns.size() || numbers) return;
  for (std::size_t i = 0; i < names.size(); ++i) head.columns[i + 1] = split_head(names[i]);
}

}  // namespace

void take_names_of_keys(const TableLayout& layout, TableHead& head) {
  take_names_of_waveforms(layout, head);
  if (layout.cells == 1 && !layout.head.empty() &&
      layout.head.front().starts_with("# Created by Octave") &&
      (head.columns.empty() || head.columns.front().name.empty()))
    if (const auto name = head.attributes.find("name"); name != head.attributes.end())
      head.columns = {split_head(name->second)};
  // the last ones may be of the recording where there is one channel
  constexpr std::array<std::string_view, 13> keys = {
      "tracename",    "trace name",   "channel name", "channel names", "signal name",
      "signal names", "channeltitle", "name",         "names",         "label",
      "labels",       "channel",      "channels"};
  constexpr std::size_t sure = 7;
  if (!head.columns.empty()) return;
  for (std::size_t k = 0; k < keys.size(); ++k)
    for (const auto& [key, text] : head.attributes) {
      if (lowered(key) != keys[k]) continue;
      const auto names = values_of_key(text, layout.dialect.delimiter);
      if (names.size() != layout.cells && names.size() + 1 != layout.cells) continue;
      if (k >= sure && names.size() < 2) continue;
      head.columns.resize(layout.cells - names.size());
      for (const std::string_view name : names) {
        head.columns.push_back(split_head(name));
        if (integer_in(name)) head.columns.back().name = fmt::format("CH {}", name);
      }
      return;
    }
}

std::optional<AnnouncedSamples> announced_samples(const TableHead& head, Dialect dialect) {
  constexpr auto keys = std::to_array<std::string_view>(
      {"record length", "recordlength", "blocksize", "block size", "points", "size", "data length",
       "number of samples", "number of points", "no. of samples", "sample count", "samplecount",
       "num points", "npts"});
  for (const auto& [key, text] : head.attributes) {
    const std::string word = normalized_key(key);
    // beside a clock they are those of the recording
    if ((word == "size" || word == "points") && !head.interval) continue;
    if (std::ranges::find(keys, word) != keys.end()) {
      const auto cells = values_of_key(text, dialect.delimiter);
      if (cells.empty()) continue;
      const auto count = integer_in(without_channel(cells.front()));
      if (count && *count > 0) return AnnouncedSamples{key, static_cast<std::uint64_t>(*count)};
    }
    if (key != "Segments") continue;  // of LeCroy, "1,SegmentSize,400"
    const auto cells = values_of_key(text, dialect.delimiter);
    if (cells.size() < 3 || cells[1] != "SegmentSize") continue;
    const auto segments = integer_in(cells[0]), size = integer_in(cells[2]);
    if (segments && size && *segments == 1 && *size > 0)
      return AnnouncedSamples{"SegmentSize", static_cast<std::uint64_t>(*size)};
  }
  return std::nullopt;
}

std::string missing_rows(const std::optional<AnnouncedSamples>& announced, std::uint64_t rows) {
  if (!announced || rows >= announced->count) return {};
  return fmt::format(
      "the header announces {} samples by '{}', {} rows are there: the file may be "
      "cut off",
      announced->count, announced->key, rows);
}

void take_column_of_keys(Dialect dialect, TableHead& head) {
  ColumnHead column;
  for (const auto& [key, value] : head.attributes) {
    if (value == "NOVALUE") continue;  // of ISO 13499
    const std::string word = lowered(key);
    if (word == "name of the channel" || word == "channel name") column.name = value;
    if (word == "channel" && column.name.empty()) column.name = value;
    if (word == "unit" || word == "units" || word == "y units" || word == "yunits")
      column.unit = value;
    if (word != "time of first sample") continue;
    const auto stated = stated_value(value, dialect);
    const auto seconds =
        datasets::conversion(stated && !stated->unit.empty() ? to_utf8(stated->unit) : "s", "s");
    if (stated && seconds && !is_ambiguous(value, dialect))
      head.start = seconds->factor * stated->value;
    else
      head.warnings.push_back(fmt::format(
          "the header states '{}' as '{}', which is not understood: it is not used", key, value));
  }
  if (column.name.empty()) {
    const auto code = head.attributes.find("Channel code");
    if (code != head.attributes.end() && code->second != "NOVALUE") column.name = code->second;
  }
  head.columns = {column};
}

}  // namespace impactrig::acquisition
