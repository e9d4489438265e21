// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// Refuses units that would go to the wrong ones of `count` columns or channels (`what`): unless
/// none is stated, there must be one for each ("" leaves the file's). Throws datasets::InputError.
void check_stated_units(const std::vector<std::string>& units, std::size_t count,
                        std::string_view what, const std::string& path);

/// Gives the channels of `record`, in their order, the units that the user states instead of the
/// file's ("" leaves that one). Throws what check_stated_units() throws.
void take_stated_units(const std::vector<std::string>& units, const std::string& path,
                       datasets::Record& record);

}  // namespace impactrig::acquisition
