// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>
#include <vector>

#include "acquisition/importers/text_table.hpp"

namespace impactrig::acquisition {

/// What a line above a table is divided into; views of its text.
using HeadCells = std::vector<std::string_view>;

/// What stands behind "#", "%" or "//".
std::string_view without_comment_sign(std::string_view line);

/// The same above these rows: a "#" that is a cell of its own over them is a name that says
/// nothing, for an empty cell is left of it.
std::string_view without_comment_sign(std::string_view line, const TableLayout& layout);

/// The cells of a head line. A comment may be divided otherwise than the data under it: what gives
/// as many cells as there are columns is taken. Blanks divide words too: where they are the
/// delimiter and nothing fits, there are no cells.
HeadCells head_cells(std::string_view line, const TableLayout& layout);

}  // namespace impactrig::acquisition
