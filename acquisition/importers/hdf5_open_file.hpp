// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "datasets/hdf5_handle.hpp"

namespace impactrig::acquisition {

/// A file that is open for reading within the child process that runs HDF5: no message on stderr,
/// no library of filters that the file asks for, and LZF among HDF5's own filters.
struct Hdf5OpenFile {
  datasets::Hdf5Handle access{H5Pcreate(H5P_FILE_ACCESS), H5Pclose};
  datasets::Hdf5Handle file{H5I_INVALID_HID, H5Fclose};  ///< not valid where HDF5 cannot open it

  explicit Hdf5OpenFile(const std::string& path);
};

}  // namespace impactrig::acquisition
