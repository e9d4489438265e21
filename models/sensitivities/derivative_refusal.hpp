// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "models/rig.hpp"

namespace impactrig::models {

/// Why simulate() tells no derivatives by a number of the rig, or none that would mean something,
/// in a sentence with rig-file keys; empty where it tells them. The number must be one that the rig
/// has: reading it must not change the rig.
std::string derivative_refusal(const Rig& rig, const Solver& solver, RigParameter parameter);

/// Why small motion, where that is asked for, has none by this parameter; "" where it has them.
std::string small_motion_derivative_refusal(const Rig& rig, RigParameter parameter);

}  // namespace impactrig::models
