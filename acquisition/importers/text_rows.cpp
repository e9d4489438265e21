// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <limits>

#include "acquisition/importers/text_table.hpp"

namespace impactrig::acquisition {

using datasets::InputError;

namespace {

constexpr std::string_view thousands_hint =
    ": it may have thousands separators or decimals, and the file's others do not tell which";

constexpr std::string_view table_hint = ": does another table begin here? Keep one in a file";

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
constexpr char no_decimal = '\0';

void append(Column& column, double value) {
  column.values.push_back(value);
  if (!column.valid.empty()) column.valid.push_back(1);
}

void append_missing(Column& column, const char* at, std::string_view mark = {}) {
  if (column.valid.empty()) {
    column.valid.reserve(column.values.capacity());
    column.valid.assign(column.values.size(), 1);
  }
  if (column.missing++ == 0) {
    column.first_missing = at;
    column.mark = mark;
  }
  column.values.push_back(nothing);
  column.valid.push_back(0);
}

}  // namespace

RowReader::RowReader(TextFile& file, const TableLayout& layout,
                     const std::vector<std::string>& names)
    : file_(file),
      names_(names),
      delimiter_(layout.dialect.delimiter),
      key_cells_(layout.key_cells),
      decimal_(layout.dialect.decimal),
      style_{decimal_ == delimiter_ ? no_decimal : decimal_, false},
      at_(layout.data),
      layout_(layout),
      required_(names.size()) {
  const std::string_view text = text_of_rows(file, layout);
  end_ = text.data() + text.size();
  while (required_ > 1 && layout.holds_text(required_ - 1)) --required_;
  if (key_cells_ == 0 && !layout.holds_text(0) && layout.dates_at(0) == nullptr)
    for (const std::string_view line : layout.head)
      if (!trimmed(line).empty()) last_of_head_ = trimmed(line);
  read_only(std::vector<bool>(names.size(), true));
}

void RowReader::read_only(const std::vector<bool>& needed) {
  uses_.assign(needed.size(), Use::skipped);
  for (std::size_t c = 0; c < needed.size(); ++c)
    if (needed[c] && !layout_.holds_text(c)) uses_[c] = Use::number;
  for (const std::size_t column : layout_.perhaps_grouped)
    if (uses_[column] == Use::number) {
      uses_[column] = Use::perhaps_grouped;
      groupings_.try_emplace(column, decimal_);
    }
  for (const CountedColumn& column : layout_.counted)
    if (uses_[column.column] == Use::number) uses_[column.column] = Use::counted;
  for (const DateColumns& date : layout_.dates) {
    const bool used = needed[date.last];
    for (std::size_t c = date.first; c <= date.last; ++c) uses_[c] = Use::skipped;
    if (!used) continue;
    uses_[date.first] = Use::date_begins;
    uses_[date.last] = Use::date;
  }
}

Table RowReader::read(std::size_t most) {
  table_ = {};
  table_.columns.resize(names_.size());
  const char* probe = at_;
  const std::size_t row_bytes = take_line(probe, end_).size() + 1;
  const std::size_t rows = std::min(most, static_cast<std::size_t>(end_ - at_) / row_bytes);
  for (std::size_t c = 0; c < names_.size(); ++c)
    if (uses_[c] != Use::skipped) table_.columns[c].values.reserve(rows + rows / 8 + 1);
  while (at_ != end_ && table_.rows < most && table_.cut_row == nullptr) read_line();
  return std::move(table_);
}

void RowReader::skip_blanks() {
  while (at_ != end_ && is_blank(*at_)) ++at_;
}

void RowReader::skip_line_end() {
  while (at_ != end_ && *at_ == '\r') ++at_;
  if (at_ != end_ && *at_ == '\n') ++at_;
}

void RowReader::read_line() {
  const char* const line = at_;
  skip_blanks();
  if (at_line_end()) return skip_line_end();
  if (*at_ == '#' || *at_ == '%') {
    if (comment_ == nullptr) comment_ = line;
    take_line(at_, end_);
    return;
  }
  if (pass_over_repeated_head()) return;
  if (comment_ != nullptr) {
    if (table_.comment == nullptr) table_.comment = comment_;
    comment_ = nullptr;
  }
  skip_key_cells();
  date_from_ = nullptr;
  const std::size_t n = table_.columns.size();
  for (std::size_t c = 0; c < n; ++c) {
    switch (uses_[c]) {
      case Use::number:
        if (!read_cell(c)) return short_row(line, c);
        break;
      case Use::perhaps_grouped:
        if (!read_perhaps_grouped(c)) return short_row(line, c);
        break;
      case Use::counted:
        if (!read_counted(c)) return short_row(line, c);
        break;
      case Use::date:
        if (!read_date(c)) return short_row(line, c);
        break;
      case Use::date_begins:
        skip_blanks();
        date_from_ = at_;
        [[fallthrough]];
      case Use::skipped:
        skip_cell();
    }
    if (c + 1 == n) break;
    if (delimiter_ != ' ' && at_ != end_ && *at_ == delimiter_) {
      ++at_;
      continue;
    }
    if (at_line_end()) {
      if (c + 1 < required_) return short_row(line, c + 1);
      break;
    }
  }
  finish_row(line);
  ++table_.rows;
  first_row_ = false;
}

/// "Data Acquisition", names and units that stand again above further rows, as testing machines
/// write them every so often: a line that begins with a letter, and soon the last one of the head.
bool RowReader::pass_over_repeated_head() {
  constexpr int most_lines = 16;
  const auto begins_words = [](char c) {
    return c == '"' || std::isalpha(static_cast<unsigned char>(c)) != 0 ||
           static_cast<unsigned char>(c) >= 0x80;
  };
  if (last_of_head_.empty() || !begins_words(*at_) || !begins_words(last_of_head_.front()))
    return false;
  const char* ahead = at_;
  for (int line = 0; line < most_lines && ahead != end_; ++line) {
    if (trimmed(take_line(ahead, end_)) != last_of_head_) continue;
    if (table_.repeated_head == nullptr) table_.repeated_head = at_;
    at_ = ahead;
    return true;
  }
  return false;
}

void RowReader::skip_key_cells() {
  for (std::size_t c = 0; c < key_cells_; ++c) {
    while (!at_line_end() && *at_ != delimiter_) ++at_;
    if (!at_line_end()) ++at_;
  }
}

/// Reads a cell and the blanks behind it. False where the file's end cuts it off.
bool RowReader::read_cell(std::size_t c) {
  skip_blanks();
  Column& column = table_.columns[c];
  double value = 0.0;
  const char* q = scan_number(at_, end_, style_, value);
  if (q != at_) {
    while (q != end_ && is_blank(*q)) ++q;
    const bool ends = q == end_ || *q == '\n' || *q == '\r' || *q == delimiter_ ||
                      (delimiter_ == ' ' && q[-1] <= ' ');
    if (ends) {
      if (std::abs(value) > 9e37 && stands_for_no_value(value))
        append_missing(column, at_, trimmed({at_, static_cast<std::size_t>(q - at_)}));
      else
        append(column, value);
      at_ = q;
      return true;
    }
  }
  return unusual_cell(c);
}

/// The same, until the column's numbers tell whether they have decimals or thousands separators,
/// which is an error.
bool RowReader::read_perhaps_grouped(std::size_t c) {
  skip_blanks();
  const char* const start = at_;
  if (!read_cell(c)) return false;
  if (!std::isfinite(table_.columns[c].values.back())) return true;
  const std::string_view cell =
      trimmed(without_quotes(trimmed({start, static_cast<std::size_t>(at_ - start)})));
  const auto says = groupings_.at(c).see(cell);
  if (says == GroupingCheck::Says::decimals) uses_[c] = Use::number;
  if (says == GroupingCheck::Says::thousands)
    throw InputError(
        file_.position(start),
        fmt::format("{}: '{}' may have thousands separators: all numbers with a '{}' here have "
                    "three digits behind it, those below 1000 have none; write them without "
                    "separators (--decimal {} says that they are decimals)",
                    names_[c], to_utf8(cell), decimal_, decimal_));
  return true;
}

/// The same as read_cell(), less the first of the column as it is written.
bool RowReader::read_counted(std::size_t c) {
  skip_blanks();
  const char* const start = at_;
  if (!read_cell(c)) return false;
  double& value = table_.columns[c].values.back();
  if (!std::isfinite(value)) return true;
  std::string_view cell = trimmed({start, static_cast<std::size_t>(at_ - start)});
  if (cell.size() > 1 && cell.front() == '"') cell = cell.substr(1, cell.size() - 2);
  const auto counted = std::ranges::find(layout_.counted, c, &CountedColumn::column);
  const NumberStyle style{decimal_, false};
  if (const auto difference = decimal_difference(cell, counted->first, style))
    value = *difference;
  else
    value -= number_in(counted->first, style).value_or(0.0);
  return true;
}

void RowReader::skip_cell() {
  skip_blanks();
  bool quoted = false;
  while (!at_line_end() && (quoted || !ends_cell(*at_))) {
    if (*at_ == '"') quoted = !quoted;
    ++at_;
  }
  skip_blanks();
}

/// Reads a date and time of day, which may have begun in a cell before this one. False where the
/// file's end cuts it off.
bool RowReader::read_date(std::size_t c) {
  skip_blanks();
  const char* const start = date_from_ == nullptr ? at_ : date_from_;
  const DateColumns& date = *layout_.dates_at(c);
  const char* end_of_date = at_;  // where a fraction follows
  const auto fraction = read_fraction(date);
  if (date.fraction == 0) end_of_date = at_;
  std::string_view text = trimmed({start, static_cast<std::size_t>(end_of_date - start)});
  if (date.fraction > 0 && text.ends_with(delimiter_))
    text = trimmed(text.substr(0, text.size() - 1));
  const DateTime& base = date.base;
  auto time = date.read(text, layout_.dialect);
  if (time && fraction) time->nanoseconds += *fraction;
  if (!fraction) time.reset();
  const auto seconds = time ? seconds_between(base, *time) : std::nullopt;
  const auto value = seconds ? seconds : cell_value(text, decimal_);
  if (seconds) {
    append(table_.columns[c], *seconds);
  } else if (value && std::isnan(*value)) {
    append_missing(table_.columns[c], start);
  } else if (at_ == end_ && !first_row_) {
    return false;
  } else {
    const bool any_day = time && base.has_date && time->has_date && base.has_time == time->has_time;
    const std::string& name = names_[date.fraction > 0 ? c - 1 : c];
    const std::string found =
        to_utf8(trimmed({start, static_cast<std::size_t>(at_ - start)}).substr(0, 40));
    throw InputError(
        file_.position(start),
        any_day
            ? fmt::format("{}: '{}' is not of the first row's day, and does not tell day, month "
                          "and year apart: write dates as 2024-12-31",
                          name, found)
            : fmt::format("{}: expected a date and time as in the first row, found '{}'", name,
                          found));
  }
  return true;
}

/// Passes the last cell of a date and gives what it adds to it [ns]; none where it should and does
/// not.
std::optional<std::int64_t> RowReader::read_fraction(const DateColumns& date) {
  const char* const start = at_;
  skip_cell();
  if (date.fraction == 0) return 0;
  const auto count =
      integer_in(without_quotes(trimmed({start, static_cast<std::size_t>(at_ - start)})));
  constexpr std::int64_t second = 1'000'000'000;
  if (!count || *count < 0 || *count >= second / date.fraction) return std::nullopt;
  return *count * date.fraction;
}

/// Whether the line from `start` on has words alone, or not as many cells as a row.
bool RowReader::may_begin_table(const char* start) const {
  const auto cells = cells_of(take_line(start, end_), delimiter_);
  return cells.size() != names_.size() ||
         std::ranges::none_of(cells, [this](std::string_view cell) {
           return !cell.empty() && cell_value(cell, decimal_).has_value();
         });
}

/// Anything but a plain number: quoted, missing, infinite, cut by the file's end (false), or an
/// error.
bool RowReader::unusual_cell(std::size_t c) {
  const char* const start = at_;
  bool quoted = false;
  while (at_ != end_ && *at_ != '\n' && *at_ != '\r' && (quoted || !ends_cell(*at_))) {
    if (*at_ == '"') quoted = !quoted;
    ++at_;
  }
  const std::string_view cell = trimmed({start, static_cast<std::size_t>(at_ - start)});
  skip_blanks();
  auto value = cell_value(cell, decimal_);
  if (!value) value = grouped_number_in(cell, decimal_);
  if (!value && marks_missing(cell)) {
    append_missing(table_.columns[c], start, cell);
    return true;
  }
  if (!value && at_ == end_ && !first_row_ && begins_number(cell)) return false;
  if (!value) {
    const std::string found = to_utf8(cell.substr(0, 40));
    const bool out_of_range = std::all_of(found.begin(), found.end(), [this](char letter) {
      return detail::is_digit(letter) || letter == decimal_ ||
             std::strchr("+-eEdD", letter) != nullptr;
    });
    const bool has_digit = std::any_of(found.begin(), found.end(), detail::is_digit);
    throw InputError(file_.position(start),
                     out_of_range && has_digit && scan_only(cell)
                         ? fmt::format("{}: {} does not fit a double", names_[c], found)
                         : fmt::format("{}: expected a number, found '{}'{}", names_[c], found,
                                       has_thousands_separators(cell)     ? thousands_hint
                                       : c == 0 && may_begin_table(start) ? table_hint
                                                                          : ""));
  }
  if (std::isnan(*value))
    append_missing(table_.columns[c], start);
  else if (stands_for_no_value(*value))
    append_missing(table_.columns[c], start, cell);
  else
    append(table_.columns[c], *value);
  return true;
}

/// True for "-2.9e-": what a number begins with that lacks digits.
bool RowReader::begins_number(std::string_view cell) const {
  return number_in(std::string(cell) + "0", style_).has_value();
}

/// True when a cell has the form of a number, whatever its size.
bool RowReader::scan_only(std::string_view cell) const {
  const std::size_t exponent = cell.find_first_of("eEdD");
  return exponent != std::string_view::npos &&
         number_in(cell.substr(0, exponent), style_).has_value() &&
         integer_in(cell.substr(exponent + 1)).has_value();
}

/// Only empty cells may follow the last column, and a remark: "#* hit", as LabChart writes them.
void RowReader::finish_row(const char* line) {
  while (at_ != end_ && (is_blank(*at_) || *at_ == delimiter_)) ++at_;
  if (!at_line_end() && *at_ == '#') {
    if (table_.remark == nullptr) table_.remark = at_;
    while (!at_line_end()) ++at_;
  }
  if (!at_line_end()) {
    const char* const extra = at_;
    const std::string_view rest = trimmed(take_line(at_, end_)).substr(0, 40);
    const char* before = extra;  // of what goes on, with the cell before it
    for (int commas = 0; before != line && commas < 2; --before)
      if (before[-1] == ',' && ++commas == 2) break;
    const std::string_view last(before, static_cast<std::size_t>(extra - before) + rest.size());
    throw InputError(file_.position(extra),
                     fmt::format("the row goes on with '{}' after its {} {}{}", to_utf8(rest),
                                 names_.size(), names_.size() == 1 ? "cell" : "cells",
                                 delimiter_ == ',' && has_thousands_separators(last)
                                     ? ": commas may be thousands separators, which are not read"
                                     : ""));
  }
  skip_line_end();
}

void RowReader::short_row(const char* line, std::size_t cells) {
  if (at_ == end_ && !first_row_) {  // the file ends here: drop what was begun
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

Table read_table(TextFile& file, const TableLayout& layout, const std::vector<std::string>& names) {
  return RowReader(file, layout, names).read(std::numeric_limits<std::size_t>::max());
}

std::string missing_values(const TextFile& file, const std::string& name, const Column& column,
                           std::uint64_t rows) {
  if (column.missing == 0) return {};
  return fmt::format(
      "'{}': {} of {} values {} missing, the first{} at {}; marked as not valid", name,
      column.missing, rows, column.missing == 1 ? "is" : "are",
      column.mark.empty() ? "" : fmt::format(", written '{}',", to_utf8(column.mark.substr(0, 40))),
      file.position(column.first_missing).text());
}

std::string what_follows(TextFile& file, const TableLayout& layout) {
  if (layout.end == nullptr) return {};
  const std::string_view text = file.text();
  const char* const end = text.data() + text.size();
  const char delimiter = layout.dialect.delimiter;
  const char* at = layout.end;
  std::string_view line;
  while (at != end && (trimmed(line).empty() || has_only_empty_cells(line, delimiter)))
    line = take_line(at, end);
  if (has_only_empty_cells(line, delimiter)) return {};
  return fmt::format("no rows follow at {}: '{}' and what comes behind it is left out",
                     file.position(line.data()).text(), to_utf8(trimmed(line).substr(0, 40)));
}

std::string table_above(const TextFile& file, const TableLayout& layout) {
  if (layout.table_above.empty()) return {};
  return fmt::format(
      "of several tables the one of most rows is read: that from {} on ('{}') is left out "
      "(--skip-lines 0 begins with it)",
      file.position(layout.table_above.data()).text(), to_utf8(layout.table_above.substr(0, 40)));
}

namespace {

/// How a number is written: digits behind its mark and of its exponent.
struct Digits {
  std::size_t decimals = 0;
  std::size_t exponent = 0;
};

Digits digits_of(std::string_view number, char decimal) {
  const std::size_t letter = std::min(number.find_first_of("eE"), number.size());
  const std::string_view mantissa = number.substr(0, letter);
  const std::size_t mark = mantissa.find(decimal);
  const auto digits = std::ranges::count_if(number.substr(letter), detail::is_digit);
  return {.decimals = mark == mantissa.npos ? 0 : mantissa.size() - mark - 1,
          .exponent = static_cast<std::size_t>(digits)};
}

}  // namespace

bool ends_in_cut_number(std::string_view rows, char delimiter, char decimal) {
  constexpr int most_compared = 16, least_compared = 3;
  const auto take_last_line = [&rows] {
    const std::size_t before = rows.rfind('\n');
    const std::string_view line = rows.substr(before + 1);  // npos + 1 is 0
    rows = rows.substr(0, before == std::string_view::npos ? 0 : before);
    return line;
  };
  const auto last_row = cells_of(take_last_line(), delimiter);
  if (last_row.empty() || last_row.back().empty()) return false;
  Digits least{.decimals = last_row.back().size() + 1000, .exponent = 1000};
  Digits most;
  double largest = 0.0;
  int compared = 0, marked = 0;
  for (; compared < most_compared && !rows.empty(); ++compared) {
    auto row = cells_of(take_last_line(), delimiter);
    // a mark at the end of each row but the last
    if (row.size() == last_row.size() + 1 && row.back().empty()) {
      ++marked;
      row.pop_back();
    }
    if (row.size() != last_row.size() || row.back().empty()) break;
    const Digits here = digits_of(row.back(), decimal);
    least = {std::min(least.decimals, here.decimals), std::min(least.exponent, here.exponent)};
    most = {std::max(most.decimals, here.decimals), std::max(most.exponent, here.exponent)};
    largest = std::max(largest, std::abs(number_in(row.back(), {decimal, false}).value_or(0.0)));
  }
  if (compared < least_compared) return false;
  const std::string_view cell = last_row.back();
  const auto number = number_in(cell, {decimal, false});
  const bool begins_one = number_in(std::string(cell) + "0", {decimal, false}).has_value();
  if (!number && !begins_one) return false;  // words
  if (marked == compared) return true;
  const bool fixed = least.decimals == most.decimals;
  const bool plain_zero = cell.find(decimal) == cell.npos || (!fixed && !cell.ends_with(decimal));
  if (number == 0.0 && plain_zero) return false;
  const Digits last = digits_of(cell, decimal);
  if (last.exponent < least.exponent) return true;
  // "-8.12345" of "-8.12345e-05"
  if (last.exponent == 0 && most.exponent > 0 && number && std::abs(*number) > 10.0 * largest)
    return true;
  if (fixed) return last.decimals < least.decimals;
  // zeros at the end, and a mark before nothing else, some programs leave off
  return cell.find(decimal) != cell.npos && last.decimals + 1 < least.decimals;
}

std::string cut_number(TextFile& file, const TableLayout& layout) {
  if (layout.cut == nullptr) return {};
  const char* at = layout.cut;
  const char* const end = file.text().data() + file.text().size();
  const auto cells = cells_of(take_line(at, end), layout.dialect.delimiter);
  return fmt::format(
      "the file ends without a line end, and its last number '{}' has fewer digits than those "
      "above it, or no mark behind it as they have: it may be cut off, and the row at {} is left "
      "out",
      to_utf8(cells.back().substr(0, 40)), file.position(layout.cut).text());
}

std::string comment_between(TextFile& file, const Table& table) {
  if (table.comment == nullptr) return {};
  const char* at = table.comment;
  const char* const end = file.text().data() + file.text().size();
  const std::string_view line = trimmed(take_line(at, end));
  return fmt::format(
      "lines that begin with '{}' stand between the rows and are passed over, the first at {}: "
      "'{}'; where another table begins there, its rows are read as the first one's",
      line.front(), file.position(table.comment).text(), to_utf8(line.substr(0, 40)));
}

std::string head_between(TextFile& file, const Table& table) {
  if (table.repeated_head == nullptr) return {};
  const char* at = table.repeated_head;
  const char* const end = file.text().data() + file.text().size();
  return fmt::format(
      "names or units stand again between the rows, the first time from {} on ('{}'): the rows are "
      "read as one table, in which only a column of times shows how much time passed there",
      file.position(table.repeated_head).text(),
      to_utf8(trimmed(take_line(at, end)).substr(0, 40)));
}

std::string remarks_behind(TextFile& file, const Table& table) {
  if (table.remark == nullptr) return {};
  const char* at = table.remark;
  const char* const end = file.text().data() + file.text().size();
  return fmt::format("remarks behind rows are left out, the first at {}: '{}'",
                     file.position(table.remark).text(),
                     to_utf8(trimmed(take_line(at, end)).substr(0, 40)));
}

std::string cut_row(const TextFile& file, const Table& table) {
  if (table.cut_row == nullptr) return {};
  return fmt::format("the file ends within the row at {}: this row is left out",
                     file.position(table.cut_row).text());
}

}  // namespace impactrig::acquisition
