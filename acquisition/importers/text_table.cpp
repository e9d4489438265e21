// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/text_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>

#include "acquisition/importers/date_columns.hpp"
#include "acquisition/importers/date_time.hpp"
#include "acquisition/importers/instrument_heads.hpp"
#include "acquisition/importers/mts_tables.hpp"
#include "acquisition/importers/row_of_units.hpp"
#include "acquisition/importers/text_dialect.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

using datasets::InputError;

namespace {

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

/// The lines of the first 256 KiB, at most 4000 of them; where they are long, as those of thousands
/// of channels, the first few of up to 8 MiB. The last one only when it is whole.
std::vector<std::string_view> first_lines(std::string_view text) {
  constexpr std::size_t looked_at = 256 * 1024, most_looked_at = 8 * 1024 * 1024;
  constexpr std::size_t most_lines = 4000, few_lines = 16;
  std::vector<std::string_view> lines;
  const auto take_until = [&](std::size_t reach, std::size_t most) {
    lines.clear();
    const char* at = text.data();
    const char* const end = text.data() + std::min(text.size(), reach);
    while (at != end && lines.size() < most) lines.push_back(take_quoted_line(at, end));
    if (text.size() > reach && lines.size() > 1 && at == end) lines.pop_back();
  };
  take_until(looked_at, most_lines);
  if (lines.size() < few_lines && text.size() > looked_at) take_until(most_looked_at, few_lines);
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

bool begins_as_number(std::string_view cell) {
  return !cell.empty() && std::string_view("0123456789+-.").find(cell.front()) != cell.npos;
}

bool has_digit(std::string_view cell) {
  return cell.find_first_of("0123456789") != cell.npos;
}

/// "1x", "2nd sensor", "50g Acc (g)": what stands behind the number is a word, and no unit.
bool is_name_behind_a_number(std::string_view cell) {
  const std::size_t end = std::min(cell.find_first_not_of("+-.,0123456789"), cell.size());
  const std::string_view behind = trimmed(cell.substr(end));
  const auto is_letter = [](unsigned char c) { return std::isalpha(c) != 0 || c >= 0x80; };
  const bool exponent = behind.size() > 1 && (behind.front() == 'e' || behind.front() == 'E') &&
                        std::string_view("+-0123456789").find(behind[1]) != behind.npos;
  return std::ranges::any_of(behind, is_letter) && !exponent &&
         datasets::quantity_of_unit(behind) == datasets::Quantity::unknown;
}

/// True for cells that look like values and are none: "0.5 s,12 N", "12:00:00:95,9025". A date
/// above rows without dates is a fact of the head, and a rule ("-----  -----") is none at all.
bool are_spoilt_values(const std::vector<std::string_view>& cells, const TableLayout& layout) {
  return std::ranges::any_of(cells, has_digit) && cells.size() == layout.written_cells &&
         !std::ranges::all_of(cells, is_name_behind_a_number) &&
         std::ranges::all_of(cells, begins_as_number) &&
         (layout.dialect.dates || !std::ranges::all_of(cells, is_part_of_date));
}

/// True for a row of numbers that other marks divide.
bool is_row_of_other_dialect(std::string_view line, const TableLayout& layout) {
  if (layout.dialect.delimiter == ' ') return false;
  return std::ranges::any_of(std::string_view("\t;,|"), [&](char delimiter) {
    const auto cells = cells_of(line, delimiter);
    return delimiter != layout.dialect.delimiter && cells.size() > 1 &&
           cells.size() == layout.written_cells && std::ranges::all_of(cells, [](auto cell) {
             return number_in(cell, {'.', false}) || number_in(cell, {',', false});
           });
  });
}

/// The cells of a row above the first one, where it may be one too: it begins with a number and has
/// numbers in all columns but is longer or shorter, or it is as long and holds something else.
std::optional<std::size_t> cells_of_spoilt_row(std::string_view line, const TableLayout& layout) {
  if (is_row_of_other_dialect(line, layout)) return layout.written_cells;
  const auto cells = cells_of(line, layout.dialect.delimiter);
  const char decimal = layout.dialect.decimal;
  if (cells.empty()) return std::nullopt;
  if (!number_in(cells.front(), {decimal, false}))
    return are_spoilt_values(cells, layout) ? std::optional(cells.size()) : std::nullopt;
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

/// A first row that only numbers the columns from 0, as pandas writes a header where there are no
/// names: "0,1" above numbers that all have decimals, or ",0,1" above rows that begin with theirs.
void take_column_numbers(const std::vector<std::string_view>& lines, TableLayout& layout) {
  const std::size_t first = layout.head.size();
  const char delimiter = layout.dialect.delimiter;
  const auto numbers = cells_of(lines[first], delimiter);
  const std::size_t beside = numbers.front().empty() ? 1 : 0;
  if (numbers.size() < 2 || delimiter == ' ' || first + 1 == lines.size()) return;
  for (std::size_t c = beside; c < numbers.size(); ++c)
    if (numbers[c] != std::to_string(c - beside)) return;
  constexpr std::size_t rows_tried = 40;
  for (std::size_t i = first + 1; i < std::min(lines.size(), first + rows_tried); ++i) {
    if (is_skipped_line(lines[i])) continue;
    const auto row = cells_of(lines[i], delimiter);
    if (row.size() != numbers.size() || (beside == 1 && row.front().empty())) return;
    const auto may_be_whole = [](std::string_view cell) {
      return !cell.empty() && cell.find_first_not_of("+-0123456789") == cell.npos;
    };
    if (beside == 0 && std::ranges::any_of(row, may_be_whole)) return;
  }
  layout.head.push_back(lines[first]);
  layout.data = lines[first + 1].data();
  layout.column_numbers = true;
}

/// How many samples each channel has, in the row above the first of AcqKnowledge's text export.
void take_counts_of_samples(const std::vector<std::string_view>& lines, TableLayout& layout) {
  const std::size_t first = layout.head.size();
  if (first + 1 >= lines.size() || !acqknowledge_head(layout.head)) return;
  auto counts = cells_of(lines[first], layout.dialect.delimiter);
  std::erase(counts, "");
  if (counts.empty() || !integer_in(counts.front())) return;
  if (std::ranges::count(counts, counts.front()) != std::ssize(counts)) return;
  const auto row = cells_of(lines[first + 1], layout.dialect.delimiter);
  layout.head.push_back(lines[first]);
  layout.data = lines[first + 1].data();
  layout.cells = layout.written_cells = row.size();
  while (layout.cells > 1 && row[layout.cells - 1].empty()) --layout.cells;
}

/// Throws InputError where some of the first lines end with CR alone and some with LF: what stands
/// behind a CR would be read as part of a line.
void refuse_mixed_line_ends(TextFile& file, std::string_view text) {
  constexpr std::size_t looked_at = 64 * 1024;
  bool quoted = false;
  const std::string_view head = text.substr(0, looked_at);
  for (std::size_t i = 0; i + 1 < head.size(); ++i) {
    if (head[i] == '"') quoted = !quoted;
    if (quoted || head[i] != '\r' || head[i + 1] == '\n' || head[i + 1] == '\r') continue;
    throw InputError(
        file.position(head.data() + i),
        "this line ends with a carriage return alone and others with a line feed: save "
        "the file with ends of one kind");
  }
}

/// True where the head ends in a key with numbers or dates, "Time,10:11:12,10:11:12", and its keys
/// stand over cells that are empty in all rows, as Yokogawa oscilloscopes write it.
bool has_keys_above(const std::vector<std::string_view>& lines, const TableLayout& layout) {
  const char delimiter = layout.dialect.delimiter;
  std::size_t last = layout.head.size();
  while (last > 0 && trimmed(lines[last - 1]).empty()) --last;
  if (last == 0) return false;
  const auto key = cells_of(lines[last - 1], delimiter);
  const bool has_values = key.size() > 1 && !key.front().empty() &&
                          std::all_of(key.begin() + 1, key.end(), [&layout](std::string_view cell) {
                            return cell.empty() ||
                                   number_in(cell, {layout.dialect.decimal, false}) ||
                                   is_part_of_date(cell);
                          });
  return has_values && std::all_of(lines.begin() + static_cast<std::ptrdiff_t>(layout.head.size()),
                                   lines.end(), [delimiter](std::string_view line) {
                                     return is_skipped_line(line) ||
                                            cells_of(line, delimiter).front().empty();
                                   });
}

/// Which cells between numbers are empty: where tables stand side by side, keys of the further ones
/// are in such columns.
std::vector<std::size_t> gaps_of(const std::vector<std::string_view>& row, std::size_t first) {
  std::size_t end = row.size();
  while (end > first && row[end - 1].empty()) --end;
  std::vector<std::size_t> gaps;
  for (std::size_t c = first; c < end; ++c)
    if (row[c].empty()) gaps.push_back(c);
  return gaps;
}

/// The cells in `gaps` that hold the first key of the table in one of the rows with keys.
std::vector<std::size_t> find_further_keys(const std::vector<std::string_view>& key_lines,
                                           const std::vector<std::size_t>& gaps, char delimiter) {
  std::vector<std::size_t> found;
  for (const std::string_view line : key_lines) {
    const auto cells = cells_of(line, delimiter);
    for (const std::size_t c : gaps)
      if (cells[c] == cells.front()) found.push_back(c);
    if (!found.empty()) break;
  }
  return found;
}

/// A word before the first row alone, "trace_values,0.0,1.5" above ",0.1,1.6", as dSPACE writes it:
/// the line is a row. Whole numbers above decimals are inputs or ranges.
void take_row_behind_a_word(const std::vector<std::string_view>& lines, TableLayout& layout) {
  const std::size_t first = layout.head.size();
  const Dialect& dialect = layout.dialect;
  if (first == 0 || layout.written_cells < 2 || dialect.delimiter == ' ') return;
  const auto row = cells_of(lines[first], dialect.delimiter);
  const auto above = cells_of(lines[first - 1], dialect.delimiter);
  const bool word = row.size() == above.size() && row.size() > 1 && row.front().empty() &&
                    !row[1].empty() && !above.front().empty() &&
                    !cell_value(above.front(), dialect.decimal) && !is_figure_word(above.front());
  if (!word) return;
  bool decimals_above = false, decimals_below = false;
  for (std::size_t c = 1; c < row.size(); ++c) {
    if (row[c].empty() && above[c].empty()) continue;
    if (!number_in(above[c], {dialect.decimal, false})) return;
    decimals_above = decimals_above || !integer_in(above[c]);
    decimals_below = decimals_below || !integer_in(row[c]);
  }
  if (!decimals_above && decimals_below) return;
  layout.head.pop_back();
  layout.data = lines[first - 1].data();
}

/// Finds rows that hold samples too, with keys before them: "Record Length,2.5e+03,,-0.00025,0.08,"
/// above ",,,-0.00024,0.04,". Keys begin above the first row of numbers alone; further ones may
/// stand below rows without. Several such tables may stand side by side.
void take_rows_with_keys(const std::vector<std::string_view>& lines, TableLayout& layout) {
  constexpr std::size_t rows_tried = 40;
  const char delimiter = layout.dialect.delimiter;
  if (delimiter == ' ') return;
  const auto row = cells_of(lines[layout.head.size()], delimiter);
  std::size_t empty = 0;
  while (empty < row.size() && row[empty].empty()) ++empty;
  if (empty < 2 || empty >= layout.cells) return;  // a key and its value at least
  const std::vector<std::size_t> gaps = gaps_of(row, empty);
  const auto is_row = [&](std::vector<std::string_view> cells) {
    if (cells.size() != row.size()) return false;
    for (const std::size_t c : gaps) cells[c] = {};
    return numbers_from(cells, empty, layout.dialect.decimal);
  };
  std::size_t first = layout.head.size();
  while (first > 0 && is_row(cells_of(lines[first - 1], delimiter))) --first;
  const std::size_t end = std::min(lines.size(), layout.head.size() + rows_tried);
  for (std::size_t i = first; i < end; ++i) {
    if (i == layout.head.size() && layout.key_lines.empty() && !has_keys_above(lines, layout))
      return;
    const auto cells = cells_of(lines[i], delimiter);
    if (!cells.empty() && !cells.front().empty() && is_row(cells))
      layout.key_lines.push_back(lines[i]);
  }
  layout.head.resize(first);
  layout.data = lines[first].data();
  layout.key_cells = empty;
  layout.cells -= empty;
  layout.written_cells -= empty;
  layout.further_keys = find_further_keys(layout.key_lines, gaps, delimiter);
  if (layout.further_keys.empty()) return;
  for (const std::size_t c : gaps) layout.text_columns.push_back({c - empty, {}});
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
    if (is_skipped_line(lines[i])) continue;
    const auto cells = cells_of(lines[i], layout.dialect.delimiter);
    for (std::size_t c = 0; c < std::min(cells.size(), columns.size()); ++c) {
      Seen& column = columns[c];
      if (cells[c].empty() || column.number || layout.dates_at(c) != nullptr) continue;
      const auto value = cell_value(cells[c], layout.dialect.decimal);
      if (grouped_number_in(cells[c], layout.dialect.decimal))
        column.number = true;
      else if (value)
        column.number = !std::isnan(*value);
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

/// Columns of the first rows in which numbers with thousands separators would look as these do.
void find_perhaps_grouped(const std::vector<std::string_view>& lines, TableLayout& layout) {
  const Dialect& dialect = layout.dialect;
  if (layout.key_cells > 0) return;
  std::vector<GroupingCheck> checks(layout.cells, GroupingCheck(dialect.decimal));
  std::vector<bool> open(layout.cells, true);
  for (std::size_t i = layout.head.size(); i < lines.size(); ++i) {
    if (is_skipped_line(lines[i])) continue;
    const auto cells = cells_of(lines[i], dialect.delimiter);
    for (std::size_t c = 0; c < std::min(cells.size(), layout.cells); ++c) {
      const std::string_view cell = without_quotes(cells[c]);
      const auto value = cell_value(cell, dialect.decimal);
      if (!open[c] || !value || !std::isfinite(*value)) continue;
      open[c] = checks[c].see(cell) != GroupingCheck::Says::decimals;
      // the mark that is a decimal one in one column is none of thousands in another
      if (!open[c] && cell.find(dialect.decimal) != cell.npos) return;
    }
  }
  for (std::size_t c = 0; c < layout.cells; ++c)
    if (open[c] && !layout.holds_text(c) && layout.dates_at(c) == nullptr)
      layout.perhaps_grouped.push_back(c);
}

/// Behind the last row: some programs end a file with words, as "End of data", or statistics, as
/// "Max,1.2,3.4". Null where rows go on to the end, or where a row may begin with words itself.
const char* end_of_rows(std::string_view text, const TableLayout& layout) {
  constexpr std::ptrdiff_t most_bytes = 16 * 1024;
  if (layout.holds_text(0) || layout.key_cells > 0) return nullptr;
  const Dialect& dialect = layout.dialect;
  const char* const end = text.data() + text.size();
  const auto begins_as_rows_do = [&](std::string_view line) {
    const auto cells = cells_of(line, dialect.delimiter);
    const std::string_view cell = cells.empty() ? std::string_view{} : cells.front();
    if (cell_value(cell, dialect.decimal) || marks_missing(cell)) return true;
    if (layout.dates_at(0) != nullptr && date_time_in(cell)) return true;
    // half a number is one of a row that is spoilt or cut off
    return std::string_view("0123456789+-.,").find(cell.front()) != std::string_view::npos;
  };
  const char* first = layout.data;
  if (!begins_as_rows_do(take_line(first, end))) return nullptr;
  const char* found = nullptr;
  const char* bound = end;  // of what is looked at, without the rows of empty cells at the end
  for (const char* at = end; at > first;) {
    const char* start = at - 1;
    while (start > first && bound - start < most_bytes && start[-1] != '\n') --start;
    if (bound - start >= most_bytes) return nullptr;
    const char* next = start;
    const std::string_view line = take_line(next, at);
    if (has_only_empty_cells(line, dialect.delimiter)) {
      if (bound == at) bound = start;
      found = start;
    } else if (!is_skipped_line(line)) {
      if (begins_as_rows_do(line)) return found;
      found = start;
    }
    at = start;
  }
  return nullptr;
}

/// A line of numbers with words beside them ("0.0000,20.4,,Min,-3", figures that stand beside the
/// first rows) is no head: without it samples would be missing.
void refuse_words_beside_rows(const TextFile& file, const TableLayout& layout) {
  if (layout.head.empty() || layout.cells < 2 || layout.key_cells > 0 || !layout.dates.empty() ||
      layout.dialect.delimiter == ' ')
    return;
  const std::string_view line = layout.head.back();
  const std::vector<std::string_view> cells = cells_of(line, layout.dialect.delimiter);
  if (cells.size() <= layout.written_cells) return;
  const auto is_number = [&](std::string_view cell) {
    return number_in(cell, {layout.dialect.decimal, false}).has_value();
  };
  const auto beside = cells.begin() + static_cast<std::ptrdiff_t>(layout.written_cells);
  const auto word = std::find_if(beside, cells.end(),
                                 [&](auto cell) { return !cell.empty() && !is_number(cell); });
  if (word == cells.end() ||
      !std::all_of(cells.begin(), cells.begin() + static_cast<std::ptrdiff_t>(layout.cells),
                   is_number))
    return;
  throw InputError(
      file.position(line.data()),
      fmt::format("the line begins as the rows below it, but '{}' stands beside its first {} "
                  "cells: take what stands beside the rows out of the file, or state --skip-lines",
                  to_utf8(*word), layout.cells));
}

}  // namespace

bool has_only_empty_cells(std::string_view line, char delimiter) {
  if (delimiter == ' ' || line.find(delimiter) == line.npos) return false;
  return std::ranges::all_of(
      line, [delimiter](char c) { return c == delimiter || c == ' ' || c == '\t' || c == '\r'; });
}

void find_cut_row(std::string_view text, TableLayout& layout) {
  const std::string_view rows = text.substr(static_cast<std::size_t>(layout.data - text.data()));
  if (layout.end == nullptr && !text.ends_with('\n') &&
      ends_in_cut_number(rows, layout.dialect.delimiter, layout.dialect.decimal))
    layout.cut = rows.data() + rows.rfind('\n') + 1;
}

std::string_view text_of_rows(TextFile& file, const TableLayout& layout) {
  const std::string_view text = file.text();
  const char* const end = layout.end != nullptr ? layout.end : layout.cut;
  return end == nullptr ? text : text.substr(0, static_cast<std::size_t>(end - text.data()));
}

bool TableLayout::holds_text(std::size_t column) const {
  return std::ranges::find(text_columns, column, &TextColumn::column) != text_columns.end();
}

std::optional<DateTime> DateColumns::read(std::string_view cells, Dialect dialect) const {
  if (written == Written::text) return date_time_in(cells);
  if (written == Written::whole_seconds) return whole_seconds_in(without_quotes(cells));
  std::optional<DateTime> day;  // stands before the numbers as one text
  std::vector<double> numbers;
  for (const std::string_view cell : cells_of(cells, dialect.delimiter)) {
    const auto number = number_in(cell, {dialect.decimal, false});
    if (!number && numbers.empty() && !day)
      day = date_time_in(cell);
    else if (!number)
      return std::nullopt;
    else
      numbers.push_back(*number);
    if (!number && !(day && day->has_date && !day->has_time)) return std::nullopt;
  }
  const std::optional<DateTime> time = clock_of_numbers(numbers);
  if (!day || !time) return time;
  if (time->has_date || time->period == 0) return std::nullopt;
  day->has_time = true;
  day->nanoseconds = time->nanoseconds;
  return day;
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

TableLayout find_table(TextFile& file, const ImportOptions& options) {
  const std::string_view text = file.text();
  refuse_mixed_line_ends(file, text);
  const std::vector<std::string_view> lines = first_lines(text);
  std::optional<std::size_t> stated;
  if (options.skip_lines) stated = static_cast<std::size_t>(std::max(0, *options.skip_lines));
  const MtsTable of_several = mts_table(text, lines.size(), stated);
  const std::size_t skipped = std::max(stated.value_or(0), of_several.skipped_lines);

  const std::optional<DialectFound> best = find_dialect(file, lines, skipped, options);
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
  take_row_behind_a_word(lines, layout);
  take_rows_with_keys(lines, layout);
  take_column_numbers(lines, layout);
  take_counts_of_samples(lines, layout);
  const std::size_t named =
      layout.head.empty() ? 0 : named_columns(layout.head.back(), layout.dialect);
  if (layout.key_cells == 0) {  // times beside keys are in other cells than these functions know
    if (layout.dialect.dates) layout.dates = find_date_columns(file, lines, layout, named);
    if (layout.dates.empty())
      layout.dates = find_counted_clocks(lines, layout, options.time_column.has_value());
  }
  find_text_columns(lines, named, layout);
  if (!stated) refuse_words_beside_rows(file, layout);
  if (!options.decimal) find_perhaps_grouped(lines, layout);
  if (file.is_part()) return layout;
  layout.table_above = of_several.above;
  layout.end = of_several.end != nullptr ? of_several.end : end_of_rows(text, layout);
  find_cut_row(text, layout);
  return layout;
}

}  // namespace impactrig::acquisition
