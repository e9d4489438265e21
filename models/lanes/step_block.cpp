// SPDX-License-Identifier: BSD-3-Clause
#include "models/lanes/step_block.hpp"

#include <cstddef>

namespace impactrig::models {

StepBlock::StepBlock(const Collocation& rule) {
  const auto s = static_cast<std::size_t>(rule.nodes());
  rows_.resize(2 * s * s + 9 * s);
  LaneRow* next = rows_.data();
  const auto take = [&](std::size_t count) {
    LaneRow* const taken = next;
    next += count;
    return taken;
  };
  lanes_.nodes = rule.nodes();
  lanes_.to_series = rule.to_series().data();
  for (LaneRow** matrix : {&lanes_.displacement_of_force, &lanes_.velocity_of_force})
    *matrix = take(s * s);
  for (LaneRow** row : {&lanes_.force, &lanes_.displacement, &lanes_.velocity, &lanes_.dissipation,
                        &lanes_.force_series, &lanes_.displacement_series,
                        &lanes_.dissipation_series, &lanes_.to_depth, &lanes_.to_rate})
    *row = take(s);
}

}  // namespace impactrig::models
