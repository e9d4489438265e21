// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/hdf5_handle.hpp"
#include "datasets/store_layout.hpp"

namespace impactrig::datasets {

/// HDF5 could not do it; whoever knows the file's name makes a FileError of it.
struct WriteFailure {
  std::string reason;
};

/// Both throw WriteFailure with what HDF5 says. As the file is laid out in memory, that is a lack
/// of memory.
Hdf5Handle made(hid_t id, Hdf5Handle::Close closer);  ///< where id is not valid
void check(herr_t status);                            ///< where status is negative

Hdf5Handle scalar_space();
void add_attribute(hid_t owner, const char* name, hid_t type, hid_t space, hid_t memory_type,
                   const void* value);

/// An attribute; what is longer than layout::longest_attribute is cut.
void add_text(hid_t owner, const char* name, std::string_view text);

/// An attribute that is a list of one.
void add_text_list(hid_t owner, const char* name, std::string_view text);

/// A group whose links keep the order they were made in.
Hdf5Handle add_group(hid_t parent, const std::string& name, std::string_view nexus_class);

/// A list of texts, or with `columns` = 2 a table of them; nothing where there are none.
void add_text_data(hid_t parent, const char* name, std::span<const std::string> texts,
                   hsize_t columns = 1);

/// A table of two columns, name and value; nothing where there are none.
void add_pairs(hid_t parent, const char* name, const std::map<std::string, std::string>& pairs);

/// A data set of one text, of any length.
void add_scalar_text(hid_t parent, const char* name, std::string_view text);

/// Makes `time`, a data set of that name in `group`, the dimension scale of `data`, as the HDF5
/// dimension scale specification lays down, so that HDFView, h5py and xarray know the axis.
void attach_time(hid_t group, const Hdf5Handle& time, std::span<const Hdf5Handle> data);

template <typename Number>
void add_number(hid_t owner, const char* name, Number value) {
  add_attribute(owner, name, hdf5_file_type(value), scalar_space().id(), hdf5_memory_type(value),
                &value);
}

template <typename Number>
Hdf5Handle add_scalar(hid_t parent, const char* name, Number value) {
  Hdf5Handle data = made(H5Dcreate2(parent, name, hdf5_file_type(value), scalar_space().id(),
                                    H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                         H5Dclose);
  check(H5Dwrite(data.id(), hdf5_memory_type(value), H5S_ALL, H5S_ALL, H5P_DEFAULT, &value));
  return data;
}

/// Long ones in compressed pieces with a checksum each, by filters that every HDF5 has.
template <typename Number>
Hdf5Handle add_data(hid_t parent, const char* name, const std::vector<Number>& values) {
  const hsize_t count = values.size();
  const Hdf5Handle space = made(H5Screate_simple(1, &count, nullptr), H5Sclose);
  const Hdf5Handle properties = made(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  if (values.size() >= layout::smallest_chunked) {
    const hsize_t chunk = std::min<hsize_t>(count, layout::chunk);
    check(H5Pset_chunk(properties.id(), 1, &chunk));
    check(H5Pset_shuffle(properties.id()));
    check(H5Pset_deflate(properties.id(), 1));
    check(H5Pset_fletcher32(properties.id()));
  }
  Hdf5Handle data = made(H5Dcreate2(parent, name, hdf5_file_type(Number{}), space.id(), H5P_DEFAULT,
                                    properties.id(), H5P_DEFAULT),
                         H5Dclose);
  if (!values.empty())
    check(H5Dwrite(data.id(), hdf5_memory_type(Number{}), H5S_ALL, H5S_ALL, H5P_DEFAULT,
                   values.data()));
  return data;
}

}  // namespace impactrig::datasets
