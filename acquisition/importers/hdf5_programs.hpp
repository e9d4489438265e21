// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "acquisition/importers/hdf5_arrays.hpp"

namespace impactrig::acquisition {

/// Says in attributes that every data set may have ("dt", "t0", "units", "scale_factor",
/// "add_offset") what programs say in words of their own:
///
/// - Igor Pro: `IGORWaveScaling`, a row for the numbers and one a dimension, each of step and
///   start, and `IGORWaveUnits`, likewise. A wave without a unit along its dimension that counts
///   from 0 in ones has not been scaled.
/// - Keysight Infiniium: `XInc`, `XOrg`, `XUnits` and `YUnits` at the group of a channel; of
///   integers `YInc` and `YOrg` too. A segment has an origin of its own, `SegmentedXOrg`.
///
/// - pandas: take_pandas() of hdf5_pandas.hpp.
///
/// Attributes that a data set has itself count. Variables of Octave, groups of a `type` and a
/// `value`, get their names.
///
/// Sources: Igor Pro's HDF5 guide (HDF5SaveData /IGOR); Keysight's help of Infiniium, "HDF5 Schema
/// for Infiniium Oscilloscope Data".
void state_programs_words(Hdf5Listing& listing);

}  // namespace impactrig::acquisition
