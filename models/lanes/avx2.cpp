// SPDX-License-Identifier: BSD-3-Clause
//
// Compiled for AVX2 with fused multiplication where the compiler can (CMakeLists.txt); called where
// the processor can.
#include "models/lanes/advance_modes.hpp"
#include "models/lanes/bar_sweep.hpp"
#include "models/lanes/processor.hpp"
#include "models/lanes/solve_steps.hpp"
#include "models/lanes/stage_kernels.hpp"
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

void map_stages_avx2(const StagesByMap& stages) {
  map_stages_in<4>(stages);
}

void turn_stages_avx2(const TurnedStages& stages) {
  turn_stages_in<4>(stages);
}

void find_residual_avx2(const AncfResidual& residual) {
  find_residual_in<4>(residual);
}

void solve_chain_avx2(const FactoredChain& chain) {
  solve_chain_in<4>(chain);
}

void count_modes_avx2(const BarShifts& shifts) {
  count_modes_by<4>(shifts);
}

void find_modes_avx2(const BarModesBetween& modes) {
  find_modes_by<4>(modes);
}

void find_motion_avx2(const BarUnderLoads& loads) {
  find_motion_by<4>(loads);
}

}  // namespace impactrig::models
