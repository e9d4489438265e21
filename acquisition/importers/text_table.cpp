// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/text_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstring>
#include <limits>

namespace impactrig::acquisition {

using datasets::InputError;

namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

/// In order of preference where two explain a file equally well.
constexpr std::array<Dialect, 10> dialects = {{
    {'\t', '.'},
    {'\t', ','},
    {';', '.'},
    {';', ','},
    {',', '.'},
    {'|', '.'},
    {'|', ','},
    {' ', '.'},
    {' ', ','},
    {':', '.'},  // never chosen by itself: see find_table
}};

std::string_view without_quotes(std::string_view cell) {
  if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"') {
    cell.remove_prefix(1);
    cell.remove_suffix(1);
  }
  return trimmed(cell);
}

bool same_word(std::string_view cell, std::string_view lower) {
  return std::equal(cell.begin(), cell.end(), lower.begin(), lower.end(), [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) == b;
  });
}

/// What stands for "no value": nothing, not-a-number as C, MATLAB and old Microsoft libraries print
/// it.
bool is_missing(std::string_view cell) {
  if (cell.empty()) return true;
  if (cell.front() == '-' || cell.front() == '+') cell.remove_prefix(1);
  for (const std::string_view word :
       {"nan", "nan(ind)", "nan(snan)", "1.#qnan", "1.#ind", "#nan", "qnan"})
    if (same_word(cell, word)) return true;
  return false;
}

/// "inf" in its spellings.
std::optional<double> infinity_in(std::string_view cell) {
  const bool negative = !cell.empty() && cell.front() == '-';
  if (!cell.empty() && (cell.front() == '-' || cell.front() == '+')) cell.remove_prefix(1);
  for (const std::string_view word : {"inf", "infinity", "1.#inf"})
    if (same_word(cell, word))
      return negative ? -std::numeric_limits<double>::infinity()
                      : std::numeric_limits<double>::infinity();
  return std::nullopt;
}

/// A row of a table: how many cells, and whether they are numbers.
struct RowShape {
  std::size_t cells = 0;          ///< without empty ones at the end
  std::size_t written_cells = 0;  ///< with them
  bool numeric = false;           ///< numbers and missing values only, and at least one number
};

RowShape shape_of(std::string_view line, Dialect dialect) {
  RowShape shape;
  bool numbers_only = true;
  bool any = false;
  for (const std::string_view cell : cells_of(line, dialect.delimiter)) {
    ++shape.written_cells;
    if (!cell.empty()) shape.cells = shape.written_cells;
    const auto value = cell_value(cell, dialect.decimal);
    if (!value) numbers_only = false;
    if (value && !std::isnan(*value)) any = true;
  }
  shape.numeric = numbers_only && any;
  return shape;
}

bool is_skipped(std::string_view line) {
  const std::string_view text = trimmed(line);
  return text.empty() || text.front() == '#' || text.front() == '%';
}

/// Where the rows begin in one dialect, and how well it explains what follows.
struct Candidate {
  Dialect dialect;
  std::size_t first_line = 0;
  RowShape first_row;
  std::size_t numeric_lines = 0;
};

/// Looks at lines from `from`; a first row is a row of numbers that is followed by another of as
/// many cells, or by the end.
std::optional<Candidate> try_dialect(const std::vector<std::string_view>& lines, std::size_t from,
                                     Dialect dialect) {
  constexpr std::size_t rows_tried = 40;
  for (std::size_t i = from; i < lines.size(); ++i) {
    if (is_skipped(lines[i])) continue;
    const RowShape first = shape_of(lines[i], dialect);
    if (!first.numeric) continue;
    std::size_t next = i + 1;
    while (next < lines.size() && is_skipped(lines[next])) ++next;
    if (next < lines.size()) {
      const RowShape second = shape_of(lines[next], dialect);
      const auto cells = cells_of(lines[next], dialect.delimiter);
      const bool begins_with_number = !cells.empty() && cell_value(cells.front(), dialect.decimal);
      const bool is_last = next + 1 == lines.size();
      if (!begins_with_number || (second.written_cells != first.written_cells && !is_last))
        continue;
    }
    Candidate found{dialect, i, first, 0};
    for (std::size_t k = i; k < lines.size() && k < i + rows_tried; ++k)
      if (!is_skipped(lines[k]) && shape_of(lines[k], dialect).numeric) ++found.numeric_lines;
    return found;
  }
  return std::nullopt;
}

bool better(const Candidate& a, const Candidate& b) {
  // an early start explains more of the file than a late one, but only if it holds: count rows
  // first
  if (a.numeric_lines != b.numeric_lines) return a.numeric_lines > b.numeric_lines;
  return a.first_row.cells > b.first_row.cells;
}

/// The lines of the first 256 KiB, at most 4000 of them; the last one only when it is whole.
std::vector<std::string_view> first_lines(std::string_view text) {
  constexpr std::size_t looked_at = 256 * 1024;
  constexpr std::size_t most_lines = 4000;
  std::vector<std::string_view> lines;
  const char* at = text.data();
  const char* const end = text.data() + std::min(text.size(), looked_at);
  while (at != end && lines.size() < most_lines) lines.push_back(take_line(at, end));
  if (text.size() > looked_at && lines.size() > 1 && at == end) lines.pop_back();
  return lines;
}

