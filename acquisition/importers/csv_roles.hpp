// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/importers/column_heads.hpp"
#include "acquisition/importers/text_table.hpp"
#include "acquisition/recording_reader.hpp"

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
  bool first_is_blank = false;       ///< the first column has keys above it, and no values
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
    return column != time && column != index && !(first_is_blank && column == 0) && !is_in(text) &&
           !is_in(dates) && !is_in(further_times);
  }
};

/// What a head may state, as our own export does, of columns that look like times or count.
constexpr std::string_view time_column_key = "time column";
constexpr std::string_view no_time_column = "none";
constexpr std::string_view only_first_is_time = "the first alone";

/// What the columns are, by what is stated, by their heads and by the rows in `table`.
CsvRoles find_roles(const TextFile& file, const TableLayout& layout, const TableHead& head,
                    const std::vector<ColumnHead>& heads, const Table& table,
                    const ImportOptions& options);

/// Says which columns are taken as the times of those beside them by their unit alone, and which
/// counts the samples under a name.
void tell_of_times(const std::vector<ColumnHead>& heads, const CsvRoles& roles,
                   datasets::Record& record);

/// How many values there are before a column ends, all further ones missing; 0 where one is missing
/// in between.
std::size_t samples_before_end(const Column& column);

}  // namespace impactrig::acquisition
