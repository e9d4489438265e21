// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/instrument_heads.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "acquisition/importers/column_keys.hpp"
#include "acquisition/importers/date_time.hpp"
#include "acquisition/importers/number.hpp"
#include "acquisition/importers/text_file.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

namespace {

using Cells = std::vector<std::string_view>;

/// The word of a line that is a key without a value, "start times: "; "" for others.
std::string lone_key(std::string_view line) {
  const std::string_view text = trimmed(line);
  return text.ends_with(':') && text.find(':') + 1 == text.size()
             ? lowered(trimmed(text.substr(0, text.size() - 1)))
             : std::string();
}

/// When the channels began, in the order of the channels.
void take_start_times(const Cells& times, TableHead& head) {
  const auto first = times.empty() ? std::nullopt : date_time_in(times.front());
  if (first) head.started = first->iso();
  if (std::ranges::count(times, times.front()) != static_cast<std::ptrdiff_t>(times.size()))
    head.warnings.emplace_back(
        "the channels begin at different times by 'start times': all are taken to begin with the "
        "first row");
}

/// Unit and signal of each input, as the settings of a Graphtec amplifier state them:
/// "CH3,hammer,DC,50V,Off,25,-25,[N]" under "CH,Signal name,Input,Range,Filter,Span,,Unit".
void take_amplifier_settings(const TableLayout& layout, const std::vector<std::size_t>& filled,
                             TableHead& head) {
  std::size_t unit_at = 0;
  for (const std::size_t line : filled) {
    const Cells cells = cells_of(layout.head[line], layout.dialect.delimiter);
    if (cells.front() == "CH") {
      const auto unit = std::ranges::find_if(
          cells, [](auto cell) { return cell == "Unit" || cell == "\u5358\u4F4D"; });
      unit_at = unit == cells.end() ? 0 : static_cast<std::size_t>(unit - cells.begin());
      continue;
    }
    const auto column = std::ranges::find(head.columns, cells.front(), &ColumnHead::name);
    if (unit_at == 0 || unit_at >= cells.size() || cells.front().empty() ||
        column == head.columns.end())
      continue;
    std::string_view unit = cells[unit_at];
    if (unit.starts_with('[') && unit.ends_with(']')) unit = unit.substr(1, unit.size() - 2);
    if (column->unit.empty()) column->unit = to_utf8(trimmed(unit));
    column->description = to_utf8(cells[1]);
  }
}

using Keys = std::map<std::string, std::string>;

/// The keys and values in the cells from `column` on.
Keys keys_at(const TableLayout& layout, std::size_t column) {
  Keys keys;
  for (const std::string_view line : layout.key_lines) {
    const Cells cells = cells_of(line, layout.dialect.delimiter);
    if (column + 1 < cells.size() && !cells[column].empty() && !cells[column + 1].empty())
      keys[to_utf8(cells[column])] = to_utf8(cells[column + 1]);
  }
  return keys;
}

std::string value_of(const Keys& keys, const std::string& key, std::string_view otherwise = {}) {
  const auto found = keys.find(key);
  return found == keys.end() ? std::string(otherwise) : found->second;
}

/// Time and trace of a further table, the first two columns behind its keys.
void take_further_table(const TableLayout& layout, std::size_t keys_column, TableHead& head) {
  const Keys keys = keys_at(layout, keys_column);
  const std::string name = value_of(keys, "Source", "trace");
  for (const auto& [key, value] : keys)
    if (value_of(head.attributes, key) != value)
      head.attributes[fmt::format("{} ({})", key, name)] = value;
  std::size_t time = keys_column - layout.key_cells;
  while (time < layout.cells && layout.holds_text(time)) ++time;
  if (time + 1 >= layout.cells) return;
  head.columns[time].name = "time";
  head.columns[time].unit = unit_of_times(value_of(keys, "Horizontal Units"));
  head.columns[time + 1].name = name;
  head.columns[time + 1].unit = value_of(keys, "Vertical Units");
}

}  // namespace

bool take_toa5(const TableLayout& layout, const std::vector<std::size_t>& filled,
               std::vector<std::string_view>& names, std::vector<std::string_view>& units,
               TableHead& head) {
  if (filled.size() < 4 || layout.dialect.delimiter != ',' ||
      cells_of(layout.head[filled[0]], ',').front() != "TOA5")
    return false;
  names = cells_of(layout.head[filled[1]], ',');
  units = cells_of(layout.head[filled[2]], ',');
  for (std::string_view& unit : units)
    if (unit == "TS" || unit == "RN") unit = {};  // time stamp, record number
  head.names_line = static_cast<int>(filled[1]) + 1;
  head.units_line = static_cast<int>(filled[2]) + 1;
  return true;
}

void take_instek_levels(TableHead& head) {
  constexpr double levels = 25.0;
  const auto number = [&head](const std::string& key) {
    return number_in(value_of(head.attributes, key));
  };
  if (head.columns.empty() || head.columns.front().name != "Waveform Data" ||
      value_of(head.attributes, "Mode") == "Detail")
    return;
  const auto division = number("Vertical Scale"), length = number("Memory Length");
  if (!division || !(*division > 0.0) || !length || !(*length > 0.0)) return;
  head.level = *division / levels;
  head.warnings.push_back(
      fmt::format("'Waveform Data' are the levels of the screen, 25 a division: they are taken in "
                  "the unit of 'Vertical Scale', {:g} a division",
                  *division));
  const auto middle = number("Horizontal Position");
  if (middle && head.interval && !head.start) head.start = *middle - 0.5 * *length * *head.interval;
}

