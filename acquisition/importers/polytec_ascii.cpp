// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "acquisition/importers/column_heads.hpp"
#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/large_table.hpp"
#include "acquisition/importers/stated_units.hpp"
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

/// Without tabs behind its last cell.
std::string_view without_last_tabs(std::string_view line) {
  return line.substr(0, line.find_last_not_of("\t \r") + 1);
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
    if (is_unit_line(without_last_tabs(line))) {
      const auto name_cells = cells_of(names, '\t');
      const auto unit_cells = cells_of(without_last_tabs(line), '\t');
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
      head.layout.cells = unit_cells.size();
      head.layout.written_cells = cells_of(line, '\t').size();
      if (!file.is_part()) find_cut_row(text, head.layout);
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
  double factor = 1.0;  ///< makes seconds of times
};

/// What the head says of the abscissa: all but its clock.
Abscissa abscissa_of(const ColumnHead& head, const Signal& signal, Record& record) {
  Abscissa abscissa;
  abscissa.name = head.name;
  abscissa.unit = head.unit;
  const auto to_seconds = datasets::conversion(head.unit, "s");
  abscissa.over_time = to_seconds.has_value();
  if (to_seconds) abscissa.factor = to_seconds->factor;
  abscissa.domain = abscissa.over_time       ? "time"
                    : signal.domain == "FFT" ? "frequency"
                                             : lowered(signal.domain);
  if (!abscissa.over_time)
    record.warnings.push_back(fmt::format("this is no time record: '{}' over {} [{}]",
                                          signal.channel, head.name, head.unit));
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

/// A channel without samples.
Channel channel_of(const ColumnHead& head, const Signal& signal, const Abscissa& abscissa) {
  Channel channel;
  channel.name = head.name;
  channel.unit = head.unit;
  channel.quantity = datasets::quantity_of_unit(channel.unit);
  if (channel.quantity == Quantity::unknown) channel.quantity = quantity_in_words(signal.channel);
  if (!signal.channel.empty()) channel.attributes["signal"] = signal.channel;
  if (!signal.display.empty()) channel.attributes["display"] = signal.display;
  set_domain(abscissa, channel);
  return channel;
}

/// An uneven abscissa that is no time is data of its own.
Channel channel_of(const Abscissa& abscissa) {
  Channel channel;
  channel.name = abscissa.name;
  channel.unit = abscissa.unit;
  channel.quantity = datasets::quantity_of_unit(abscissa.unit);
  set_domain(abscissa, channel);
  return channel;
}

/// A file whose head has been read.
struct PolytecText {
  PolytecText(const std::string& path, const ImportOptions& options)
      : file(path, options.head_only, options.encoding),
        head(read_polytec_head(file, options)) {
    check_stated_units(options.units, head.columns.size(), "columns", path);
    for (std::size_t c = 0; c < options.units.size(); ++c)
      if (!options.units[c].empty()) head.columns[c].unit = options.units[c];
    for (const ColumnHead& column : head.columns) names.push_back(column.name);
    const auto found = head.keys.find("Signal");
    if (found != head.keys.end()) signal = split_signal(found->second);
    record.attributes = head.keys;
    record.attributes["decimal"] = std::string(1, head.layout.dialect.decimal);
    record.title = signal.channel;
  }

  TextFile file;
  PolytecHead head;
  std::vector<std::string> names;
  Signal signal;
  Record record;  ///< without channels
};

void tell_cut_number(PolytecText& text, Record& record) {
  if (std::string cut = cut_number(text.file, text.head.layout); !cut.empty())
    record.warnings.push_back(std::move(cut));
}

Record read_whole(PolytecText& text) {
  Table table = read_table(text.file, text.head.layout, text.names);
  Record record = text.record;
  if (const std::string cut = cut_row(text.file, table); !cut.empty())
    record.warnings.push_back(cut);
  tell_cut_number(text, record);
  const auto& columns = text.head.columns;
  Abscissa abscissa = abscissa_of(columns.front(), text.signal, record);
  std::vector<double>& x = table.columns.front().values;
  if (abscissa.factor != 1.0)
    for (double& time : x) time *= abscissa.factor;
  TimeAxis axis = time_axis(std::move(x));
  abscissa.clock = std::move(axis.clock);
  if (abscissa.over_time && !axis.warning.empty())
    record.warnings.push_back(std::move(axis.warning));
  if (!abscissa.over_time && !abscissa.clock.uniform()) {
    record.channels.push_back(channel_of(abscissa));
    record.channels.back().raw = abscissa.clock.times;
  }
  for (std::size_t c = 1; c < columns.size(); ++c) {
    Column& column = table.columns[c];
    if (column.missing > 0)
      record.warnings.push_back(missing_values(text.file, text.names[c], column, table.rows));
    record.channels.push_back(channel_of(columns[c], text.signal, abscissa));
    record.channels.back().raw = std::move(column.values);
    record.channels.back().valid = std::move(column.valid);
  }
  return record;
}

/// Looks at the first column of a large file: whether it is even, and from where on. For a head
/// alone the first rows tell.
bool read_abscissa(PolytecText& text, const Table& first_rows, bool head_only, Abscissa& abscissa) {
  constexpr std::size_t rows_at_once = 16384;
  TimeAxisCheck check(0.0, 0.0, 0);
  const std::vector<double>& first = first_rows.columns.front().values;
  for (int round = 0; round < 2; ++round) {  // first the ends, then what lies between
    if (round > 0) check = TimeAxisCheck(check.first(), check.last(), check.samples());
    RowReader rows(text.file, text.head.layout, text.names);
    std::vector<bool> needed(text.names.size(), false);
    needed.front() = true;
    rows.read_only(needed);
    if (head_only) check.add(first);
    while (!head_only && !rows.at_end()) {
      const char* const start = rows.at();
      check.add(rows.read(rows_at_once).columns.front().values);
      text.file.release(start, rows.at());
    }
  }
  abscissa.clock = check.axis().clock;
  return check.uniform();
}

std::unique_ptr<RecordingReader> open_large(std::shared_ptr<PolytecText> text, bool head_only) {
  LargeTable table;
  table.file = std::shared_ptr<TextFile>(text, &text->file);
  table.record = text->record;
  table.layout = text->head.layout;
  table.names = text->names;
  const auto& columns = text->head.columns;
  Abscissa abscissa = abscissa_of(columns.front(), text->signal, table.record);
  tell_cut_number(*text, table.record);
  table.read_first_rows(head_only);
  if (abscissa.over_time) {
    table.time = 0;
    table.to_seconds = [factor = abscissa.factor](Column& times) {
      if (factor != 1.0)
        for (double& time : times.values) time *= factor;
    };
  } else if (!read_abscissa(*text, table.first_rows, head_only, abscissa)) {
    table.record.channels.push_back(channel_of(abscissa));
    table.columns.push_back(0);
  }
  for (std::size_t c = 1; c < columns.size(); ++c) {
    table.record.channels.push_back(channel_of(columns[c], text->signal, abscissa));
    table.columns.push_back(c);
  }
  auto reader = reader_of_large_table(std::move(table));
  return head_only ? reader_of_head(reader->head()) : std::move(reader);
}

}  // namespace

int recognises_polytec_ascii(std::string_view, std::string_view head) {
  const char* at = head.data();
  const char* const end = at + head.size();
  bool signal = false;
  for (int number = 0; number < 64 && at != end; ++number) {
    const std::string_view line = take_line(at, end);
    if (line.starts_with("Signal:\t")) signal = true;
    if (lowered(line.substr(0, 13)) == "x-axis delta:") return 0;  // of PULSE
    if (signal && is_unit_line(line)) return 100;
  }
  return signal ? 90 : 0;
}

std::unique_ptr<RecordingReader> open_polytec_ascii(const std::string& path,
                                                    const ImportOptions& options) {
  auto text = std::make_shared<PolytecText>(path, options);
  const std::string_view all = text->file.bytes();
  if (all.size() > read_at_once) return open_large(std::move(text), options.head_only);
  return reader_of(read_whole(*text));
}

std::unique_ptr<RecordingReader> open_polytec_ascii_by_blocks(const std::string& path,
                                                              const ImportOptions& options) {
  return open_large(std::make_shared<PolytecText>(path, options), options.head_only);
}

}  // namespace impactrig::acquisition
