// SPDX-License-Identifier: BSD-3-Clause
//
// Compiled for AVX2 with fused multiplication where the compiler can (CMakeLists.txt); called where
// the processor can.
#include "models/lanes/advance_modes.hpp"
#include "models/lanes/processor.hpp"
#include "models/lanes/solve_steps.hpp"
#include "models/lanes/step_modes.hpp"

namespace impactrig::models {

void advance_modes_avx2(ModesUnderForce& modes) {
  ModeAdvance<4>(modes).advance();
}

void step_modes_avx2(const ModesOverStep& modes) {
  ModeStep<4>(modes).respond();
}

void solve_steps_avx2(StepLanes& lanes) {
  solve_steps_by<4>(lanes);
}

}  // namespace impactrig::models
