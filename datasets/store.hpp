// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "datasets/impact.hpp"
#include "datasets/record.hpp"

namespace impactrig::datasets {

/// Writes a record as an HDF5 file laid out for h5py, MATLAB and HDF5 browsers (docs/formats.md):
/// raw samples with their scale, an NXdata group with time axis and SI values, calibration,
/// provenance. The file appears under its name only when complete. Throws FileError.
void write_record(const Record& record, const std::string& path);

/// Reads what write_record wrote, bit for bit. Throws FileError when the file cannot be opened,
/// InputError when it is cut short, is no HDF5 file, or is an HDF5 file of somebody else's.
Record read_record(const std::string& path);

/// True when the first bytes of a file (at least 8) are HDF5's signature.
bool looks_like_hdf5(std::string_view head);

}  // namespace impactrig::datasets
