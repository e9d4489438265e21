// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/importer.hpp"
#include "acquisition/importers/date_time.hpp"
#include "acquisition/importers/grouping_check.hpp"
#include "acquisition/importers/number.hpp"
#include "acquisition/importers/text_file.hpp"

namespace impactrig::acquisition {

/// How a table of numbers is written.
struct Dialect {
  char delimiter = ',';  ///< ' ' = any run of blanks and tabs
  char decimal = '.';    ///< '.' or ','; that of `delimiter` too: within quotes, else none
  bool dates = false;    ///< cells may be dates and times of day
  bool grouped = false;  ///< thousands are separated in the first rows
};

/// "comma", "tab", "semicolon", "blank", "bar" or the character itself.
std::string delimiter_name(char delimiter);

/// A column without a number in the first rows, but with text.
struct TextColumn {
  std::size_t column = 0;
  std::string_view example;  ///< the first text, in the file's own encoding
};

/// Columns that state one date and time of day together, in the first row `base`.
struct DateColumns {
  std::size_t first = 0;
  std::size_t last = 0;  ///< which gets the value
  DateTime base;
  /// Of the last column where it counts what is behind the seconds, as loggers write "ms" or "us"
  /// beside a time in whole seconds [ns]; 0: it does not.
  std::int64_t fraction = 0;

  /// How its cells but that of the fraction are written.
  enum class Written : std::uint8_t {
    text,           ///< dates and times as date_time_in() reads them
    whole_seconds,  ///< one count, "1700000000,250000000"
    numbers         ///< hour, minute and second, or these behind a date or year, month and day
  } written = Written::text;

  /// The time that these cells state together, in the file's text from the first to the last of
  /// them; none where they state no such.
  std::optional<DateTime> read(std::string_view cells, Dialect dialect) const;
};

/// A column of numbers that are counted from the first: they are too large for their differences.
struct CountedColumn {
  std::size_t column = 0;
  std::string_view first;  ///< as it is written
};

/// A file as a head of lines and a table of numbers under it.
struct TableLayout {
  Dialect dialect;
  std::vector<std::string_view> head;  ///< lines before the first row, in the file's own encoding
  const char* data = nullptr;          ///< start of the first row
  std::size_t cells = 0;               ///< of the first row, without empty ones at its end
  std::size_t written_cells = 0;       ///< of the first row, with them
  bool column_numbers = false;         ///< are all that the last line of `head` says
  /// Behind the last row, where what follows is no row; null: rows go on to the end.
  const char* end = nullptr;
  /// The first line of a table above that is smaller and left out; empty: there is none.
  std::string_view table_above = {};
  /// A last row whose last number may be cut off, and which is no row therefore; null: there is
  /// none.
  const char* cut = nullptr;
  /// Columns whose first numbers may have thousands separators where others have decimals.
  std::vector<std::size_t> perhaps_grouped;
  /// Cells at the start of each row that hold keys and values in the first rows and nothing below,
  /// as some oscilloscopes write them beside the samples. They are not counted in `cells` and
  /// `written_cells`.
  std::size_t key_cells = 0;
  std::vector<std::string_view> key_lines;  ///< the rows that have such keys
  /// Cells of these rows that hold the keys of further tables beside the first; the columns they
  /// stand over are without an example among `text_columns`.
  std::vector<std::size_t> further_keys;
  /// In order; within the rows, or behind them under a name. A row may end before those at its end.
  std::vector<TextColumn> text_columns;
  std::vector<DateColumns> dates;  ///< in order
  std::vector<CountedColumn> counted;

  bool holds_text(std::size_t column) const;

  /// How many cells hold a date and time with the one behind them.
  std::size_t cells_beside() const;

  /// Those that a column belongs to, or null.
  const DateColumns* dates_at(std::size_t column) const;
};

/// Finds the first row of numbers and how the rows are written: the dialect in which most of the
/// first rows are numbers wins, then the one with more columns. Where no row is of numbers
/// alone, one that begins with a number and holds another counts too. What `options` states is not
/// searched. Throws datasets::InputError when there is no row of numbers.
TableLayout find_table(TextFile& file, const ImportOptions& options);

/// A cell without quotes and blanks around it.
std::string_view without_quotes(std::string_view cell);

/// The cells of a line of text, trimmed, without quotes.
std::vector<std::string_view> cells_of(std::string_view line, char delimiter);

/// The value of a cell however it is written; NaN for a missing one (empty, "nan", "-1.#IND"), none
/// for what is no number.
std::optional<double> cell_value(std::string_view cell, char decimal);

/// True for what instruments write in a column of numbers where a value was beyond their range or
/// is not there: "OVL", "+Over", "overload", "---", "+++", "#####". In a column without numbers it
/// may be a text like others.
bool marks_missing(std::string_view cell);

/// True for the numbers that instruments write where there is none: SCPI's 9.9e37 (beyond the
/// range, with either sign) and 9.91e37 (no measurement), Hioki's 9.99999e99.
bool stands_for_no_value(double value);

/// True for "1,234.5", "1.234,0", "1'234" and "1 234,5": digits in groups of three.
bool has_thousands_separators(std::string_view cell);

/// The value of a number whose thousands are separated by what can be nothing else: "1,234.5" where
/// '.' is the decimal mark, "1'234". None for "1,234", which may have decimals of another kind than
/// the file's others, and for "1.234.567", which may be no number.
std::optional<double> grouped_number_in(std::string_view cell, char decimal);

/// One column of numbers.
struct Column {
  std::vector<double> values;       ///< NaN where there is no number
  std::vector<std::uint8_t> valid;  ///< 0 where there is none; empty when all are there
  std::size_t missing = 0;          ///< how many are not there
  const char* first_missing = nullptr;
  std::string_view mark;  ///< what stands for the first that is missing, if not one of the usual
};

/// Rows of numbers from layout.data to the end of the file.
struct Table {
  std::vector<Column> columns;
  std::size_t rows = 0;
  const char* cut_row =
      nullptr;  ///< start of a last row that the file's end cut off; it is left out
  const char* comment = nullptr;  ///< the first line that begins with # or % before another row
  const char* repeated_head = nullptr;  ///< the first line of the head where it stands again
  const char* remark = nullptr;         ///< the first that stands behind a row, with its #
};

/// The text up to the end of the last row.
std::string_view text_of_rows(TextFile& file, const TableLayout& layout);

/// Reads a layout's rows with one pass over the text and no allocation a cell. Blank lines, lines
/// that begin with # and the head where it stands again are skipped; empty cells and "nan" are
/// missing values. Dates and times of day are seconds since the first row.
class RowReader {
 public:
  /// `names` (one a column) only name the culprit of an error.
  RowReader(TextFile& file, const TableLayout& layout, const std::vector<std::string>& names);

