// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/text_dialect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "acquisition/importers/column_heads.hpp"
#include "acquisition/importers/date_columns.hpp"

namespace impactrig::acquisition {

using datasets::InputError;

namespace {

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
    {':', '.'},  // never chosen by itself: see possible_dialects
}};

std::optional<double> value_of(std::string_view cell, Dialect dialect) {
  const auto value = cell_value(cell, dialect.decimal);
  return value || !dialect.grouped ? value : grouped_number_in(cell, dialect.decimal);
}

bool is_value(std::string_view cell, Dialect dialect) {
  return value_of(cell, dialect) || (dialect.dates && is_part_of_date(cell));
}

RowShape shape_of(std::string_view line, Dialect dialect) {
  RowShape shape;
  bool numbers_only = true;
  bool any = false;
  for (const std::string_view cell : cells_of(line, dialect.delimiter)) {
    ++shape.written_cells;
    if (!cell.empty()) shape.cells = shape.written_cells;
    const auto value = value_of(cell, dialect);
    if (!value && !is_value(cell, dialect)) numbers_only = false;
    if (value && !std::isnan(*value)) any = true;
  }
  shape.numeric = numbers_only && any;
  return shape;
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

/// Looks at lines from `from`; a first row is a row of numbers that is followed by another of as
/// many cells, or by the end.
std::optional<DialectFound> try_dialect(const std::vector<std::string_view>& lines,
                                        std::size_t from, Dialect dialect) {
  constexpr std::size_t rows_tried = 40;
  for (std::size_t i = from; i < lines.size(); ++i) {
    if (is_skipped_line(lines[i])) continue;
    const RowShape first = shape_of(lines[i], dialect);
    if (!first.numeric) continue;
    std::size_t next = i + 1;
    while (next < lines.size() && is_skipped_line(lines[next])) ++next;
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
    DialectFound found{dialect, i, first, 0, 0};
    for (std::size_t k = i; k < lines.size() && k < i + rows_tried; ++k)
      if (!is_skipped_line(lines[k]) && shape_of(lines[k], dialect).numeric) ++found.numeric_lines;
    return found;
  }
  return std::nullopt;
}

/// Where the text of rows with text may stand.
enum class TextCells { behind_the_first, anywhere };

/// The numbers of a row that begins with one (or a date) and holds another, whatever its other
/// cells are; or, with text anywhere, of one that holds two; 0 of other lines.
std::size_t numbers_beside_text(std::string_view line, Dialect dialect, TextCells text) {
  const auto cells = cells_of(line, dialect.delimiter);
  const auto is_number = [dialect](std::string_view cell) {
    return number_in(cell, {dialect.decimal, false}).has_value();
  };
  const auto numbers = static_cast<std::size_t>(std::ranges::count_if(cells, is_number));
  if (text == TextCells::anywhere) return numbers > 1 ? numbers : 0;
  const bool begins = cells.size() > 1 && (is_number(cells.front()) ||
                                           (dialect.dates && is_part_of_date(cells.front())));
  return begins && std::any_of(cells.begin() + 1, cells.end(), is_number) ? numbers : 0;
}

/// The same where each row holds text, under as many names: a first row is followed by another with
/// numbers, or by the end.
std::optional<DialectFound> try_dialect_with_text(const std::vector<std::string_view>& lines,
                                                  std::size_t from, Dialect dialect,
                                                  TextCells text) {
  if (dialect.delimiter == ' ' || dialect.delimiter == dialect.decimal) return std::nullopt;
  std::optional<DialectFound> found;
  for (std::size_t i = from; i < lines.size(); ++i) {
    if (is_skipped_line(lines[i])) continue;
    const std::size_t numbers = numbers_beside_text(lines[i], dialect, text);
    if (numbers == 0 && !found) continue;
    if (numbers == 0) {
      if (found->numeric_lines > 1) break;
      found.reset();
      continue;
    }
    if (!found) {
      found = DialectFound{dialect, i, shape_of(lines[i], dialect), 0, 0};
      if (i == 0 || named_columns(lines[i - 1], dialect) < found->first_row.cells)
        return std::nullopt;
    }
    ++found->numeric_lines;
    found->numbers += numbers;
  }
  return found;
}

/// True where one name with a unit stands over rows of several cells: their commas are decimal
/// marks then, if they can be.
bool has_one_name(const std::vector<std::string_view>& lines, const DialectFound& found) {
  if (found.first_line == 0 || found.dialect.delimiter != ',') return false;
  const std::string_view above = trimmed(lines[found.first_line - 1]);
  return named_columns(above, found.dialect) == 1 && above.find_first_of(":=") == above.npos &&
         above.ends_with(']') && found.first_row.cells > 1;
}

bool better(const std::vector<std::string_view>& lines, const DialectFound& a,
            const DialectFound& b) {
  // an early start explains more of the file than a late one, but only if it holds: count rows
  // first
  if (a.numeric_lines != b.numeric_lines) return a.numeric_lines > b.numeric_lines;
  if (a.numbers != b.numbers) return a.numbers > b.numbers;
  if (has_one_name(lines, a) != has_one_name(lines, b)) return has_one_name(lines, b);
  return a.first_row.cells > b.first_row.cells;
}

template <typename Try>
std::optional<DialectFound> best_of(const Try& try_one, const std::vector<std::string_view>& lines,
                                    std::size_t from, std::span<const Dialect> possible) {
  std::optional<DialectFound> best;
  for (const Dialect dialect : possible) {
    const auto candidate = try_one(lines, from, dialect);
    if (candidate && (!best || better(lines, *candidate, *best))) best = candidate;
  }
  return best;
}

datasets::SourcePosition place_of(TextFile& file, std::string_view text) {
  return file.position(text.data());
}

/// A number with thousands separators beside numbers alone; none where there is none.
std::optional<std::string_view> separated_number(const std::vector<std::string_view>& lines) {
  for (const std::string_view line : lines) {
    if (is_skipped_line(line)) continue;
    for (const char delimiter : {'\t', ';', ',', '|'}) {
      const auto cells = cells_of(line, delimiter);
      const auto separated = std::ranges::find_if(cells, has_thousands_separators);
      const bool others_are_numbers = std::ranges::all_of(cells, [](std::string_view cell) {
        return cell_value(cell, '.') || cell_value(cell, ',') || has_thousands_separators(cell);
      });
      if (cells.size() > 1 && separated != cells.end() && others_are_numbers) return *separated;
    }
  }
  return std::nullopt;
}

/// The dialect of rows with thousands separators; `by_blanks` is what explains the rows without
/// them. Throws InputError where either may be meant.
DialectFound find_grouped(TextFile& file, const std::vector<std::string_view>& lines,
                          std::size_t from, std::vector<Dialect> possible,
                          std::string_view separated,
                          const std::optional<DialectFound>& by_blanks) {
  std::erase_if(possible, [](Dialect dialect) { return dialect.delimiter == ' '; });
  for (Dialect& dialect : possible) dialect.grouped = true;
  const auto grouped = best_of(try_dialect, lines, from, possible);
  const bool explains_as_much = grouped && by_blanks &&
                                grouped->first_line <= by_blanks->first_line &&
                                grouped->numeric_lines >= by_blanks->numeric_lines;
  if (by_blanks && !explains_as_much) return *by_blanks;
  // blanks may divide "1,234 100,567" too
  if (grouped && !(by_blanks && grouped->dialect.delimiter == ',')) return *grouped;
  throw InputError(place_of(file, separated),
                   fmt::format("'{}': it may have thousands separators or decimals, and the "
                               "file's others do not tell which",
                               to_utf8(separated)));
}

/// What commas may be that give rows more cells than there are names.
enum class Commas { delimiters, thousands, decimal_marks };

Commas judge_commas(const std::vector<std::string_view>& lines, const DialectFound& found,
                    std::size_t named) {
  constexpr std::size_t rows_tried = 40;
  const std::size_t cells = found.first_row.cells;
  std::vector<bool> groups(cells, true);  // by column: goes on with the digits of the one before
  bool whole = true;                      // no cell has decimals
  for (std::size_t i = found.first_line; i < lines.size() && i < found.first_line + rows_tried;
       ++i) {
    if (is_skipped_line(lines[i])) continue;
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
                                  const DialectFound& found) {
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
  std::stable_partition(possible.begin(), possible.end(),
                        [](Dialect dialect) { return dialect.delimiter != ' '; });
  return possible;
}

/// LabVIEW SignalExpress writes the channels' names below "channel names:", with tabs between them:
/// where there is no tab there is one channel, and commas are decimal marks.
bool is_divided_by_tabs(const std::vector<std::string_view>& lines) {
  return lines.size() > 1 && lowered(trimmed(lines[0])) == "channel names:" &&
         (lines[1].find('\t') != lines[1].npos || lines[1].find_first_of(",;") == lines[1].npos);
}

}  // namespace

bool is_skipped_line(std::string_view line) {
  const std::string_view text = trimmed(line);
  return text.empty() || text.front() == '#' || text.front() == '%';
}

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

std::optional<DialectFound> find_dialect(TextFile& file, const std::vector<std::string_view>& lines,
                                         std::size_t from, const ImportOptions& options) {
  std::vector<Dialect> possible = possible_dialects(options);
  if (!options.delimiter && is_divided_by_tabs(lines))
    std::erase_if(possible, [](Dialect dialect) { return dialect.delimiter != '\t'; });
  std::optional<DialectFound> best = best_of(try_dialect, lines, from, possible);
  if (!best || (!options.delimiter && best->dialect.delimiter == ' '))
    if (const auto separated = separated_number(lines))
      best = find_grouped(file, lines, from, possible, *separated, best);
  // dates hold blanks: where something else divides the rows too, that is taken
  const std::vector<Dialect> with_dates = dialects_with_dates(possible);
  const auto blanks = std::ranges::find(with_dates, ' ', &Dialect::delimiter);
  const std::span<const Dialect> by_marks(with_dates.begin(), blanks);
  const std::span<const Dialect> by_blanks(blanks, with_dates.end());
  if (!best) best = best_of(try_dialect, lines, from, by_marks);
  const auto with_text = [](TextCells text) {
    return [text](const std::vector<std::string_view>& all, std::size_t first, Dialect dialect) {
      return try_dialect_with_text(all, first, dialect, text);
    };
  };
  if (!best) best = best_of(with_text(TextCells::behind_the_first), lines, from, by_marks);
  if (!best) best = best_of(try_dialect, lines, from, by_blanks);
  if (!best) best = best_of(with_text(TextCells::anywhere), lines, from, by_marks);
  for (Dialect& dialect : possible) dialect.grouped = dialect.delimiter != ' ';
  if (!best) best = best_of(try_dialect, lines, from, possible);
  if (best && !options.delimiter) refuse_commas_within_numbers(file, lines, *best);
  return best;
}

}  // namespace impactrig::acquisition
