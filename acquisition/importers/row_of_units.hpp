// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string_view>

#include "acquisition/importers/column_heads.hpp"
#include "acquisition/importers/head_cells.hpp"

namespace impactrig::acquisition {

/// What is between brackets, when the whole text is bracketed.
std::optional<std::string_view> bracketed(std::string_view text);

/// True for what is understood as a unit.
bool is_unit(std::string_view text);

/// "deacceleration - kg" divided at its dash; none without one.
std::optional<ColumnHead> sentence(std::string_view cell);

/// Sentences alone, at least one with a unit that is understood.
bool is_sentence_row(const HeadCells& cells);

/// "Sequence", "Index", "#", ...: what a column of row numbers may be called.
bool is_index_word(std::string_view text);

/// "Max", "Gain", "Sensitivity", ...: what a line of figures of the columns may begin with.
bool is_figure_word(std::string_view text);

/// Units alone, understood or in brackets.
bool is_unit_row(const HeadCells& cells);

/// Units, three at least, and one word in four that is none: "segments", but no name of a time.
bool is_nearly_unit_row(const HeadCells& cells);

/// A time or a unit among names: a title or a key has neither.
bool name_a_time_or_unit(const HeadCells& names);

/// A unit of time under a name of times: what is under the other names are units too, understood or
/// not ("Voltage (unscaled)").
bool has_time_over_its_unit(const HeadCells& names, const HeadCells& units);

}  // namespace impactrig::acquisition