/// True when a row holds numbers in all cells from `first` on.
bool numbers_from(const std::vector<std::string_view>& cells, std::size_t first, char decimal) {
  bool any = false;
  for (std::size_t c = first; c < cells.size(); ++c) {
    if (cells[c].empty()) continue;
    if (!number_in(cells[c], {decimal, false})) return false;
    any = true;
  }
  return any;
}

/// A row above that begins with a number and is as long belongs to the table, whatever else it
/// holds: reading it says what is wrong with it.
void take_spoilt_rows(const std::vector<std::string_view>& lines, std::size_t skipped,
                      TableLayout& layout) {
  std::size_t first = layout.head.size();
  while (first > skipped) {
    const auto above = cells_of(lines[first - 1], layout.dialect.delimiter);
    const bool begins_with_number =
        !above.empty() && number_in(above.front(), {layout.dialect.decimal, false}).has_value();
    if (!begins_with_number || above.size() != layout.written_cells) break;
    --first;
  }
  layout.head.resize(first);
  layout.data = lines[first].data();
}

/// Finds rows above the first row of numbers alone that hold samples too, with keys before them:
/// "Record Length,2.5e+03,,-0.00025,0.08," above ",,,-0.00024,0.04,".
void take_rows_with_keys(const std::vector<std::string_view>& lines, TableLayout& layout) {
  const char delimiter = layout.dialect.delimiter;
  if (delimiter == ' ') return;
  std::size_t first = layout.head.size();
  const auto row = cells_of(lines[first], delimiter);
  std::size_t empty = 0;
  while (empty < row.size() && row[empty].empty()) ++empty;
  if (empty == 0 || empty >= layout.cells) return;
  while (first > 0) {
    const auto above = cells_of(lines[first - 1], delimiter);
    if (above.size() != row.size() || above.front().empty() ||
        !numbers_from(above, empty, layout.dialect.decimal))
      break;
    layout.key_lines.insert(layout.key_lines.begin(), lines[--first]);
  }
  if (layout.key_lines.empty()) return;
  layout.head.resize(first);
  layout.data = lines[first].data();
  layout.key_cells = empty;
  layout.cells -= empty;
  layout.written_cells -= empty;
}

}  // namespace

std::optional<double> cell_value(std::string_view cell, char decimal) {
  const std::string_view text = without_quotes(cell);
  if (is_missing(text)) return nothing;
  if (const auto value = number_in(text, {decimal, false})) return value;
  return infinity_in(text);
}

std::string delimiter_name(char delimiter) {
  switch (delimiter) {
    case ',':
      return "comma";
    case ';':
      return "semicolon";
    case '\t':
      return "tab";
    case ' ':
      return "blank";
    case '|':
      return "bar";
    default:
      return std::string(1, delimiter);
  }
}

std::vector<std::string_view> cells_of(std::string_view line, char delimiter) {
  std::vector<std::string_view> cells;
  const std::string_view blanks = " \t";
  std::size_t start = 0;
  bool quoted = false;
  if (delimiter == ' ') {
    line = trimmed(line);
    if (line.empty()) return cells;
  }
  for (std::size_t i = 0; i <= line.size(); ++i) {
    if (i < line.size() && line[i] == '"') quoted = !quoted;
    const bool ends = i == line.size() ||
                      (!quoted && (delimiter == ' ' ? blanks.find(line[i]) != std::string_view::npos
                                                    : line[i] == delimiter));
    if (!ends) continue;
    const std::string_view cell = line.substr(start, i - start);
    if (delimiter != ' ' || !cell.empty()) cells.push_back(without_quotes(trimmed(cell)));
    start = i + 1;
  }
  return cells;
}

TableLayout find_table(TextFile& file, const ImportOptions& options) {
  const std::string_view text = file.text();
  const std::vector<std::string_view> lines = first_lines(text);
  const auto skipped = static_cast<std::size_t>(std::max(0, options.skip_lines.value_or(0)));

  std::optional<Candidate> best;
  for (Dialect dialect : dialects) {
    if (dialect.delimiter == ':') {
      if (!options.delimiter) continue;
      dialect.delimiter =
          *options.delimiter;  // whatever the user says, also one that is not in the list
    }
    if (options.delimiter && dialect.delimiter != *options.delimiter) continue;
    if (options.decimal) dialect.decimal = *options.decimal;
    if (dialect.decimal == dialect.delimiter) continue;
    const auto candidate = try_dialect(lines, skipped, dialect);
    if (candidate && (!best || better(*candidate, *best))) best = candidate;
  }
  if (!best) {
    datasets::SourcePosition place;
    place.file = file.path();
    if (trimmed(text).empty()) throw InputError(place, "there is no text in this file");
    throw InputError(
        place, fmt::format("no row of numbers among the first {} {}: expected columns of numbers "
                           "(--delimiter, --decimal and --skip-lines state how they are written)",
                           lines.size(), lines.size() == 1 ? "line" : "lines"));
  }
  TableLayout layout;
  layout.dialect = best->dialect;
  layout.head.assign(lines.begin(), lines.begin() + static_cast<std::ptrdiff_t>(best->first_line));
  layout.data = lines[best->first_line].data();
  layout.cells = best->first_row.cells;
  layout.written_cells = best->first_row.written_cells;
  take_spoilt_rows(lines, skipped, layout);
  take_rows_with_keys(lines, layout);
  return layout;
}

}  // namespace impactrig::acquisition
