// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <string>
#include <vector>

namespace impactrig::acquisition {

/// Why a data set's bytes cannot be what it declares, or are not read; "" when they can. `element`:
/// size of one [bytes].
std::string hdf5_storage_problem(hid_t data, const std::vector<std::uint64_t>& shape,
                                 std::uint64_t element, std::uint64_t file_bytes);

}  // namespace impactrig::acquisition
