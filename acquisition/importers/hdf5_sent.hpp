// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "acquisition/importers/child_process.hpp"
#include "acquisition/importers/hdf5_arrays.hpp"

namespace impactrig::acquisition {

// Entries of the listing, as hdf5_arrays.cpp reads them.

/// Each kind of attributes behind its count.
void send_hdf5_attributes(const Hdf5Attributes& attributes, const PipeWriter& out);

/// "array" and all that is known of it.
void send_hdf5_array(const Hdf5Array& array, const PipeWriter& out);

}  // namespace impactrig::acquisition
