// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "acquisition/importers/column_heads.hpp"
#include "acquisition/importers/csv_roles.hpp"
#include "acquisition/importers/text_table.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

/// The unit of a time column as a conversion to seconds; a warning where it is not stated. `first`:
/// of the times as it is written; `times`: the first of them. Throws InputError for a unit that is
/// none of time, and for times that may be days.
datasets::UnitConversion time_conversion(const TextFile& file, const ColumnHead& head,
                                         std::optional<double> first, std::span<const double> times,
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

}  // namespace impactrig::acquisition
