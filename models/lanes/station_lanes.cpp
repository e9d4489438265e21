// SPDX-License-Identifier: BSD-3-Clause
#include "models/lanes/station_lanes.hpp"

#include "models/lanes/processor.hpp"
#include "models/lanes/station_kernels.hpp"

namespace impactrig::models {

void find_slopes(const SlopesOfModes& modes) {
  on_processor<const SlopesOfModes>(modes, find_slopes_by<2>, find_slopes_avx2, find_slopes_avx512);
}

void find_force_of_pull(const PullOnModes& modes) {
  on_processor<const PullOnModes>(modes, find_force_of_pull_by<2>, find_force_of_pull_avx2,
                                  find_force_of_pull_avx512);
}

void find_third_order_pull(ThirdOrderPull& stations) {
  on_processor<ThirdOrderPull>(stations, find_third_order_pull_by<2>, find_third_order_pull_avx2,
                               find_third_order_pull_avx512);
}

}  // namespace impactrig::models
