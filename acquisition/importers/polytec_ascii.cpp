// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "acquisition/importers/column_heads.hpp"
#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/text_table.hpp"
#include "acquisition/importers/time_axis.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::InputError;
using datasets::Quantity;
using datasets::Record;
using datasets::SourcePosition;

namespace {

/// "Time - Vib Velocity - Samples".
struct Signal {
  std::string domain;   ///< "Time", "FFT"
  std::string channel;  ///< "Vib Velocity", "Ref1 Voltage"
  std::string display;  ///< "Samples", "Magnitude"
};

Signal split_signal(std::string_view text) {
  Signal signal;
  const std::size_t first = text.find(" - ");
  const std::size_t last = text.rfind(" - ");
  if (first == std::string_view::npos) {
    signal.channel = to_utf8(trimmed(text));
    return signal;
  }
  signal.domain = to_utf8(trimmed(text.substr(0, first)));
  if (last == first) {
    signal.channel = to_utf8(trimmed(text.substr(first + 3)));
    return signal;
  }
  signal.channel = to_utf8(trimmed(text.substr(first + 3, last - first - 3)));
  signal.display = to_utf8(trimmed(text.substr(last + 3)));
  return signal;
}

/// The quantity named in "Vib 3D Velocity".
Quantity quantity_in_words(std::string_view text) {
  const std::string words = lowered(text);
  for (const Quantity quantity :
       {Quantity::velocity, Quantity::displacement, Quantity::acceleration, Quantity::voltage,
        Quantity::force, Quantity::pressure})
    if (words.find(datasets::name(quantity)) != std::string::npos) return quantity;
  return Quantity::unknown;
}

/// True for "[ s ]\t[ m/s ]".
bool is_unit_line(std::string_view line) {
  const auto cells = cells_of(line, '\t');
  return cells.size() > 1 && std::all_of(cells.begin(), cells.end(), [](std::string_view cell) {
           return cell.size() >= 2 && cell.front() == '[' && cell.back() == ']';
         });
}

/// The head of such a file: keys, then an empty line or not, then names and units.
struct PolytecHead {
  TableLayout layout;
  std::vector<ColumnHead> columns;
  std::map<std::string, std::string> keys;
};

/// German decimal commas, when a row has a comma and no point.
char decimal_of(const char* at, const char* end) {
  for (int row = 0; row < 20 && at != end; ++row) {
    const std::string_view line = take_line(at, end);
    if (line.find('.') != std::string_view::npos) return '.';
    if (line.find(',') != std::string_view::npos) return ',';
  }
  return '.';
}

PolytecHead read_polytec_head(TextFile& file, const ImportOptions& options) {
  constexpr int most_lines = 64;  // exports have five or seven
  PolytecHead head;
  const std::string_view text = file.text();
  const char* at = text.data();
  const char* const end = at + text.size();
  std::string_view names;
  for (int number = 0; number < most_lines && at != end; ++number) {
    const std::string_view line = take_line(at, end);
    if (trimmed(line).empty()) continue;
    if (is_unit_line(line)) {
      const auto name_cells = cells_of(names, '\t');
      const auto unit_cells = cells_of(line, '\t');
      for (std::size_t c = 0; c < unit_cells.size(); ++c) {
        ColumnHead column;
        column.name = c < name_cells.size() && !name_cells[c].empty() ? to_utf8(name_cells[c])
                                                                      : fmt::format("column {}", c);
        column.unit = to_utf8(trimmed(unit_cells[c].substr(1, unit_cells[c].size() - 2)));
        head.columns.push_back(std::move(column));
      }
      head.layout.dialect = {options.delimiter.value_or('\t'),
                             options.decimal.value_or(decimal_of(at, end))};
      head.layout.data = at;
      head.layout.cells = head.layout.written_cells = unit_cells.size();
      return head;
    }
    const std::size_t colon = line.find(':');
    if (colon != std::string_view::npos && line.find('\t') == colon + 1)
      head.keys[to_utf8(trimmed(line.substr(0, colon)))] = to_utf8(trimmed(line.substr(colon + 1)));
    names = line;
  }
  SourcePosition place;
  place.file = file.path();
  throw InputError(
      place,
      "this is a Polytec text export without its line of units: expected a line such as "
      "'[ s ] [ m/s ]' under the column names");
}

/// What all columns of an export are over.
struct Abscissa {
  std::string name;
  std::string unit;
  std::string domain;           ///< "time", "frequency"
  datasets::SampleClock clock;  ///< in s over time, else in `unit`
  bool over_time = true;
};

Abscissa read_abscissa(const ColumnHead& head, const Signal& signal, std::vector<double>&& x,
                       Record& record) {
  Abscissa abscissa;
  abscissa.name = head.name;
  abscissa.unit = head.unit;
  const auto to_seconds = datasets::conversion(head.unit, "s");
  abscissa.over_time = to_seconds.has_value();
  abscissa.domain = abscissa.over_time       ? "time"
                    : signal.domain == "FFT" ? "frequency"
                                             : lowered(signal.domain);
  if (to_seconds && to_seconds->factor != 1.0)
    for (double& time : x) time *= to_seconds->factor;
  TimeAxis axis = time_axis(std::move(x));
  abscissa.clock = std::move(axis.clock);
  if (!abscissa.over_time) {
    record.warnings.push_back(fmt::format("this is no time record: '{}' over {} [{}]",
                                          signal.channel, head.name, head.unit));
  } else if (!axis.warning.empty()) {
    record.warnings.push_back(std::move(axis.warning));
  }
  return abscissa;
}

void set_domain(const Abscissa& abscissa, Channel& channel) {
  if (abscissa.over_time) {
    channel.attributes["domain"] = "time";
    channel.clock = abscissa.clock;
  } else {
    set_abscissa(channel, abscissa.domain, abscissa.unit, abscissa.clock.start,
                 abscissa.clock.interval);
  }
}

Channel channel_from_column(const ColumnHead& head, Column&& column, const Signal& signal,
                            const Abscissa& abscissa) {
  Channel channel;
  channel.name = head.name;
  channel.unit = head.unit;
  channel.quantity = datasets::quantity_of_unit(channel.unit);
  if (channel.quantity == Quantity::unknown) channel.quantity = quantity_in_words(signal.channel);
  if (!signal.channel.empty()) channel.attributes["signal"] = signal.channel;
  if (!signal.display.empty()) channel.attributes["display"] = signal.display;
  set_domain(abscissa, channel);
  channel.raw = std::move(column.values);
  channel.valid = std::move(column.valid);
  return channel;
}

}  // namespace

