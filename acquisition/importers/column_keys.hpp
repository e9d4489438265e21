// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/importers/column_heads.hpp"

/// What lines "key, value" above a table state of its columns: names, units, interval, start.
namespace impactrig::acquisition {

/// The values of a key, one a column. Tabs between them have become blanks.
std::vector<std::string_view> values_of_key(std::string_view text, char delimiter);

/// "x axis unit" of "X-Axis_Unit:": letters small, words apart by blanks, nothing behind them.
std::string normalized_key(std::string_view key);

/// "Horizontal Units", "x unit", "X axis unit:", ...
bool is_horizontal_unit_key(std::string_view key);

/// "Vertical Units", "y unit", "VERT_UNITS", ...
bool is_vertical_unit_key(std::string_view key);

/// "s" of "S", which is a siemens elsewhere, and "us" of "uS".
std::string unit_of_times(std::string_view unit);

/// Takes the sample interval that is stated by a key such as "Sample Interval" or "Sampling rate
/// [kHz]", and the time of the first sample. A value a column is one value where all are the same.
void find_interval(Dialect dialect, TableHead& head);

/// Takes cells like "t0 = -5e-4" and "tInc = 1e-6" off the end of a line of names, as attributes.
void take_keys_among_names(std::vector<std::string_view>& names, TableHead& head);

/// Takes names where the head has none and a key lists them: one a column, or one for each but the
/// first.
void take_names_of_keys(const TableLayout& layout, TableHead& head);

/// How many samples a head says that there are.
struct AnnouncedSamples {
  std::string key;
  std::uint64_t count = 0;
};

/// By a key such as "Record Length", of oscilloscopes; none where there is no such.
std::optional<AnnouncedSamples> announced_samples(const TableHead& head, Dialect dialect);

/// Says that there are fewer rows than announced; "" where there are not.
std::string missing_rows(const std::optional<AnnouncedSamples>& announced, std::uint64_t rows);

/// Name, unit and start of the one column under lines "Key :value".
void take_column_of_keys(Dialect dialect, TableHead& head);

}  // namespace impactrig::acquisition
