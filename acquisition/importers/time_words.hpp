// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "acquisition/importers/column_heads.hpp"

namespace impactrig::acquisition {

/// "ms" of "Millisekunden" and "msecs", "min" of "mins": a unit of time in words, in English,
/// German, French, Italian or Spanish, or in letters that mean another one ("mS"); "" of others.
std::string unit_of_time_in_words(std::string_view text);

/// "s" of a column that is called "Seconds", which might not be the second one; "" of others.
std::string unit_named(std::string_view name);

/// "Zeit_in_ms", "Messzeit_ms", "time_rel_ms", "rise time ms" and "timeMs" as name and unit: a time
/// by a word of the name, with a unit at its end; "X_ms" too, which no length is.
std::optional<ColumnHead> time_with_unit_at_end(std::string_view text);

/// Whether it counts something else than time ("samples", "ticks"), so that it is no unit of times.
bool counts_no_time(std::string_view unit);

}  // namespace impactrig::acquisition
