// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string_view>

#include "models/rig.hpp"

namespace impactrig::fitting {

/// A number of the rig that a fit may free, by its key in the rig file.
struct PhysicalParameter {
  std::string_view name;
  std::string_view unit;  ///< SI
  double lower, upper;    ///< bounds; a zero upper bound: ten times the starting value
  bool of_shot;           ///< differs from recording to recording
  double& (*of)(models::Rig& rig);
};

/// Every parameter of the physics there is; a new one is one line here.
std::span<const PhysicalParameter> physical_parameters();

/// Throws std::invalid_argument on an unknown name (and lists the known ones).
const PhysicalParameter& physical_parameter(std::string_view name);

}  // namespace impactrig::fitting
