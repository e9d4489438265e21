// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "acquisition/importers/column_heads.hpp"
#include "acquisition/importers/csv_roles.hpp"
#include "acquisition/importers/text_table.hpp"
#include "acquisition/recording_reader.hpp"

namespace impactrig::acquisition {

/// One head a column: what the file says, then what the user says, then a name where there is none.
std::vector<ColumnHead> complete_heads(const TextFile& file, const TableHead& head,
                                       std::size_t columns, const ImportOptions& options);

/// Units that the head states by a key ("Vertical Units,V") go to the columns that state none
/// themselves. One unit is for all of them; several are one a channel.
void take_units_of_keys(const TableHead& head, const CsvRoles& roles, char delimiter,
                        std::vector<ColumnHead>& heads);

/// Throws datasets::InputError for a table with a row for each channel at each time, which a column
/// of words names: "0.001,force,12.5" over "0.001,speed,0.4".
void refuse_long_table(TextFile& file, const TableLayout& layout, std::string_view text,
                       const std::vector<ColumnHead>& heads, const CsvRoles& roles);

/// Says which columns are left out since they hold text, or dates that are not the time, and when
/// the first row was recorded.
void tell_of_dates_and_text(const TableLayout& layout, const std::vector<ColumnHead>& heads,
                            const CsvRoles& roles, datasets::Record& record);

/// Says that commas between two whole numbers a row, under no names, may be decimal marks ("1,5");
/// "" where they may not. `text` holds the rows.
std::string commas_that_may_be_decimal_marks(const TableLayout& layout, const TableHead& head,
                                             std::string_view text);

/// How the file was read, as attributes of the record.
void describe(const TableLayout& layout, const TableHead& head,
              const std::vector<ColumnHead>& heads, const CsvRoles& roles,
              datasets::Record& record);

/// A channel by its head, without samples and clock.
datasets::Channel channel_of(const TableHead& head, std::size_t column, const ColumnHead& says,
                             datasets::Record& record);

}  // namespace impactrig::acquisition
