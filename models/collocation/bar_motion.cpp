// SPDX-License-Identifier: BSD-3-Clause
#include "models/collocation/bar_motion.hpp"

#include "models/sensitivities/motion_slope.hpp"

namespace impactrig::models {

std::unique_ptr<MotionSlope> BarMotion::follow(const RigEffect&, const Solver&,
                                               const HistoryRequest&) {
  return nullptr;
}

}  // namespace impactrig::models
