// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "acquisition/importers/names_and_units.hpp"

namespace impactrig::acquisition {

/// "Unit", "Einheit:", "Y Units", ...: what a line of units may begin with.
bool is_unit_label(std::string_view cell);

/// "Name", "Channel:", ...: what a line of names may begin with.
bool is_name_label(std::string_view cell);

/// Names and units in lines that begin with a word for what they hold, over rows of one cell less:
/// "Name,Force,Velocity" above "Unit,N,m/s", other lines between them or not. Above a line of units
/// any word may stand before the names. None where a line of words below them has a cell a column:
/// those are the names then, and these a title and such.
NamesAndUnits labelled_names(const TableLayout& layout, const std::vector<std::size_t>& filled,
                             TableHead& head);

/// The same over rows whose first column holds times that are not named: "CH Name,Load,Acc" above
/// "Unit,N,m/s2", as Kyowa's recorders write. Both have to be there.
NamesAndUnits labelled_names_over_times(const TableLayout& layout,
                                        const std::vector<std::size_t>& filled, TableHead& head);

}  // namespace impactrig::acquisition
