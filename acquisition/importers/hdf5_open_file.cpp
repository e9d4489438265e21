// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/hdf5_open_file.hpp"

#include <hdf5.h>

#include "acquisition/importers/hdf5_lzf.hpp"

namespace impactrig::acquisition {

using datasets::Hdf5Handle;

Hdf5OpenFile::Hdf5OpenFile(const std::string& path) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  H5PLset_loading_state(0);  // no filter of a file loads a library
  register_lzf();
  H5Pset_fclose_degree(access.id(), H5F_CLOSE_STRONG);
  file = Hdf5Handle(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.id()), H5Fclose);
}

}  // namespace impactrig::acquisition
