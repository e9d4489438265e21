// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "acquisition/importers/hdf5_arrays.hpp"

namespace impactrig::acquisition {

/// "/run/force" as MATLAB writes it: "run.force".
std::string mat73_name(std::string path);

/// What a MAT-file of version 7.3 holds: without what MATLAB keeps for itself below "/#refs#" and
/// "/#subsystem#", but for data sets there that are fields of structure arrays or cells, which are
/// named as in the other versions: "run(2).force", "shots{3}". What leads nowhere is told as not
/// read; of fields and cells beyond 10 000 only that there are more.
Hdf5Listing with_mat73_structures(Hdf5Listing listing);

}  // namespace impactrig::acquisition
