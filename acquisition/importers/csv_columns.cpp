// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/csv_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <set>
#include <string_view>

#include "acquisition/importers/column_keys.hpp"
#include "acquisition/importers/header_fields.hpp"
#include "acquisition/importers/row_of_units.hpp"
#include "acquisition/importers/stated_units.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::Record;

namespace {

/// "ms" where a name should be, or one of Arduino's clocks; "" for other names.
std::string_view unit_of_time_alone(std::string_view name) {
  constexpr std::array<std::string_view, 7> units = {"s", "sec", "ms", "msec", "us", "µs", "ns"};
  if (std::ranges::find(units, name) != units.end()) return name;
  return name == "millis" ? "ms" : name == "micros" ? "us" : "";
}

/// The unit and quantity of a channel. A "kg" under an acceleration is the laboratory's kilo-g.
void set_unit(Channel& channel, const ColumnHead& head, Record& record) {
  channel.unit = head.unit;
  const std::string words = lowered(head.name + " " + head.description);
  if (head.unit == "kg" && words.find("accel") != std::string::npos) {
    channel.unit = "kg (kilo-g)";
    channel.attributes["unit in file"] = head.unit;
    const std::string note =
        "the unit 'kg' of an acceleration is read as kilo-g (1000 g); --units states another";
    if (std::find(record.warnings.begin(), record.warnings.end(), note) == record.warnings.end())
      record.warnings.push_back(note);
  }
  channel.quantity = datasets::quantity_of_unit(channel.unit);
  if (!head.description.empty()) channel.attributes["description"] = head.description;
}

/// "quantity of column 2: strain", as our own export says it where the unit does not.
void take_stated_quantity(const TableHead& head, std::size_t column, Channel& channel) {
  const auto found = head.attributes.find(fmt::format("quantity of column {}", column));
  if (found == head.attributes.end()) return;
  channel.quantity = datasets::quantity_named(found->second).value_or(channel.quantity);
}

/// "TEMP", "oil temp 2", "Temperatur": but no "Tempo" and no "Template".
bool is_temperature(std::string_view name) {
  const std::string word = lowered(name);
  const std::size_t at = word.find("temp");
  const bool begins = at == 0 || (at != word.npos && (word[at - 1] < 'a' || word[at - 1] > 'z'));
  const std::string_view rest = begins ? std::string_view(word).substr(at + 4) : "";
  return begins && (rest.empty() || rest.starts_with("erat") || rest[0] < 'a' || rest[0] > 'z');
}

}  // namespace

std::vector<ColumnHead> complete_heads(const TextFile& file, const TableHead& head,
                                       std::size_t columns, const ImportOptions& options) {
  std::vector<ColumnHead> heads = head.columns;
  heads.resize(std::max(heads.size(), columns));
  check_stated_units(options.units, heads.size(), "columns", file.path());
  for (std::size_t c = 0; c < heads.size(); ++c) {
    if (c < options.units.size() && !options.units[c].empty()) heads[c].unit = options.units[c];
    if (heads[c].unit.empty()) heads[c].unit = unit_of_time_alone(heads[c].name);
    // seconds in capitals, as Scopy has them, are no siemens
    const bool capitals = heads[c].unit == "S" || heads[c].unit == "MS" || heads[c].unit == "US";
    if (is_time_name(heads[c].name) && capitals) heads[c].unit = lowered(heads[c].unit);
    if (heads[c].unit == "C" && is_temperature(heads[c].name))
      heads[c].unit = std::string("\u00B0C");
    if (heads[c].name.empty()) heads[c].name = fmt::format("column {}", c);
  }
  return heads;
}

