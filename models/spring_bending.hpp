// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/rig.hpp"

namespace impactrig::models {

/// The energy with which the hinge's spring bends the bar, over the spring's own.
double spring_bending(const Rig& rig);

}  // namespace impactrig::models
