// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "acquisition/importer.hpp"
#include "acquisition/importers/hdf5_channels.hpp"

namespace impactrig::acquisition {

/// Sets the clocks of the channels of an HDF5 file, by what counts first: a time column that is
/// stated; attributes of the data set; the scale of its dimension; times, intervals and rates
/// beside it, by their names; attributes of the groups around it. Where two say something else,
/// that is a warning. Channels over frequencies or lengths have no clock and are told what they lie
/// over. Throws datasets::InputError when a stated time column is not there, or cannot be read.
void set_clocks(Hdf5Channels& channels, const ImportOptions& options);

}  // namespace impactrig::acquisition