std::string commas_that_may_be_decimal_marks(const TableLayout& layout, const TableHead& head,
                                             std::string_view text) {
  constexpr long rows_tried = 40;
  constexpr long rows_that_count = 4;
  if (layout.dialect.delimiter != ',' || layout.written_cells != 2 || layout.key_cells > 0 ||
      layout.column_numbers || !head.columns.empty())
    return {};
  std::string_view example;
  long rows = 0;
  bool counts = true;  // 0, 1, 2, ...: the samples
  const char* at = layout.data;
  const char* const end = text.data() + text.size();
  for (long first = 0; at != end && rows < rows_tried;) {
    const std::string_view line = trimmed(take_line(at, end));
    if (line.empty() || line.starts_with('#') || line.starts_with('%')) continue;
    const auto cells = cells_of(line, ',');
    const auto number = cells.size() == 2 ? integer_in(cells[0]) : std::nullopt;
    if (!number || cells[1].empty() || !integer_in(cells[1]) ||
        cells[1].find_first_not_of("0123456789") != cells[1].npos)
      return {};
    if (rows == 0) example = line;
    if (rows == 0) first = *number;
    counts = counts && *number == first + rows++;
  }
  if (rows < 2 || (counts && rows >= rows_that_count)) return {};
  return fmt::format(
      "each row is two whole numbers under no names: the comma is taken for the end of a cell "
      "(--decimal , reads '{}' as one number)",
      to_utf8(example.substr(0, 40)));
}

void refuse_long_table(TextFile& file, const TableLayout& layout, std::string_view text,
                       const std::vector<ColumnHead>& heads, const CsvRoles& roles) {
  if (!roles.time || layout.key_cells > 0 || layout.dialect.delimiter == ' ') return;
  constexpr int rows_tried = 200;
  for (const TextColumn& column : layout.text_columns) {
    if (column.example.empty()) continue;
    std::map<std::string_view, int> words;
    std::string_view last_time, last_word;
    int shared = 0, apart = 0;  // neighbours of other words, at one time or at two
    std::set<std::string_view> at_time;
    bool repeated = false;  // a word at one time
    const char* at = layout.data;
    const char* const end = text.data() + text.size();
    for (int row = 0; at != end && row < rows_tried; ++row) {
      const auto cells = cells_of(take_line(at, end), layout.dialect.delimiter);
      if (cells.size() <= std::max(column.column, *roles.time)) continue;
      const std::string_view time = cells[*roles.time], word = cells[column.column];
      if (time != last_time) at_time.clear();
      repeated = !at_time.insert(word).second || repeated;
      if (row > 0 && word != last_word) ++(time == last_time ? shared : apart);
      ++words[word];
      last_time = time;
      last_word = word;
    }
    const bool each_often = std::ranges::all_of(words, [](const auto& w) { return w.second > 1; });
    const auto count = static_cast<int>(words.size());
    // of so many words all but one neighbour a time are at the same one
    if (repeated || count < 2 || !each_often || shared < (count - 1) * apart) continue;
    throw datasets::InputError(
        file.position(layout.data),
        fmt::format("the table has a row for each '{}' ('{}', '{}', ...) at each time: write a "
                    "column for each (in pandas df.pivot), or a file",
                    heads[column.column].name, to_utf8(words.begin()->first.substr(0, 40)),
                    to_utf8(std::next(words.begin())->first.substr(0, 40))));
  }
}

void tell_of_dates_and_text(const TableLayout& layout, const std::vector<ColumnHead>& heads,
                            const CsvRoles& roles, Record& record) {
  for (const TextColumn& column : layout.text_columns)
    if (!column.example.empty())
      record.warnings.push_back(fmt::format("'{}' holds text ('{}'), no numbers: it is left out",
                                            heads[column.column].name,
                                            to_utf8(column.example.substr(0, 40))));
  for (const DateColumns& date : layout.dates) {
    const bool is_time =
        roles.time == date.last ||
        std::ranges::find(roles.further_times, date.last) != roles.further_times.end();
    if (!is_time)
      record.warnings.push_back(
          fmt::format("'{}' holds times of day, and '{}' is the time: it is left out",
                      heads[date.last].name, roles.time ? heads[*roles.time].name : "none"));
    if (record.started.empty()) record.started = date.base.iso();
  }
}

/// "Force" of "Force unit", "Unit of Force" and "force units", in lower case; "" of other keys.
std::string column_of_unit_key(std::string_view key) {
  const std::string word = lowered(key);
  std::string_view name = word;
  for (const std::string_view begin : {"unit of ", "units of ", "unit ", "units "})
    if (name.starts_with(begin)) return std::string(trimmed(name.substr(begin.size())));
  for (const std::string_view end : {" unit", " units", "_unit", "_units"})
    if (name.ends_with(end)) return std::string(trimmed(name.substr(0, name.size() - end.size())));
  return {};
}

