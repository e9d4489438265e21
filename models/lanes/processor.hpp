// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/lanes/bar_lanes.hpp"
#include "models/lanes/mode_lanes.hpp"
#include "models/lanes/product_lanes.hpp"
#include "models/lanes/stage_lanes.hpp"
#include "models/lanes/station_lanes.hpp"
#include "models/lanes/step_lanes.hpp"

namespace impactrig::models {

/// What the lanes are compiled for.
enum class Processor { any, avx2, avx512 };

/// The best of them that this machine has.
Processor processor();

/// Does the work by the code for that one.
template <typename Work>
void on_processor(Work& work, void (*plain)(Work&), void (*avx2)(Work&), void (*avx512)(Work&)) {
  switch (processor()) {
    case Processor::avx512:
      return avx512(work);
    case Processor::avx2:
      return avx2(work);
    case Processor::any:
      return plain(work);
  }
}

void advance_modes_avx2(ModesUnderForce& modes);
void advance_modes_avx512(ModesUnderForce& modes);
void step_modes_avx2(const ModesOverStep& modes);
void step_modes_avx512(const ModesOverStep& modes);
void find_sum_avx2(const WeightedSum& sum);
void find_sum_avx512(const WeightedSum& sum);
void find_values_avx2(const SeriesAtNodes& series);
void find_values_avx512(const SeriesAtNodes& series);
void find_at_nodes_avx2(const PointAtNodes& point);
void find_at_nodes_avx512(const PointAtNodes& point);
void find_at_end_avx2(const ModesAtEnd& modes);
void find_at_end_avx512(const ModesAtEnd& modes);
void solve_steps_avx2(StepLanes& lanes);
void solve_steps_avx512(StepLanes& lanes);
void map_stages_avx2(const StagesByMap& stages);
void map_stages_avx512(const StagesByMap& stages);
void turn_stages_avx2(const TurnedStages& stages);
void turn_stages_avx512(const TurnedStages& stages);
void find_residual_avx2(const AncfResidual& residual);
void find_residual_avx512(const AncfResidual& residual);
void solve_chain_avx2(const FactoredChain& chain);
void solve_chain_avx512(const FactoredChain& chain);
void count_modes_avx2(const BarShifts& shifts);
void count_modes_avx512(const BarShifts& shifts);
void find_modes_avx2(const BarModesBetween& modes);
void find_modes_avx512(const BarModesBetween& modes);
void find_motion_avx2(const BarUnderLoads& loads);
void find_motion_avx512(const BarUnderLoads& loads);
void find_slopes_avx2(const SlopesOfModes& modes);
void find_slopes_avx512(const SlopesOfModes& modes);
void find_force_of_pull_avx2(const PullOnModes& modes);
void find_force_of_pull_avx512(const PullOnModes& modes);
void find_third_order_pull_avx2(ThirdOrderPull& stations);
void find_third_order_pull_avx512(ThirdOrderPull& stations);
void multiply_avx2(const MatrixProduct& product);
void multiply_avx512(const MatrixProduct& product);
void find_dot_avx2(ProductOfRows& rows);
void find_dot_avx512(ProductOfRows& rows);

}  // namespace impactrig::models
