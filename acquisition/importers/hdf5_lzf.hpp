// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace impactrig::acquisition {

/// Lets HDF5 unpack what h5py packs with compression="lzf": filter 32000, LibLZF's format, the size
/// of a piece in the filter's third number.
void register_lzf();

}  // namespace impactrig::acquisition
