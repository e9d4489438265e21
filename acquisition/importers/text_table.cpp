// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/text_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>

#include "acquisition/importers/date_columns.hpp"

namespace impactrig::acquisition {

using datasets::InputError;

namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

/// In order of preference where two explain a file equally well.
constexpr std::array<Dialect, 11> dialects = {{
    {'\t', '.'},
    {'\t', ','},
    {';', '.'},
    {';', ','},
    {',', '.'},
    {'|', '.'},
    {'|', ','},
    {' ', '.'},
    {' ', ','},
    {',', ','},  // decimal marks within quotes: see has_quoted_decimals
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
    return std::tolower(static_cast<unsigned char>(a)) == static_cast<unsigned char>(b);
  });
}

/// What stands for "no value": nothing, a dash, what meters show for it, not-a-number as C, MATLAB
/// and old Microsoft libraries print it.
bool is_missing(std::string_view cell) {
  if (cell.empty() || cell == "-" || same_word(cell, "n/a") || same_word(cell, "ol")) return true;
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
  for (const std::string_view word : {"inf", "infinity", "1.#inf", "\u221E"})
    if (same_word(cell, word))
      return negative ? -std::numeric_limits<double>::infinity()
                      : std::numeric_limits<double>::infinity();
  return std::nullopt;
}

/// True for a number, a missing one and, where there may be some, a date or a time of day.
bool is_value(std::string_view cell, Dialect dialect) {
  return cell_value(cell, dialect.decimal) || (dialect.dates && is_part_of_date(cell));
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
    if (!value && !is_value(cell, dialect)) numbers_only = false;
    if (value && !std::isnan(*value)) any = true;
  }
  shape.numeric = numbers_only && any;
  return shape;
}

bool is_skipped(std::string_view line) {
  const std::string_view text = trimmed(line);
  return text.empty() || text.front() == '#' || text.front() == '%';
}

/// How many columns a line above the rows names: 0 where it holds a number or nothing.
std::size_t named_columns(std::string_view line, Dialect dialect) {
  std::string_view text = trimmed(line);
  while (text.starts_with('#') || text.starts_with('%')) text.remove_prefix(1);
  text = trimmed(text);
  std::size_t named = 0;
  std::size_t cells = 0;
  for (const std::string_view cell : cells_of(text, dialect.delimiter)) {
    ++cells;
    if (number_in(cell, {dialect.decimal, false})) return 0;
    if (!cell.empty()) named = cells;
  }
  return named;
}

/// Where commas divide cells, they are decimal marks within quotes if one of them cannot divide
/// thousands.
bool has_quoted_decimals(const std::vector<std::string_view>& lines, std::size_t from,
                         Dialect dialect) {
  for (std::size_t i = from; i < lines.size(); ++i)
    for (const std::string_view cell : cells_of(lines[i], dialect.delimiter))
      if (cell.find(dialect.decimal) != cell.npos && number_in(cell, {dialect.decimal, false}) &&
          !has_thousands_separators(cell))
        return true;
  return false;
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
      const bool begins_with_number = !cells.empty() && is_value(cells.front(), dialect);
      const bool is_last = next + 1 == lines.size();
      if (!begins_with_number || (second.written_cells != first.written_cells && !is_last))
        continue;
    }
    if (dialect.delimiter == dialect.decimal && !has_quoted_decimals(lines, i, dialect))
      return std::nullopt;
    Candidate found{dialect, i, first, 0};
    for (std::size_t k = i; k < lines.size() && k < i + rows_tried; ++k)
      if (!is_skipped(lines[k]) && shape_of(lines[k], dialect).numeric) ++found.numeric_lines;
    return found;
  }
  return std::nullopt;
}