int recognises_polytec_ascii(std::string_view, std::string_view head) {
  const char* at = head.data();
  const char* const end = at + head.size();
  bool signal = false;
  for (int number = 0; number < 64 && at != end; ++number) {
    const std::string_view line = take_line(at, end);
    if (line.starts_with("Signal:\t")) signal = true;
    if (signal && is_unit_line(line)) return 100;
  }
  return signal ? 90 : 0;
}

Record read_polytec_ascii(const std::string& path, const ImportOptions& options) {
  TextFile file(path);
  PolytecHead head = read_polytec_head(file, options);
  for (std::size_t c = 0; c < std::min(options.units.size(), head.columns.size()); ++c)
    if (!options.units[c].empty()) head.columns[c].unit = options.units[c];

  std::vector<std::string> names;
  for (const ColumnHead& column : head.columns) names.push_back(column.name);
  Table table = read_table(file, head.layout, names);

  Record record;
  record.attributes = head.keys;
  record.attributes["decimal"] = std::string(1, head.layout.dialect.decimal);
  const Signal signal =
      split_signal(head.keys.count("Signal") > 0 ? head.keys["Signal"] : std::string());
  record.title = signal.channel;
  if (const std::string cut = cut_row(file, table); !cut.empty()) record.warnings.push_back(cut);

  const Abscissa abscissa =
      read_abscissa(head.columns.front(), signal, std::move(table.columns.front().values), record);
  if (!abscissa.over_time && !abscissa.clock.uniform()) {
    Channel channel;  // an uneven abscissa is data of its own
    channel.name = abscissa.name;
    channel.unit = abscissa.unit;
    channel.quantity = datasets::quantity_of_unit(abscissa.unit);
    channel.raw = abscissa.clock.times;
    set_domain(abscissa, channel);
    record.channels.push_back(std::move(channel));
  }
  for (std::size_t c = 1; c < head.columns.size(); ++c) {
    if (table.columns[c].missing > 0)
      record.warnings.push_back(missing_values(file, names[c], table.columns[c], table.rows));
    record.channels.push_back(
        channel_from_column(head.columns[c], std::move(table.columns[c]), signal, abscissa));
  }
  return record;
}

}  // namespace impactrig::acquisition
