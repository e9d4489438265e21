// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <hdf5.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/importers/hdf5_arrays.hpp"

namespace impactrig::acquisition {

constexpr std::size_t hdf5_longest_text = 30000;  ///< of an attribute or a data set [bytes]

/// Texts of an attribute or of a data set, which `read` reads with a type into memory; none where
/// they cannot be read.
std::optional<std::vector<std::string>> hdf5_texts_of(
    hid_t type, std::size_t count, const std::function<herr_t(hid_t, void*)>& read);

/// Texts and numbers at a group or a data set; of the rest, names.
Hdf5Attributes hdf5_attributes_of(hid_t object);

/// What stands for an object in lists of references; 0 where it has none.
std::uint64_t hdf5_reference_to(hid_t object);

/// The references to the scales of each dimension; empty where there is no such list, or a damaged
/// one. They are compared with those of the data sets that are met, and never followed: a damaged
/// one leads nowhere.
std::vector<std::vector<std::uint64_t>> hdf5_scales_of(hid_t data, std::size_t rank);

}  // namespace impactrig::acquisition