/// True for a row that begins with a number (or a date) and holds another number, whatever its
/// other cells are.
bool has_numbers_beside_text(std::string_view line, Dialect dialect) {
  const auto cells = cells_of(line, dialect.delimiter);
  const auto is_number = [dialect](std::string_view cell) {
    return number_in(cell, {dialect.decimal, false}).has_value();
  };
  return cells.size() > 1 &&
         (is_number(cells.front()) || (dialect.dates && is_part_of_date(cells.front()))) &&
         std::any_of(cells.begin() + 1, cells.end(), is_number);
}

/// The same where each row holds text, under as many names: a first row is followed by another with
/// numbers, or by the end.
std::optional<Candidate> try_dialect_with_text(const std::vector<std::string_view>& lines,
                                               std::size_t from, Dialect dialect) {
  if (dialect.delimiter == ' ' || dialect.delimiter == dialect.decimal) return std::nullopt;
  std::optional<Candidate> found;
  for (std::size_t i = from; i < lines.size(); ++i) {
    if (is_skipped(lines[i])) continue;
    const bool is_row = has_numbers_beside_text(lines[i], dialect);
    if (!is_row && !found) continue;
    if (!is_row) {
      if (found->numeric_lines > 1) break;
      found.reset();
      continue;
    }
    if (!found) {
      found = Candidate{dialect, i, shape_of(lines[i], dialect), 0};
      if (i == 0 || named_columns(lines[i - 1], dialect) < found->first_row.cells)
        return std::nullopt;
    }
    ++found->numeric_lines;
  }
  return found;
}

/// True where one name with a unit stands over rows of several cells: their commas are decimal
/// marks then, if they can be.
bool has_one_name(const std::vector<std::string_view>& lines, const Candidate& found) {
  if (found.first_line == 0 || found.dialect.delimiter != ',') return false;
  const std::string_view above = trimmed(lines[found.first_line - 1]);
  return named_columns(above, found.dialect) == 1 && above.find_first_of(":=") == above.npos &&
         above.ends_with(']') && found.first_row.cells > 1;
}

bool better(const std::vector<std::string_view>& lines, const Candidate& a, const Candidate& b) {
  // an early start explains more of the file than a late one, but only if it holds: count rows
  // first
  if (a.numeric_lines != b.numeric_lines) return a.numeric_lines > b.numeric_lines;
  if (has_one_name(lines, a) != has_one_name(lines, b)) return has_one_name(lines, b);
  return a.first_row.cells > b.first_row.cells;
}

/// True for a line that ends within a cell in quotes.
bool opens_a_quote(std::string_view line) {
  bool quoted = false;
  std::size_t opened = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] != '"') continue;
    quoted = !quoted;
    if (quoted && (i == 0 || line[i - 1] != '"')) opened = i;  // a doubled one opens nothing
  }
  if (!quoted) return false;
  const std::string_view before = trimmed(line.substr(0, opened));
  return before.empty() || std::string_view(",;\t|").find(before.back()) != before.npos;
}

/// The line at `at` with those that go on with a cell in quotes: a break within them is part of a
/// name. As it is where the quotes do not close soon, before a delimiter or the line's end.
std::string_view take_quoted_line(const char*& at, const char* end) {
  constexpr int most_breaks = 4;
  const std::string_view line = take_line(at, end);
  if (!opens_a_quote(line)) return line;
  const char* ahead = at;
  for (int k = 0; k < most_breaks && ahead != end; ++k) {
    const std::string_view next = take_line(ahead, end);
    const std::size_t close = next.find('"');
    if (close == next.npos) continue;
    const std::string_view behind = trimmed(next.substr(close + 1));
    if (!behind.empty() && std::string_view(",;\t|").find(behind.front()) == behind.npos) break;
    if (opens_a_quote(next.substr(close + 1))) continue;
    if (std::ranges::count(next, '"') % 2 == 0) break;
    at = ahead;
    return {line.data(), static_cast<std::size_t>(next.data() + next.size() - line.data())};
  }
  return line;
}

