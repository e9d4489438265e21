// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "acquisition/importers/hdf5_arrays.hpp"

namespace impactrig::acquisition {

/// Gives the columns of pandas' data frames and series their names, "/shot1.force", and tells an
/// index of real numbers, times or durations as what the columns lie over. In both of its formats:
///
/// - fixed: `axis1` (of a series `index`) beside `block0_values`, whose columns `block0_items`
/// names;
/// - table: records, `table.index` and `table.values_block_0`, lists whose names an attribute
///   `values_block_0_kind` keeps as Python's pickle of a list of texts, protocol 0. What PyTables
///   keeps beside them to look rows up (`_i_table`) is left out.
///
/// Source: pandas' io.pytables and files written with pandas 1.5.
void take_pandas(Hdf5Listing& listing);

}  // namespace impactrig::acquisition
