// SPDX-License-Identifier: BSD-3-Clause
#include "models/lanes/solve_steps.hpp"

#include "models/lanes/processor.hpp"

namespace impactrig::models {

void solve_steps(StepLanes& lanes) {
  switch (processor()) {
    case Processor::avx512:
      return solve_steps_avx512(lanes);
    case Processor::avx2:
      return solve_steps_avx2(lanes);
    case Processor::any:
      return solve_steps_by<2>(lanes);
  }
}

}  // namespace impactrig::models
