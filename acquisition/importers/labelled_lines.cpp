// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/labelled_lines.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string>

#include "acquisition/importers/column_keys.hpp"
#include "acquisition/importers/row_of_units.hpp"

namespace impactrig::acquisition {

namespace {

/// Words for names, the surer the sooner; the last ones may stand before a title too.
constexpr auto name_labels = std::to_array<std::string_view>(
    {"name",         "names",       "channel name", "channel names",  "signal name",
     "signal names", "channelname", "channeltitle", "tracename",      "trace name",
     "kanalname",    "headers",     "header",       "fields",         "column names",
     "channel data", "labels",      "signal",       "signals",        "variable",
     "variables",    "channel",     "channels",     "kanal",          "ch name",
     "ch names",     "ch",          "ch.",          "sensor",         "sensors",
     "columns",      "spalten",     "analog names", "ch\u540d\u79f0", "label",
     "trace",        "title",       "titles",       "series",         "bezeichnung",
     "titel",        "parameter"});
constexpr std::size_t sure_labels = 34;  // of them

std::optional<std::size_t> rank_of_name_label(std::string_view cell) {
  const auto found = std::ranges::find(name_labels, normalized_key(cell));
  if (found == name_labels.end()) return std::nullopt;
  return static_cast<std::size_t>(found - name_labels.begin());
}

/// The cells of a line that has one more than the rows; none of others. Over one column, which
/// nothing divides from others, cells end at any mark.
HeadCells one_more_cell(std::string_view line, const TableLayout& layout) {
  const std::string_view text = without_comment_sign(line, layout);
  const auto divided = [&](char delimiter) {
    HeadCells cells = cells_of(text, delimiter);
    while (!cells.empty() && cells.back().empty()) cells.pop_back();
    return cells.size() == layout.cells + 1 ? cells : HeadCells{};
  };
  if (layout.cells > 1) return divided(layout.dialect.delimiter);
  for (const char delimiter : {',', ';', '\t'})
    if (HeadCells cells = divided(delimiter); !cells.empty()) return cells;
  return {};
}

/// Whether cells behind the first are words, as names are.
bool are_words(const HeadCells& cells, char decimal) {
  return std::all_of(cells.begin() + 1, cells.end(), [decimal](std::string_view cell) {
    return !cell.empty() && !number_in(cell, {decimal, false});
  });
}

/// Whether a line has a word over each column, perhaps but that of the times, or a time or a unit
/// among such words: they are names rather than a line with a label above them.
bool names_each_column(std::string_view line, const TableLayout& layout) {
  const HeadCells words = head_cells(line, layout);
  if (words.size() >= layout.cells && name_a_time_or_unit(words) &&
      (is_time_name(split_head(words.front()).name) || are_words(words, layout.dialect.decimal)))
    return true;
  HeadCells cells = cells_of(without_comment_sign(line, layout), layout.dialect.delimiter);
  while (!cells.empty() && cells.back().empty()) cells.pop_back();
  const bool is_key =
      cells.size() == 1 && cells.front().find_first_of(":=,;\t") != std::string_view::npos;
  return cells.size() == layout.cells && !is_key &&
         (cells.front().empty() || !number_in(cells.front(), {layout.dialect.decimal, false})) &&
         (cells.size() > 1 || !cells.front().empty()) && are_words(cells, layout.dialect.decimal);
}

}  // namespace

bool is_name_label(std::string_view cell) {
  return rank_of_name_label(cell).has_value();
}

namespace {

bool is_unit_word(std::string_view cell) {
  const std::string key = normalized_key(cell);
  return key == "unit" || key == "units" || key == "einheit" || key == "einheiten" ||
         key == "unit\u00e9" || key == "unit\u00e9s" || key == "\u5358\u4f4d" ||
         key == "\u5355\u4f4d";
}

}  // namespace

bool is_unit_label(std::string_view cell) {
  return is_unit_word(cell) || is_vertical_unit_key(cell) || is_horizontal_unit_key(cell);
}

NamesAndUnits labelled_names(const TableLayout& layout, const std::vector<std::size_t>& filled,
                             TableHead& head) {
  std::vector<HeadCells> lines;
  for (const std::size_t line : filled) lines.push_back(one_more_cell(layout.head[line], layout));
  const auto may_name = [&](std::size_t k) {
    return !lines[k].empty() && are_words(lines[k], layout.dialect.decimal);
  };
  std::optional<std::size_t> units, names;
  for (std::size_t k = lines.size(); k-- > 0 && !units;)
    if (!lines[k].empty() && is_unit_label(lines[k].front()) &&
        !is_horizontal_unit_key(lines[k].front()))
      units = k;
  for (std::size_t k = 0; k < lines.size(); ++k) {
    if (units == k || !may_name(k)) continue;
    const auto rank = rank_of_name_label(lines[k].front());
    // a title may stand beside its word, but hardly in as many cells as there are columns
    if (!rank || (!units && *rank >= sure_labels && layout.cells < 2)) continue;
    const auto names_time = [&](std::size_t line) {
      return std::any_of(lines[line].begin() + 1, lines[line].end(),
                         [](std::string_view cell) { return is_time_name(split_head(cell).name); });
    };
    if (!names || std::pair(!names_time(k), *rank) <
                      std::pair(!names_time(*names), *rank_of_name_label(lines[*names].front())))
      names = k;
  }
  if (!names && units && *units > 0 && may_name(*units - 1)) names = *units - 1;
  // rows that end with a mark may lack the last of so many columns, and a line of two cells may be
  // a key with its value
  if (!names) return {};
  const std::size_t written =
      cells_of(without_comment_sign(layout.head[filled[*names]], layout), layout.dialect.delimiter)
          .size();
  if (!units && ((layout.written_cells > layout.cells && written <= layout.written_cells) ||
                 layout.cells == 1))
    return {};
  for (std::size_t k = *names + 1; k < filled.size(); ++k)
    if (units != k && names_each_column(layout.head[filled[k]], layout)) return {};
  NamesAndUnits found;
  head.names_line = static_cast<int>(filled[*names]) + 1;
  found.names.assign(lines[*names].begin() + 1, lines[*names].end());
  if (units) {
    head.units_line = static_cast<int>(filled[*units]) + 1;
    found.units.assign(lines[*units].begin() + 1, lines[*units].end());
  }
  return found;
}

NamesAndUnits labelled_names_over_times(const TableLayout& layout,
                                        const std::vector<std::size_t>& filled, TableHead& head) {
  std::optional<std::size_t> names, units;
  const auto cells_at = [&](std::size_t k) {
    HeadCells cells =
        cells_of(without_comment_sign(layout.head[filled[k]], layout), layout.dialect.delimiter);
    return cells.size() == layout.cells && cells.size() > 1 ? cells : HeadCells{};
  };
  for (std::size_t k = filled.size(); k-- > 0;) {
    const HeadCells cells = cells_at(k);
    if (cells.empty()) continue;
    if (!units && is_unit_word(cells.front()))
      units = k;
    else if (units && !names && is_name_label(cells.front()) &&
             are_words(cells, layout.dialect.decimal))
      names = k;
  }
  if (!names) return {};
  head.names_line = static_cast<int>(filled[*names]) + 1;
  head.units_line = static_cast<int>(filled[*units]) + 1;
  NamesAndUnits found{cells_at(*names), cells_at(*units)};
  found.names.front() = found.units.front() = {};
  return found;
}

}  // namespace impactrig::acquisition
