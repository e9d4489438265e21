// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "models/collocation/collocation.hpp"
#include "models/lanes/step_lanes.hpp"

namespace impactrig::models {

/// StepLanes with the memory they stand in.
class StepBlock {
 public:
  explicit StepBlock(const Collocation& rule);

  StepLanes& lanes() { return lanes_; }

 private:
  std::vector<LaneRow> rows_;
  StepLanes lanes_;
};

}  // namespace impactrig::models