/// The unit that a key states of a column by its name: "Force unit: kN", of times "Time unit".
void take_unit_of_name(const std::string& key, std::string_view unit, const CsvRoles& roles,
                       std::vector<ColumnHead>& heads) {
  const std::string name = column_of_unit_key(key);
  if (name.empty() || !is_unit(unit)) return;
  for (std::size_t c = 0; c < heads.size(); ++c) {
    const bool is_time = roles.time == c;
    const bool named = lowered(heads[c].name) == name || (is_time && is_time_name(name));
    if (named && heads[c].unit.empty())
      heads[c].unit = is_time ? unit_of_times(unit) : std::string(unit);
  }
}

void take_units_of_keys(const TableHead& head, const CsvRoles& roles, char delimiter,
                        std::vector<ColumnHead>& heads) {
  std::size_t channels = 0;
  for (std::size_t c = 0; c < heads.size(); ++c) channels += roles.is_channel(c) ? 1 : 0;
  for (const auto& [key, value] : head.attributes) {
    const std::string word = lowered(key);
    const bool vertical = is_vertical_unit_key(key);
    const bool horizontal = is_horizontal_unit_key(key);
    auto units = values_of_key(value, delimiter);
    const bool beside_first =
        vertical && roles.time.value_or(0) == 0 && units.size() + 1 == heads.size();
    if (units.empty() || (delimiter == '\t' && units.size() != channels && !beside_first))
      units = {value};
    const bool are_units = word == "unit" || word == "units";
    if (are_units && units.size() != heads.size()) {
      auto divided = cells_of(value, ',');
      if (divided.size() == heads.size()) units = std::move(divided);
    }
    const bool one_a_column = are_units && heads.size() > channels && units.size() == heads.size();
    const bool one_each = are_units && units.size() == channels;
    take_unit_of_name(key, trimmed(value), roles, heads);
    if (one_a_column)
      for (std::size_t c = 0; c < heads.size(); ++c)
        if (heads[c].unit.empty() && is_unit(units[c]))
          heads[c].unit = roles.time == c ? unit_of_times(units[c]) : std::string(units[c]);
    if (horizontal && roles.time && heads[*roles.time].unit.empty())
      heads[*roles.time].unit = unit_of_times(without_channel(units.front()));
    if (!vertical && !one_each) continue;
    // the key stands over the times, and a further block has a key and times of its own
    const bool by_column = beside_first && units.size() + 1 == heads.size();
    std::size_t channel = 0;
    for (std::size_t c = 0; c < heads.size(); ++c) {
      if (!roles.is_channel(c)) continue;
      const std::size_t at = by_column ? c - 1 : units.size() == 1 ? 0 : channel;
      constexpr std::string_view none = "*";  // of LabChart
      if (heads[c].unit.empty() && at < units.size() && units[at] != none)
        heads[c].unit = without_channel(units[at]);
      ++channel;
    }
  }
}

void describe(const TableLayout& layout, const TableHead& head,
              const std::vector<ColumnHead>& heads, const CsvRoles& roles, Record& record) {
  auto& says = record.attributes;
  const auto line = [](int number) {
    return number > 0 ? fmt::format("line {}", number) : std::string("none");
  };
  says["delimiter"] = delimiter_name(layout.dialect.delimiter);
  says["decimal"] = std::string(1, layout.dialect.decimal);
  says["column names"] = line(head.names_line);
  says["unit row"] = line(head.units_line);
  says["first data line"] = fmt::format("{}", layout.head.size() + 1);
  says["time column"] =
      roles.time ? fmt::format("{} ({})", heads[*roles.time].name, roles.reason) : "none";
  std::string further;
  for (const std::size_t c : roles.further_times)
    further += (further.empty() ? "" : ", ") + heads[c].name;
  if (!further.empty()) says["further time columns"] = further;
  if (roles.index) says["index column"] = heads[*roles.index].name;
}

Channel channel_of(const TableHead& head, std::size_t column, const ColumnHead& says,
                   Record& record) {
  Channel channel;
  channel.name = says.name;
  set_unit(channel, says, record);
  take_stated_quantity(head, column, channel);
  channel.scale = head.level;
  set_attribute(channel, unusable_clock, head.unusable_clock);
  return channel;
}

}  // namespace impactrig::acquisition