/// The lines of the first 256 KiB, at most 4000 of them; the last one only when it is whole.
std::vector<std::string_view> first_lines(std::string_view text) {
  constexpr std::size_t looked_at = 256 * 1024;
  constexpr std::size_t most_lines = 4000;
  std::vector<std::string_view> lines;
  const char* at = text.data();
  const char* const end = text.data() + std::min(text.size(), looked_at);
  while (at != end && lines.size() < most_lines) lines.push_back(take_quoted_line(at, end));
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

/// The cells of a row above the first one, where it may be one too: it begins with a number and has
/// numbers in all columns but is longer or shorter, or it is as long and holds something else.
std::optional<std::size_t> cells_of_spoilt_row(std::string_view line, const TableLayout& layout) {
  const auto cells = cells_of(line, layout.dialect.delimiter);
  const char decimal = layout.dialect.decimal;
  if (cells.empty() || !number_in(cells.front(), {decimal, false})) return std::nullopt;
  if (cells.size() != layout.written_cells)
    for (std::size_t c = 1; c < std::min(cells.size(), layout.cells); ++c)
      if (!cell_value(cells[c], decimal)) return std::nullopt;
  return cells.size();
}

/// Rows above belong to the table where they are as long, whatever else they hold, or where names
/// stand above them: reading them says what is wrong with them.
void take_spoilt_rows(const std::vector<std::string_view>& lines, std::size_t skipped,
                      TableLayout& layout) {
  std::size_t first = layout.head.size();
  std::vector<std::size_t> lengths = {layout.written_cells, layout.cells};
  std::size_t above = first;
  for (; above > skipped; --above) {
    const auto cells = cells_of_spoilt_row(lines[above - 1], layout);
    if (!cells) break;
    lengths.push_back(*cells);
    if (*cells == layout.written_cells) first = above - 1;
  }
  if (above > skipped) {
    const std::size_t named = named_columns(lines[above - 1], layout.dialect);
    if (std::ranges::find(lengths, named) != lengths.end()) first = above;
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

/// Finds columns of text among the first rows: within the rows, or behind them where the line above
/// them names a column there. They count in `cells` and `written_cells`.
void find_text_columns(const std::vector<std::string_view>& lines, std::size_t named,
                       TableLayout& layout) {
  if (layout.key_cells > 0) return;

  struct Seen {
    std::string_view text;
    bool number = false;
  };

  std::vector<Seen> columns(std::max(named, layout.written_cells));
  for (std::size_t i = layout.head.size(); i < lines.size(); ++i) {
    if (is_skipped(lines[i])) continue;
    const auto cells = cells_of(lines[i], layout.dialect.delimiter);
    for (std::size_t c = 0; c < std::min(cells.size(), columns.size()); ++c) {
      Seen& column = columns[c];
      if (cells[c].empty() || column.number || layout.dates_at(c) != nullptr) continue;
      if (cell_value(cells[c], layout.dialect.decimal))
        column.number = true;
      else if (column.text.empty())
        column.text = cells[c];
    }
  }
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (columns[c].number || columns[c].text.empty()) continue;
    layout.text_columns.push_back({c, columns[c].text});
    layout.cells = std::max(layout.cells, c + 1);
    layout.written_cells = std::max(layout.written_cells, layout.cells);
  }
}

template <typename Try>
std::optional<Candidate> best_of(const Try& try_one, const std::vector<std::string_view>& lines,
                                 std::size_t from, std::span<const Dialect> possible) {
  std::optional<Candidate> best;
  for (const Dialect dialect : possible) {
    const auto candidate = try_one(lines, from, dialect);
    if (candidate && (!best || better(lines, *candidate, *best))) best = candidate;
  }
  return best;
}

datasets::SourcePosition place_of(TextFile& file, std::string_view text) {
  return file.position(text.data());
}

/// Throws InputError for a number with thousands separators beside numbers alone.
void refuse_thousands_separators(TextFile& file, const std::vector<std::string_view>& lines) {
  for (const std::string_view line : lines) {
    if (is_skipped(line)) continue;
    for (const char delimiter : {'\t', ';', ',', '|'}) {
      const auto cells = cells_of(line, delimiter);
      const auto separated = std::ranges::find_if(cells, has_thousands_separators);
      const bool others_are_numbers = std::ranges::all_of(cells, [](std::string_view cell) {
        return cell_value(cell, '.') || cell_value(cell, ',') || has_thousands_separators(cell);
      });
      if (cells.size() < 2 || separated == cells.end() || !others_are_numbers) continue;
      throw InputError(
          place_of(file, *separated),
          fmt::format("'{}': it seems to have thousands separators, which are not read",
                      to_utf8(*separated)));
    }
  }
}

/// What commas may be that give rows more cells than there are names.
enum class Commas { delimiters, thousands, decimal_marks };

Commas judge_commas(const std::vector<std::string_view>& lines, const Candidate& found,
                    std::size_t named) {
  constexpr std::size_t rows_tried = 40;
  const std::size_t cells = found.first_row.cells;
  std::vector<bool> groups(cells, true);  // by column: goes on with the digits of the one before
  bool whole = true;                      // no cell has decimals
  for (std::size_t i = found.first_line; i < lines.size() && i < found.first_line + rows_tried;
       ++i) {
    if (is_skipped(lines[i])) continue;
    const auto row = cells_of(lines[i], ',');
    if (row.size() < cells) break;
    for (std::size_t c = 0; c < cells; ++c) {
      whole = whole && row[c].find_first_of(".eE") == std::string_view::npos;
      groups[c] = groups[c] && c > 0 &&
                  has_thousands_separators(std::string(row[c - 1]) + "," + std::string(row[c]));
    }
  }
  if (std::ranges::find(groups, true) != groups.end() && !(whole && cells == 2 * named))
    return Commas::thousands;
  return whole && cells == 2 * named ? Commas::decimal_marks : Commas::delimiters;
}

/// Throws InputError where commas divide the rows into more cells than there are names, and may
/// stand within numbers.
void refuse_commas_within_numbers(TextFile& file, const std::vector<std::string_view>& lines,
                                  const Candidate& found) {
  if (found.dialect.delimiter != ',' || found.first_line == 0) return;
  std::size_t above = found.first_line;
  while (above > 0 && cell_value(cells_of(lines[above - 1], ',').front(), '.')) --above;
  if (above == 0) return;
  const std::string_view head = lines[above - 1];
  const std::size_t named = named_columns(head, found.dialect);
  const bool is_key = head.find_first_of(":=") != std::string_view::npos ||
                      (named == 1 && trimmed(head).find(' ') != std::string_view::npos);
  if (named == 0 || named >= found.first_row.cells || is_key) return;
  const Commas commas = judge_commas(lines, found, named);
  if (commas == Commas::delimiters) return;
  throw InputError(
      place_of(file, lines[found.first_line]),
      fmt::format(
          "the row has {} cells under the {} of line {}: commas may be {}--delimiter , takes "
          "each for the end of a cell)",
          found.first_row.cells,
          named == 1 ? std::string("one name") : fmt::format("{} names", named), above,
          commas == Commas::thousands ? "thousands separators, which are not read ("
          : named == 1                ? "decimal marks (--decimal , reads them so; "
                                      : "decimal marks too, which is not read ("));
}

/// Those that the user does not exclude.
std::vector<Dialect> possible_dialects(const ImportOptions& options) {
  std::vector<Dialect> possible;
  for (Dialect dialect : dialects) {
    if (dialect.delimiter == ':') {
      if (!options.delimiter) continue;
      dialect.delimiter =
          *options.delimiter;  // whatever the user says, also one that is not in the list
    }
    if (options.delimiter && dialect.delimiter != *options.delimiter) continue;
    const bool within_quotes = dialect.delimiter == dialect.decimal;
    if (options.decimal && within_quotes && dialect.decimal != *options.decimal) continue;
    if (options.decimal) dialect.decimal = *options.decimal;
    if (within_quotes || dialect.decimal != dialect.delimiter) possible.push_back(dialect);
  }
  return possible;
}

/// The same for rows with dates and times of day, those divided by blanks last.
std::vector<Dialect> dialects_with_dates(std::vector<Dialect> possible) {
  for (Dialect& dialect : possible) dialect.dates = true;
  std::ranges::stable_partition(possible, [](Dialect dialect) { return dialect.delimiter != ' '; });
  return possible;
}

}  // namespace

bool has_thousands_separators(std::string_view cell) {
  std::string_view rest = trimmed(without_quotes(cell));
  if (!rest.empty() && (rest.front() == '-' || rest.front() == '+')) rest.remove_prefix(1);
  const auto take_digits = [&rest] {
    std::size_t digits = 0;
    while (digits < rest.size() && detail::is_digit(rest[digits])) ++digits;
    rest.remove_prefix(digits);
    return digits;
  };
  if (rest.starts_with('0')) return false;
  const std::size_t first = take_digits();
  if (first == 0 || first > 3) return false;
  constexpr std::array<std::string_view, 9> separators = {
      ",", ".", "'", " ", "\u2019", "\u00A0", "\u202F", "\u2009", "\xA0"};
  for (const std::string_view separator : separators) {
    if (!rest.starts_with(separator)) continue;
    while (rest.starts_with(separator)) {
      rest.remove_prefix(separator.size());
      if (take_digits() != 3) return false;
    }
    if (!rest.empty() && (rest.front() == '.' || rest.front() == ',') &&
        rest.front() != separator[0]) {
      rest.remove_prefix(1);
      take_digits();
    }
    return rest.empty();
  }
  return false;
}

bool TableLayout::holds_text(std::size_t column) const {
  return std::ranges::find(text_columns, column, &TextColumn::column) != text_columns.end();
}

std::size_t TableLayout::cells_beside() const {
  std::size_t beside = 0;
  for (const DateColumns& date : dates) beside += date.last - date.first;
  return beside;
}

const DateColumns* TableLayout::dates_at(std::size_t column) const {
  for (const DateColumns& date : dates)
    if (column >= date.first && column <= date.last) return &date;
  return nullptr;
}

std::optional<double> cell_value(std::string_view cell, char decimal) {
  const std::string_view text = without_quotes(cell);
  if (is_missing(text)) return nothing;
  if (const auto value = number_in(text, {decimal, false})) return value;
  constexpr std::string_view minus = "\u2212";  // as typography has it
  if (!text.starts_with(minus)) return infinity_in(text);
  const std::string usual = "-" + std::string(text.substr(minus.size()));
  const auto value = number_in(usual, {decimal, false});
  return value ? value : infinity_in(usual);
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

  const std::vector<Dialect> possible = possible_dialects(options);
  std::optional<Candidate> best = best_of(try_dialect, lines, skipped, possible);
  if (!options.delimiter && (!best || best->dialect.delimiter == ' '))
    refuse_thousands_separators(file, lines);
  // dates hold blanks: where something else divides the rows too, that is taken
  const std::vector<Dialect> with_dates = dialects_with_dates(possible);
  const auto blanks = std::ranges::find(with_dates, ' ', &Dialect::delimiter);
  const std::span<const Dialect> by_marks(with_dates.begin(), blanks);
  const std::span<const Dialect> by_blanks(blanks, with_dates.end());
  if (!best) best = best_of(try_dialect, lines, skipped, by_marks);
  if (!best) best = best_of(try_dialect_with_text, lines, skipped, by_marks);
  if (!best) best = best_of(try_dialect, lines, skipped, by_blanks);
  if (best && !options.delimiter) refuse_commas_within_numbers(file, lines, *best);
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
  const std::size_t named =
      layout.head.empty() ? 0 : named_columns(layout.head.back(), layout.dialect);
  if (layout.dialect.dates) layout.dates = find_date_columns(file, lines, layout, named);
  find_text_columns(lines, named, layout);
  return layout;
}

}  // namespace impactrig::acquisition