void take_keys_beside_rows(const TableLayout& layout, TableHead& head) {
  const Keys keys = keys_at(layout, 0);
  head.attributes.insert(keys.begin(), keys.end());
  if (!head.columns.empty() || (layout.cells != 2 && layout.further_keys.empty())) return;
  head.columns.resize(layout.cells);
  head.columns[0].name = "time";
  head.columns[1].name = value_of(keys, "Source", "trace");
  if (!layout.further_keys.empty()) head.columns[1].unit = value_of(keys, "Vertical Units");
  for (const std::size_t column : layout.further_keys) take_further_table(layout, column, head);
}

bool take_graphtec(const TableLayout& layout, const std::vector<std::size_t>& filled,
                   TableHead& head) {
  const auto cells_in = [&layout](std::size_t line) {
    return cells_of(layout.head[line], layout.dialect.delimiter);
  };
  if (filled.size() < 3 || layout.dialect.delimiter == ' ') return false;
  const Cells vendor = cells_in(filled.front());
  if (vendor.size() < 2 || !vendor[1].starts_with("GRAPHTEC")) return false;
  std::size_t names_line = filled.back();
  Cells names = cells_in(names_line);
  Cells units(names.size());
  const Cells above = cells_in(filled[filled.size() - 2]);
  if (above.size() == names.size() && above.size() > 1 && !above[1].empty()) {
    head.units_line = static_cast<int>(names_line) + 1;
    names_line = filled[filled.size() - 2];
    units = std::exchange(names, above);
  }
  head.names_line = static_cast<int>(names_line) + 1;
  for (std::size_t c = 0; c < names.size(); ++c) {
    ColumnHead& column = head.columns.emplace_back();
    if (c > 0) column.name = to_utf8(names[c]);  // the first counts the rows
    if (layout.dates_at(c) == nullptr && units[c] != "NO.") column.unit = to_utf8(units[c]);
  }
  take_amplifier_settings(layout, filled, head);
  return true;
}

bool take_keys_over_values(const TableLayout& layout, const std::vector<std::size_t>& filled,
                           TableHead& head) {
  if (filled.size() < 3 || lone_key(layout.head[filled.front()]) != "channel names") return false;
  for (std::size_t i = 0; i + 1 < filled.size(); ++i) {
    const std::string key = lone_key(layout.head[filled[i]]);
    if (key.empty() || !lone_key(layout.head[filled[i + 1]]).empty()) continue;
    const std::string_view line = layout.head[filled[++i]];
    const bool tabs = line.find('\t') != line.npos || layout.cells == 1;
    const Cells values = cells_of(line, tabs ? '\t' : layout.dialect.delimiter);
    head.attributes[to_utf8(key)] = to_utf8(trimmed(line));
    if (key == "start times") take_start_times(values, head);
    if (key != "channel names" || values.size() != layout.cells) continue;
    head.names_line = static_cast<int>(filled[i]) + 1;
    for (const std::string_view name : values) head.columns.push_back(split_head(name));
  }
  return true;
}

std::optional<AcqKnowledgeHead> acqknowledge_head(const std::vector<std::string_view>& lines) {
  constexpr std::string_view rate = "/sample", count = " channels";
  for (std::size_t i = 0; i + 1 < lines.size() && i < 3; ++i) {
    const std::string_view said = trimmed(lines[i]), counted = trimmed(lines[i + 1]);
    if (!said.ends_with(rate) || !counted.ends_with(count)) continue;
    const std::string_view step = said.substr(0, said.size() - rate.size());
    const std::size_t blank = step.rfind(' ');
    if (blank == step.npos) continue;
    const auto number = number_in(trimmed(step.substr(0, blank)), {'.', false});
    const auto unit = datasets::conversion(to_utf8(step.substr(blank + 1)), "s");
    const auto channels = integer_in(counted.substr(0, counted.size() - count.size()));
    if (!number || !(*number > 0.0) || !unit || !channels || *channels < 1) continue;
    const auto n = static_cast<std::size_t>(*channels);
    if (n > lines.size() || lines.size() < i + 2 + 2 * n) continue;
    AcqKnowledgeHead found{*number * unit->factor, {}};
    for (std::size_t c = 0; c < n; ++c)
      found.channels.push_back(
          {to_utf8(trimmed(lines[i + 2 + 2 * c])), to_utf8(trimmed(lines[i + 3 + 2 * c])), ""});
    return found;
  }
  return std::nullopt;
}

bool take_acqknowledge(const TableLayout& layout, TableHead& head) {
  auto found = acqknowledge_head(layout.head);
  if (!found || layout.cells < found->channels.size() || layout.cells > found->channels.size() + 1)
    return false;
  head.interval = found->interval;
  if (layout.cells > found->channels.size()) {
    std::string unit;
    for (const std::string_view line : layout.head) {
      const std::string word = lowered(trimmed(cells_of(line, layout.dialect.delimiter).front()));
      for (const auto& [name, symbol] : {std::pair{"millisec", "ms"}, {"sec", "s"}, {"min", "min"}})
        if (word == name) unit = symbol;
    }
    head.columns.push_back({"time", unit, ""});
  }
  for (ColumnHead& channel : found->channels) head.columns.push_back(std::move(channel));
  return true;
}

}  // namespace impactrig::acquisition
