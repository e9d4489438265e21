// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>
#include <vector>

#include "acquisition/importers/text_table.hpp"

namespace impactrig::acquisition {

/// True for a date or a time of day, or for the AM or PM of one.
bool is_part_of_date(std::string_view cell);

/// Finds the dates and times of day in the rows from lines[layout.head.size()] on: one date and
/// time may take several cells side by side. `named`: how many columns the line above the rows
/// names. Throws datasets::InputError where a comma behind a time may divide cells or be its
/// decimal mark.
std::vector<DateColumns> find_date_columns(const TextFile& file,
                                           const std::vector<std::string_view>& lines,
                                           const TableLayout& layout, std::size_t named);

/// Finds clocks that take several columns of a table of numbers, by the words of their heads: whole
/// seconds and what is behind them, "sec,nsec", "stamp.secs,stamp.nsecs", "Seconds,Microseconds";
/// or hours, minutes and seconds, "Year,Month,Day,Hour,Minute,Second", "h,min,s,ms", where these
/// rise in the first rows and no other column is a time by its name. `stated`: the user names the
/// time column, so that hours, minutes and seconds are columns like others.
std::vector<DateColumns> find_counted_clocks(const std::vector<std::string_view>& lines,
                                             const TableLayout& layout, bool stated);

}  // namespace impactrig::acquisition
