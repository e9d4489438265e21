// SPDX-License-Identifier: BSD-3-Clause
//
// Compiled for AVX2 with fused multiplication where the compiler can (CMakeLists.txt); called where
// the processor can.
#include "models/lanes/advance_modes.hpp"
#include "models/lanes/bar_sweep.hpp"
#include "models/lanes/processor.hpp"
#include "models/lanes/product_kernels.hpp"
#include "models/lanes/solve_steps.hpp"
#include "models/lanes/stage_kernels.hpp"
#include "models/lanes/station_kernels.hpp"
#include "models/lanes/step_maps.hpp"
#include "models/lanes/step_modes.hpp"

namespace impactrig::models {

void advance_modes_avx2(ModesUnderForce& modes) {
  ModeAdvance<4>(modes).advance();
}

void step_modes_avx2(const ModesOverStep& modes) {
  ModeStep<4>(modes).respond();
}

void find_sum_avx2(const WeightedSum& sum) {
  find_sum_by<4>(sum);
}

void find_values_avx2(const SeriesAtNodes& series) {
  find_values_by<4>(series);
}

void find_at_nodes_avx2(const PointAtNodes& point) {
  find_at_nodes_by<4>(point);
}

void find_at_end_avx2(const ModesAtEnd& modes) {
  find_at_end_by<4>(modes);
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

void find_slopes_avx2(const SlopesOfModes& modes) {
  find_slopes_by<4>(modes);
}

void find_force_of_pull_avx2(const PullOnModes& modes) {
  find_force_of_pull_by<4>(modes);
}

void find_third_order_pull_avx2(ThirdOrderPull& stations) {
  find_third_order_pull_by<4>(stations);
}

void multiply_avx2(const MatrixProduct& product) {
  multiply_by<4>(product);
}

void find_dot_avx2(ProductOfRows& rows) {
  find_dot_by<4>(rows);
}

}  // namespace impactrig::models
