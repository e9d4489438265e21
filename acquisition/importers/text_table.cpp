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

/// The value of a cell however it is written; NaN for a missing one, none for anything that is no
/// number.
std::optional<double> cell_value(std::string_view cell, char decimal) {
  const std::string_view text = without_quotes(cell);
  if (is_missing(text)) return nothing;
  if (const auto value = number_in(text, {decimal, false})) return value;
  return infinity_in(text);
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

/// Reads rows with one pass over the text and no allocation a cell.
class RowReader {
 public:
  RowReader(TextFile& file, const TableLayout& layout, const std::vector<std::string>& names)
      : file_(file),
        names_(names),
        delimiter_(layout.dialect.delimiter),
        style_{layout.dialect.decimal, false},
        at_(layout.data) {
    const std::string_view text = file.text();
    end_ = text.data() + text.size();
    table_.columns.resize(names.size());
    const char* probe = at_;
    const std::size_t row_bytes = take_line(probe, end_).size() + 1;
    const std::size_t rows = static_cast<std::size_t>(end_ - at_) / row_bytes;
    for (Column& column : table_.columns) column.values.reserve(rows + rows / 8 + 1);
  }

  Table read() {
    while (at_ != end_) read_line();
    return std::move(table_);
  }

 private:
  bool at_line_end() const { return at_ == end_ || *at_ == '\n' || *at_ == '\r'; }

  bool is_blank(char c) const { return c == ' ' || (c == '\t' && delimiter_ != '\t'); }

  void skip_blanks() {
    while (at_ != end_ && is_blank(*at_)) ++at_;
  }

  void skip_line_end() {
    while (at_ != end_ && *at_ == '\r') ++at_;
    if (at_ != end_ && *at_ == '\n') ++at_;
  }

  void read_line() {
    const char* const line = at_;
    skip_blanks();
    if (at_line_end()) return skip_line_end();
    if (*at_ == '#' || *at_ == '%') {
      take_line(at_, end_);
      return;
    }
    const std::size_t n = table_.columns.size();
    for (std::size_t c = 0; c < n; ++c) {
      if (!read_cell(c)) return;
      if (c + 1 == n) break;
      if (delimiter_ != ' ' && at_ != end_ && *at_ == delimiter_) {
        ++at_;
        continue;
      }
      if (at_line_end()) return short_row(line, c + 1);
    }
    finish_row();
    ++table_.rows;
  }

  /// Reads a cell and the blanks behind it; false when the row has ended in a way that is dealt
  /// with.
  bool read_cell(std::size_t c) {
    skip_blanks();
    Column& column = table_.columns[c];
    double value = 0.0;
    const char* q = scan_number(at_, end_, style_, value);
    if (q != at_) {
      while (q != end_ && is_blank(*q)) ++q;
      const bool ends = q == end_ || *q == '\n' || *q == '\r' || *q == delimiter_ ||
                        (delimiter_ == ' ' && q[-1] <= ' ');
      if (ends) {
        column.values.push_back(value);
        if (!column.valid.empty()) column.valid.push_back(1);
        at_ = q;
        return true;
      }
    }
    unusual_cell(c);
    return true;
  }

  /// Anything but a plain number: quoted, missing, infinite, or an error.
  void unusual_cell(std::size_t c) {
    const char* const start = at_;
    bool quoted = false;
    while (at_ != end_ && *at_ != '\n' && *at_ != '\r' && (quoted || !ends_cell(*at_))) {
      if (*at_ == '"') quoted = !quoted;
      ++at_;
    }
    const std::string_view cell(start, static_cast<std::size_t>(at_ - start));
    skip_blanks();
    const auto value = cell_value(cell, style_.decimal);
    if (!value) {
      const std::string found = to_utf8(trimmed(cell).substr(0, 40));
      const bool out_of_range = std::all_of(found.begin(), found.end(), [this](char letter) {
        return detail::is_digit(letter) || letter == style_.decimal ||
               std::strchr("+-eEdD", letter) != nullptr;
      });
      const bool has_digit = std::any_of(found.begin(), found.end(), detail::is_digit);
      throw InputError(file_.position(start),
                       out_of_range && has_digit && scan_only(cell)
                           ? fmt::format("{}: {} does not fit a double", names_[c], found)
                           : fmt::format("{}: expected a number, found '{}'", names_[c], found));
    }
    Column& column = table_.columns[c];
    if (std::isnan(*value)) {
      if (column.valid.empty()) {
        column.valid.reserve(column.values.capacity());
        column.valid.assign(column.values.size(), 1);
      }
      if (column.missing++ == 0) column.first_missing = start;
      column.values.push_back(nothing);
      column.valid.push_back(0);
    } else {
      column.values.push_back(*value);
      if (!column.valid.empty()) column.valid.push_back(1);
    }
  }

  /// True when a cell has the form of a number, whatever its size.
  bool scan_only(std::string_view cell) const {
    const std::size_t exponent = cell.find_first_of("eEdD");
    return exponent != std::string_view::npos &&
           number_in(cell.substr(0, exponent), style_).has_value() &&
           integer_in(cell.substr(exponent + 1)).has_value();
  }

  bool ends_cell(char c) const {
    return delimiter_ == ' ' ? (c == ' ' || c == '\t') : c == delimiter_;
  }

  /// Only empty cells may follow the last column.
  void finish_row() {
    while (at_ != end_ && (is_blank(*at_) || *at_ == delimiter_)) ++at_;
    if (!at_line_end()) {
      const char* const extra = at_;
      const std::string_view rest = trimmed(take_line(at_, end_)).substr(0, 40);
      throw InputError(file_.position(extra),
                       fmt::format("the row goes on with '{}' after its {} {}", to_utf8(rest),
                                   names_.size(), names_.size() == 1 ? "cell" : "cells"));
    }
    skip_line_end();
  }

  void short_row(const char* line, std::size_t cells) {
    if (at_ == end_ && table_.rows > 0) {  // the file ends here: drop what was begun
      for (Column& column : table_.columns) {
        if (column.values.size() > table_.rows) column.values.resize(table_.rows);
        if (!column.valid.empty() && column.valid.size() > table_.rows) {
          if (column.valid.back() == 0) --column.missing;
          column.valid.resize(table_.rows);
        }
      }
      table_.cut_row = line;
      return;
    }
    throw InputError(file_.position(line),
                     fmt::format("the row has {} {}, expected {} ({} is missing)", cells,
                                 cells == 1 ? "cell" : "cells", names_.size(), names_[cells]));
  }

  TextFile& file_;
  const std::vector<std::string>& names_;
  char delimiter_;
  NumberStyle style_;
  const char* at_;
  const char* end_ = nullptr;
  Table table_;
};

}  // namespace

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
  return layout;
}

Table read_table(TextFile& file, const TableLayout& layout, const std::vector<std::string>& names) {
  return RowReader(file, layout, names).read();
}

std::string missing_values(const TextFile& file, const std::string& name, const Column& column) {
  if (column.missing == 0) return {};
  return fmt::format("'{}': {} of {} values {} missing, the first at {}; marked as not valid", name,
                     column.missing, column.values.size(), column.missing == 1 ? "is" : "are",
                     file.position(column.first_missing).text());
}

std::string cut_row(const TextFile& file, const Table& table) {
  if (table.cut_row == nullptr) return {};
  return fmt::format("the file ends within the row at {}: this row is left out",
                     file.position(table.cut_row).text());
}

}  // namespace impactrig::acquisition
