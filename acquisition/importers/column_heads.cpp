// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/column_heads.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "acquisition/importers/column_keys.hpp"
#include "acquisition/importers/instrument_heads.hpp"
#include "acquisition/importers/names_and_units.hpp"
#include "acquisition/importers/row_of_units.hpp"

namespace impactrig::acquisition {

namespace {

constexpr std::string_view wide_colon = "\uFF1A";  // of East Asian text

/// Where the first cell of a line above the rows ends: over one column, which no mark divides from
/// others, at any of the marks ("Sample Rate,100000").
std::size_t end_of_key(std::string_view text, const TableLayout& layout) {
  const std::size_t end = text.find(layout.dialect.delimiter);
  if (end != text.npos || layout.cells > 1 || text.find_first_of(":=") != text.npos) return end;
  for (const char mark : {'\t', ';', ','})
    if (const std::size_t at = text.find(mark); at != text.npos) return at;
  return text.npos;
}

void add_attribute(std::string_view line, const TableLayout& layout, bool keys, TableHead& head) {
  const std::string_view text = trimmed(without_comment_sign(line));
  if (text.empty()) return;
  std::string key;
  std::string value;
  const std::size_t cell_end =
      keys || layout.dialect.delimiter == ' ' ? std::string_view::npos : end_of_key(text, layout);
  const bool by_colon = keys && text.find(':') != text.npos;
  const std::size_t colon =
      std::min(text.find_first_of(by_colon ? ":" : ":="), text.find(wide_colon));
  // "# units: ms, kN": cells are no concern of a comment's key
  const bool comment = text.data() != trimmed(line).data() && colon < cell_end &&
                       text.substr(colon + 1).starts_with(' ');
  const std::size_t divider = cell_end != std::string_view::npos && !comment ? cell_end : colon;
  if (divider == std::string_view::npos || divider == 0) {
    std::string& rest = head.attributes["header"];
    if (!rest.empty()) rest += " | ";
    rest += to_utf8(text);
    return;
  }
  key = to_utf8(without_quotes(trimmed(text.substr(0, divider))));
  const std::size_t width = text.substr(divider).starts_with(wide_colon) ? wide_colon.size() : 1;
  std::string_view rest = trimmed(text.substr(divider + width));
  if (divider == colon)  // "XInc:,5e-7" above one column
    rest.remove_prefix(std::min(rest.find_first_not_of(",;\t "), rest.size()));
  while (!rest.empty() && rest.back() == layout.dialect.delimiter) rest.remove_suffix(1);
  while (!key.empty() && std::string_view(":= \t").find(key.back()) != key.npos) key.pop_back();
  value = to_utf8(trimmed(rest));
  if (!key.empty() && !value.empty()) head.attributes[key] = value;
}

/// Lines "Key :value" above a table of one column, as ISO 13499 (MME) has them: the last is no name
/// where its value is a number, or all others are keys too.
bool are_keys(const TableLayout& layout, const std::vector<std::size_t>& filled) {
  if (layout.cells != 1 || filled.empty()) return false;
  const auto value_of = [&](std::size_t line) -> std::optional<std::string_view> {
    const std::string_view text = trimmed(without_comment_sign(layout.head[line]));
    const std::size_t colon = std::min(text.find(':'), text.find('='));
    if (colon == std::string_view::npos || colon == 0) return std::nullopt;
    return trimmed(text.substr(colon + 1));
  };
  const auto last = value_of(filled.back());
  if (!last) return false;
  return number_in(*last, {layout.dialect.decimal, false}).has_value() ||
         (filled.size() > 2 && std::ranges::all_of(filled, [&](std::size_t line) {
            return value_of(line).has_value();
          }));
}

/// "-----  -----" and "|---|---|".
bool is_rule(std::string_view line) {
  return line.find("--") != line.npos && line.find_first_not_of("-=+|:#% \t\r") == line.npos;
}

/// "1", "2", ... or "0", "1", ...: the first cells of the first rows.
bool begin_with_their_numbers(const TableLayout& layout, std::string_view text) {
  constexpr int rows_tried = 3;
  const char* at = layout.data;
  const char* const end = text.data() + text.size();
  std::optional<long> first;
  int rows = 0;
  while (at != end && rows < rows_tried) {
    const HeadCells cells = cells_of(take_line(at, end), layout.dialect.delimiter);
    const auto number = cells.empty() ? std::nullopt : integer_in(cells.front());
    if (!number || (first ? *number != *first + rows : *number != 0 && *number != 1)) return false;
    if (!first) first = *number;
    ++rows;
  }
  return rows > 1;
}

/// Rows may begin with their numbers, under no name of their own: the names are those of the other
/// columns then, as R writes tables. Where else names are fewer than columns, they may not be over
/// their own.
void compare_names_with_columns(const TableLayout& layout, std::string_view text, HeadCells& names,
                                TableHead& head) {
  if (names.empty() || names.size() >= layout.cells) return;
  if (names.size() + 1 == layout.cells && layout.dates.empty() &&
      begin_with_their_numbers(layout, text)) {
    names.insert(names.begin(), std::string_view());
    return;
  }
  if (layout.dialect.delimiter == ' ' && !layout.dates.empty()) return;
  head.warnings.push_back(
      fmt::format("line {} names {} of {} columns: the first ones are taken to be meant",
                  head.names_line, names.size(), layout.cells));
}

/// A date and time in several cells may have one name: it is that of the last of them.
void spread_names(const TableLayout& layout, HeadCells& names) {
  if (names.empty()) return;
  for (const DateColumns& date : layout.dates)
    for (std::size_t c = date.first; c < date.last && names.size() < layout.cells; ++c)
      names.insert(names.begin() + static_cast<std::ptrdiff_t>(std::min(c, names.size())),
                   std::string_view());
}

std::vector<ColumnHead> heads_of(const NamesAndUnits& found, std::vector<std::string>& warnings) {
  const auto& [names, units] = found;
  std::vector<ColumnHead> heads;
  // as written and as taken: of which columns
  std::map<std::pair<std::string, std::string>, std::vector<std::string>> spoilt;
  const bool sentences = !units.empty() && is_sentence_row(units) && !is_unit_row(units);
  for (std::size_t c = 0; c < std::max(names.size(), units.size()); ++c) {
    ColumnHead column = c < names.size() ? split_head(names[c]) : ColumnHead{};
    if (integer_in(column.name)) column.name = "CH " + column.name;
    const std::string_view unit = c < units.size() ? units[c] : std::string_view{};
    if (sentences) {
      const ColumnHead said = sentence(unit).value_or(ColumnHead{});
      column.unit = said.unit;
      column.description = said.description;
    } else if (is_index_word(unit)) {
      column.description = to_utf8(unit);
    } else if (!unit.empty()) {
      column.unit = with_mu(to_utf8(bracketed(unit).value_or(unit)));
    }
    const std::string_view written = unit.empty() && c < names.size() ? names[c] : unit;
    if (std::string of = spoilt_unit(written, column.unit); !of.empty())
      spoilt[{std::move(of), column.unit}].push_back(column.name);
    heads.push_back(std::move(column));
  }
  for (const auto& [units_as_written, columns] : spoilt)
    warnings.push_back(fmt::format(
        "the unit '{}' of '{}'{} is taken for {} (--units states another)", units_as_written.first,
        columns.front(), columns.size() > 1 ? fmt::format(" and {} more", columns.size() - 1) : "",
        units_as_written.second));
  return heads;
}

}  // namespace

TableHead read_head(const TableLayout& layout, std::string_view text) {
  TableHead head;
  std::vector<std::size_t> filled;  // head lines with text
  for (std::size_t i = 0; i < layout.head.size(); ++i)
    if (!trimmed(layout.head[i]).empty() && !is_rule(layout.head[i])) filled.push_back(i);
  NamesAndUnits found;
  if (take_keys_over_values(layout, filled, head)) filled.clear();
  const bool keys = are_keys(layout, filled);
  if (!keys && !take_graphtec(layout, filled, head) && !take_acqknowledge(layout, head))
    found = find_names_and_units(layout, filled, head);
  if (found.names.size() > layout.cells) take_keys_among_names(found.names, head);
  spread_names(layout, found.names);
  compare_names_with_columns(layout, text, found.names, head);
  if (layout.column_numbers)
    head.warnings.push_back(
        fmt::format("line {} ('{}') is taken to number the columns, not for a row of them",
                    layout.head.size(), to_utf8(trimmed(layout.head.back()).substr(0, 40))));
  if (head.columns.empty()) head.columns = heads_of(found, head.warnings);
  if (!layout.key_lines.empty()) take_keys_beside_rows(layout, head);
  for (const std::size_t i : filled) {
    const int line = static_cast<int>(i) + 1;
    const bool only_numbers = layout.column_numbers && i + 1 == layout.head.size();
    if (line != head.names_line && line != head.units_line && !only_numbers)
      add_attribute(layout.head[i], layout, keys, head);
  }
  if (keys) take_column_of_keys(layout.dialect, head);
  take_names_of_keys(layout, head);
  find_interval(layout.dialect, head);
  take_instek_levels(head);
  return head;
}

}  // namespace impactrig::acquisition
