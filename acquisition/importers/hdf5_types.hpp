// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <hdf5.h>

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/importers/hdf5_arrays.hpp"
#include "datasets/hdf5_handle.hpp"

namespace impactrig::acquisition {

constexpr int hdf5_deepest = 16;  ///< groups in groups, records in records

/// The type of ours that holds all numbers of a type, but for floating point wider than double
/// precision; none where HDF5 knows no numbers. The values of an enumeration are its integers: h5py
/// writes true and false so; PyTables writes them as bit fields, whose value is what their bits
/// count.
std::optional<ArrayNumbers> hdf5_numbers_of(hid_t type);

/// What reads a bit field to the type that hdf5_numbers_of() gives: HDF5 makes no numbers of them.
hid_t hdf5_bits_of(ArrayNumbers numbers);

/// Integers that are not all exact in double precision.
bool hdf5_is_wide(hid_t type);

/// What HDF5 calls our type in memory.
hid_t hdf5_memory_type(ArrayNumbers numbers);

std::size_t width_of(ArrayNumbers numbers);  ///< [bytes]

/// MATLAB, h5py and others write a complex number as a pair.
bool hdf5_is_complex(hid_t type);

/// How many elements a list of fixed length in one dimension has; 0 of other types.
std::uint64_t hdf5_list_length(hid_t type);

/// Of records and of those within them, each element of a list counted; more than hdf5_longest_list
/// where they are too deep.
std::size_t hdf5_count_fields(hid_t type, int depth = 0);

/// Records with one of the file's fields, by the names that lead to it; `number`: its type in
/// memory, of a list that of the list.
datasets::Hdf5Handle hdf5_field_type(const std::vector<std::string>& names, hid_t number);

/// What it is called to those whose data set is passed over.
std::string_view hdf5_kind_name(H5T_class_t kind);

}  // namespace impactrig::acquisition
