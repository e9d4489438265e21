// SPDX-License-Identifier: BSD-3-Clause
//
// Compiled for AVX-512 where the compiler can (CMakeLists.txt); called where
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

void advance_modes_avx512(ModesUnderForce& modes) {
  ModeAdvance<8>(modes).advance();
}

void step_modes_avx512(const ModesOverStep& modes) {
  ModeStep<8>(modes).respond();
}

void find_sum_avx512(const WeightedSum& sum) {
  find_sum_by<8>(sum);
}

void find_values_avx512(const SeriesAtNodes& series) {
  find_values_by<8>(series);
}

void find_at_nodes_avx512(const PointAtNodes& point) {
  find_at_nodes_by<8>(point);
}

void find_at_end_avx512(const ModesAtEnd& modes) {
  find_at_end_by<8>(modes);
}

void solve_steps_avx512(StepLanes& lanes) {
  solve_steps_by<8>(lanes);
}

void map_stages_avx512(const StagesByMap& stages) {
  map_stages_in<8>(stages);
}

void turn_stages_avx512(const TurnedStages& stages) {
  turn_stages_in<8>(stages);
}

void find_residual_avx512(const AncfResidual& residual) {
  find_residual_in<8>(residual);
}

void solve_chain_avx512(const FactoredChain& chain) {
  solve_chain_in<8>(chain);
}

void count_modes_avx512(const BarShifts& shifts) {
  count_modes_by<8>(shifts);
}

void find_modes_avx512(const BarModesBetween& modes) {
  find_modes_by<8>(modes);
}

void find_motion_avx512(const BarUnderLoads& loads) {
  find_motion_by<8>(loads);
}

void find_slopes_avx512(const SlopesOfModes& modes) {
  find_slopes_by<8>(modes);
}

void find_force_of_pull_avx512(const PullOnModes& modes) {
  find_force_of_pull_by<8>(modes);
}

void find_third_order_pull_avx512(ThirdOrderPull& stations) {
  find_third_order_pull_by<8>(stations);
}

void multiply_avx512(const MatrixProduct& product) {
  multiply_by<8>(product);
}

void find_dot_avx512(ProductOfRows& rows) {
  find_dot_by<8>(rows);
}

}  // namespace impactrig::models
