// SPDX-License-Identifier: BSD-3-Clause
#include "models/lanes/stage_lanes.hpp"

#include "models/lanes/processor.hpp"
#include "models/lanes/stage_kernels.hpp"

namespace impactrig::models {

void map_stages(const StagesByMap& stages) {
  switch (processor()) {
    case Processor::avx512:
      return map_stages_avx512(stages);
    case Processor::avx2:
      return map_stages_avx2(stages);
    case Processor::any:
      return map_stages_in<2>(stages);
  }
}

void turn_stages(const TurnedStages& stages) {
  switch (processor()) {
    case Processor::avx512:
      return turn_stages_avx512(stages);
    case Processor::avx2:
      return turn_stages_avx2(stages);
    case Processor::any:
      return turn_stages_in<2>(stages);
  }
}

void find_residual(const AncfResidual& residual) {
  switch (processor()) {
    case Processor::avx512:
      return find_residual_avx512(residual);
    case Processor::avx2:
      return find_residual_avx2(residual);
    case Processor::any:
      return find_residual_in<2>(residual);
  }
}

void solve_chain(const FactoredChain& chain) {
  switch (processor()) {
    case Processor::avx512:
      return solve_chain_avx512(chain);
    case Processor::avx2:
      return solve_chain_avx2(chain);
    case Processor::any:
      return solve_chain_in<2>(chain);
  }
}

}  // namespace impactrig::models
