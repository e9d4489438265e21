// SPDX-License-Identifier: BSD-3-Clause
#include "models/lanes/stage_lanes.hpp"

#include "models/lanes/processor.hpp"
#include "models/lanes/stage_kernels.hpp"

namespace impactrig::models {

void map_stages(const StagesByMap& stages) {
  on_processor(stages, map_stages_in<2>, map_stages_avx2, map_stages_avx512);
}

void turn_stages(const TurnedStages& stages) {
  on_processor(stages, turn_stages_in<2>, turn_stages_avx2, turn_stages_avx512);
}

void find_residual(const AncfResidual& residual) {
  on_processor(residual, find_residual_in<2>, find_residual_avx2, find_residual_avx512);
}

void solve_chain(const FactoredChain& chain) {
  on_processor(chain, solve_chain_in<2>, solve_chain_avx2, solve_chain_avx512);
}

}  // namespace impactrig::models