  /// Columns that are not needed are passed over unread, as columns of text are; their values stay
  /// empty.
  void read_only(const std::vector<bool>& needed);

  /// To the start of a line.
  void seek(const char* line) { at_ = line; }

  /// To lines of the file's last_lines().
  void seek_last(std::string_view lines) {
    at_ = lines.data();
    end_ = lines.data() + lines.size();
  }

  const char* at() const { return at_; }

  bool at_end() const { return at_ == end_; }

  /// The next rows, at most so many. Throws datasets::InputError with line and column for a cell
  /// that is no number and for a row with too few or too many cells.
  Table read(std::size_t most);

 private:
  bool at_line_end() const { return at_ == end_ || *at_ == '\n' || *at_ == '\r'; }

  bool is_blank(char c) const { return c == ' ' || (c == '\t' && delimiter_ != '\t'); }

  bool ends_cell(char c) const {
    return delimiter_ == ' ' ? (c == ' ' || c == '\t') : c == delimiter_;
  }

  void skip_blanks();
  void skip_line_end();
  void read_line();
  void skip_key_cells();
  bool read_cell(std::size_t column);
  bool read_counted(std::size_t column);
  bool read_perhaps_grouped(std::size_t column);
  void skip_cell();
  bool read_date(std::size_t column);
  std::optional<std::int64_t> read_fraction(const DateColumns& date);
  bool may_begin_table(const char* start) const;
  bool pass_over_repeated_head();
  bool unusual_cell(std::size_t column);
  bool begins_number(std::string_view cell) const;
  bool scan_only(std::string_view cell) const;
  void finish_row(const char* line);
  void short_row(const char* line, std::size_t cells);

  TextFile& file_;
  const std::vector<std::string>& names_;
  char delimiter_;
  std::size_t key_cells_;
  char decimal_;
  NumberStyle style_;  ///< of cells without quotes
  const char* at_;
  const char* end_ = nullptr;

  /// What is done with a cell.
  enum class Use : std::uint8_t { skipped, number, perhaps_grouped, counted, date_begins, date };

  std::vector<Use> uses_;                           ///< one a column
  std::map<std::size_t, GroupingCheck> groupings_;  ///< of columns that are perhaps grouped
  const char* date_from_ = nullptr;                 ///< where a date of several cells began
  const TableLayout& layout_;
  std::size_t required_;           ///< cells that a row must have: up to the last column of numbers
  std::string_view last_of_head_;  ///< where rows may be told from it by their first letter
  bool first_row_ = true;
  const char* comment_ = nullptr;  ///< the first since the last row
  Table table_;
};

/// Reads all rows of a layout.
Table read_table(TextFile& file, const TableLayout& layout, const std::vector<std::string>& names);

/// "'Force': 2 of 500 values are missing, the first at run.csv:12:9 (byte 431); marked as not
/// valid"; "" when none is.
std::string missing_values(const TextFile& file, const std::string& name, const Column& column,
                           std::uint64_t rows);

/// True for ",,": a row that ends a table of some programs and holds nothing.
bool has_only_empty_cells(std::string_view line, char delimiter);

/// Says what follows the rows and is left out, but for rows of empty cells; "" where nothing does.
std::string what_follows(TextFile& file, const TableLayout& layout);

/// What to say of a table above the one that is read.
std::string table_above(const TextFile& file, const TableLayout& layout);

/// Sets `cut` of a layout whose rows go on to the end of `text`.
void find_cut_row(std::string_view text, TableLayout& layout);

/// Says that the last number, which no line end follows, lacks digits that all those above it have;
/// "" where it does not.
std::string cut_number(TextFile& file, const TableLayout& layout);

/// Of rows that end without a line end: whether their last number has fewer digits than those in
/// the lines above it.
bool ends_in_cut_number(std::string_view rows, char delimiter, char decimal);

/// Says that lines between the rows are passed over, which may begin another table; "" where there
/// are none.
std::string comment_between(TextFile& file, const Table& table);

/// The same of a head that stands again between rows.
std::string head_between(TextFile& file, const Table& table);

/// Of remarks behind rows.
std::string remarks_behind(TextFile& file, const Table& table);

/// Says that the file's end cut a row off; "" when it did not.
std::string cut_row(const TextFile& file, const Table& table);

}  // namespace impactrig::acquisition
