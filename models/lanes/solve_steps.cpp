// SPDX-License-Identifier: BSD-3-Clause
#include "models/lanes/solve_steps.hpp"

#include "models/lanes/processor.hpp"

namespace impactrig::models {

void solve_steps(StepLanes& lanes) {
  on_processor(lanes, solve_steps_by<2>, solve_steps_avx2, solve_steps_avx512);
}

}  // namespace impactrig::models
