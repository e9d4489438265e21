// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/importers/column_heads.hpp"
#include "acquisition/importers/text_table.hpp"
#include "acquisition/importers/time_axis.hpp"
#include "acquisition/recording_reader.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

/// Columns [first, end), whose channels have the times in one of them, or none.
struct ClockColumns {
  std::optional<std::size_t> time;
  std::size_t first = 0;
  std::size_t end = 0;
};

/// Which columns are not channels, and why.
struct CsvRoles {
  std::optional<std::size_t> time;
  std::optional<std::size_t> index;  ///< counts the samples
  bool index_name_fits = true;       ///< or it has none
  double samples_before = 0.0;       ///< since the start that the head states, by the counts
  std::string reason;                ///< why `time` is the time
  std::vector<std::size_t> text;     ///< hold text
  std::vector<std::size_t> dates;    ///< hold dates and times of day
  /// Columns of times behind channels of `time`, in order: the columns behind one have its clock;
  /// or those before it, where channels stand before the first one and none behind the last.
  std::vector<std::size_t> further_times;
  /// Columns behind `time` that are times by their name or unit and increase in the rows looked at,
  /// in order: not all are behind channels.
  std::vector<std::size_t> named_times;

  /// Sets named_times, and of them further_times.
  void take_further_times(std::vector<std::size_t> increasing);

  /// In order, each with its time, of so many columns in all.
  std::vector<ClockColumns> clocks(std::size_t columns) const;

  bool is_channel(std::size_t column) const {
    const auto is_in = [column](const std::vector<std::size_t>& columns) {
      return std::ranges::find(columns, column) != columns.end();
    };
    return column != time && column != index && !is_in(text) && !is_in(dates) &&
           !is_in(further_times);
  }
};

/// One head a column: what the file says, then what the user says, then a name where there is none.
std::vector<ColumnHead> complete_heads(const TextFile& file, const TableHead& head,
                                       std::size_t columns, const ImportOptions& options);

/// What the columns are, by what is stated, by their heads and by the rows in `table`.
CsvRoles find_roles(const TextFile& file, const TableLayout& layout, const TableHead& head,
                    const std::vector<ColumnHead>& heads, const Table& table,
                    const ImportOptions& options);

/// What a head may state, as our own export does, of columns that look like times or count.
constexpr std::string_view time_column_key = "time column";
constexpr std::string_view no_time_column = "none";
constexpr std::string_view only_first_is_time = "the first alone";

/// Says which columns are left out since they hold text, or dates that are not the time, and when
/// the first row was recorded.
void tell_of_dates_and_text(const TableLayout& layout, const std::vector<ColumnHead>& heads,
                            const CsvRoles& roles, datasets::Record& record);

/// Says that commas between two whole numbers a row, under no names, may be decimal marks ("1,5");
/// "" where they may not. `text` holds the rows.
std::string commas_that_may_be_decimal_marks(const TableLayout& layout, const TableHead& head,
                                             std::string_view text);

/// Says which columns are taken as the times of those beside them by their unit alone, and which
/// counts the samples under a name.
void tell_of_times(const std::vector<ColumnHead>& heads, const CsvRoles& roles,
                   datasets::Record& record);

/// How many values there are before a column ends, all further ones missing; 0 where one is missing
/// in between.
std::size_t samples_before_end(const Column& column);

/// Units that the head states by a key ("Vertical Units,V") go to the columns that state none
/// themselves. One unit is for all of them; several are one a channel.
void take_units_of_keys(const TableHead& head, const CsvRoles& roles, char delimiter,
                        std::vector<ColumnHead>& heads);

/// Samples that a head marks as not valid, by column: runs in order that do not touch.
using MarkedRows = std::map<std::size_t, std::vector<SampleRange>>;

/// Takes "invalid samples of column 2: 17-21 40", as our own export writes it, out of the head.
/// Rows count from 0. What is no such list stays.
MarkedRows take_marked_rows(TableHead& head);

/// Marks samples as not valid; the first of `valid`, which is empty or one a sample, is sample
/// `first`.
void mark_rows(const MarkedRows& marked, std::size_t column, std::uint64_t first,
               std::size_t samples, std::vector<std::uint8_t>& valid);

/// How the file was read, as attributes of the record.
void describe(const TableLayout& layout, const TableHead& head,
              const std::vector<ColumnHead>& heads, const CsvRoles& roles,
              datasets::Record& record);

/// The unit of a time column as a conversion to seconds; a warning where it is not stated. Throws
/// InputError for a unit that is none of time.
datasets::UnitConversion time_conversion(const TextFile& file, const ColumnHead& head,
                                         datasets::Record& record);

/// Times in seconds. Throws InputError when one is missing.
void to_seconds(const TextFile& file, const ColumnHead& head,
                const datasets::UnitConversion& conversion, Column& column);

/// The clock of a file without a time column: from a Start and Increment, or from a key of the
/// header.
datasets::SampleClock clock_from_head(const TableHead& head, const CsvRoles& roles);

/// A header may state the interval too: with more digits than the times have, or another one.
void compare_with_head(const TableHead& head, std::size_t rows, datasets::SampleClock& clock,
                       datasets::Record& record);

/// A channel by its head, without samples and clock.
datasets::Channel channel_of(const TableHead& head, std::size_t column, const ColumnHead& says,
                             datasets::Record& record);

}  // namespace impactrig::acquisition
