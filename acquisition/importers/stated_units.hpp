// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// Gives the channels of `record`, in their order, the units that the user states instead of the
/// file's ("" leaves that one). Throws datasets::InputError when there are more than channels.
void take_stated_units(const std::vector<std::string>& units, const std::string& path,
                       datasets::Record& record);

}  // namespace impactrig::acquisition
