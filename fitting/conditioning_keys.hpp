// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "datasets/conditioning.hpp"
#include "fitting/toml_reader.hpp"

namespace impactrig::fitting {

/// The steps of [[conditioning]], which the rig file and the map of a recording's channels share;
/// none when it is absent. Throws datasets::InputError.
std::vector<datasets::ConditioningStep> read_conditioning(TableReader& root);

}  // namespace impactrig::fitting
