// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "acquisition/importers/column_heads.hpp"
#include "acquisition/importers/head_cells.hpp"

namespace impactrig::acquisition {

/// Cells of the lines that name a table's columns and tell their units; empty where there are none.
struct NamesAndUnits {
  HeadCells names;
  HeadCells units;
};

/// The last two filled lines above the rows, as names and units or as names alone. Lines of numbers
/// below them are passed over (offsets of the channels). `filled`: which lines of the head hold
/// text; which of them are taken is told to `head`, with a start and an increment among them.
NamesAndUnits find_names_and_units(const TableLayout& layout, std::vector<std::size_t> filled,
                                   TableHead& head);

}  // namespace impactrig::acquisition
