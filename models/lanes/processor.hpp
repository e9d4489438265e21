// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/lanes/mode_lanes.hpp"
#include "models/lanes/step_lanes.hpp"

namespace impactrig::models {

/// What the lanes are compiled for.
enum class Processor { any, avx2, avx512 };

/// The best of them that this machine has.
Processor processor();

void advance_modes_avx2(ModesUnderForce& modes);
void advance_modes_avx512(ModesUnderForce& modes);
void step_modes_avx2(const ModesOverStep& modes);
void step_modes_avx512(const ModesOverStep& modes);
void solve_steps_avx2(StepLanes& lanes);
void solve_steps_avx512(StepLanes& lanes);

}  // namespace impactrig::models
