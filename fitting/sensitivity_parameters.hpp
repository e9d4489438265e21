// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "fitting/parameters.hpp"

namespace impactrig::fitting {

/// The numbers by which a prediction of the rig is to be differentiated, by the names that a fit
/// frees them under, or of stated_parameters(). "all", alone: each that the rig has and that is not
/// zero. Throws std::invalid_argument on an unknown name (and lists the known ones), on one that is
/// named twice, and on a number that the rig has not.
std::vector<PhysicalParameter> sensitivity_parameters(const models::Rig& rig,
                                                      const std::vector<std::string>& names);

}  // namespace impactrig::fitting
