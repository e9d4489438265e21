// SPDX-License-Identifier: BSD-3-Clause
#include "models/lanes/bar_lanes.hpp"

#include "models/lanes/bar_sweep.hpp"
#include "models/lanes/processor.hpp"

namespace impactrig::models {

int bar_work(const BarForms& bar) {
  constexpr int most_lanes = 8;
  const int step = bar.numbers() - 3 + 2 * bar.values - 2;
  const int rest = 2 * bar.values - 2;
  return most_lanes * (1 + bar.elements * (step + rest));
}

void count_modes_below(const BarShifts& shifts) {
  on_processor(shifts, count_modes_by<2>, count_modes_avx2, count_modes_avx512);
}

void find_modes_between(const BarModesBetween& modes) {
  on_processor(modes, find_modes_by<2>, find_modes_avx2, find_modes_avx512);
}

void find_motion_under(const BarUnderLoads& loads) {
  on_processor(loads, find_motion_by<2>, find_motion_avx2, find_motion_avx512);
}

}  // namespace impactrig::models
