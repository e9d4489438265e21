// SPDX-License-Identifier: BSD-3-Clause
#include "models/lanes/step_block.hpp"

#include <cstddef>

namespace impactrig::models {

StepBlock::StepBlock(int modes, const Collocation& rule) {
  const auto m = static_cast<std::size_t>(modes);
  const auto s = static_cast<std::size_t>(rule.nodes());
  rows_.resize(5 * m * s + 2 * s * s + 8 * m + 7 * s);
  LaneRow* next = rows_.data();
  const auto take = [&](std::size_t count) {
    LaneRow* const taken = next;
    next += count;
    return taken;
  };
  lanes_.modes = modes;
  lanes_.nodes = rule.nodes();
  lanes_.to_series = rule.to_series().data();
  for (LaneRow** matrix : {&lanes_.displacement_of_a, &lanes_.displacement_of_rate,
                           &lanes_.velocity_of_a, &lanes_.a_of_force, &lanes_.rate_of_force})
    *matrix = take(m * s);
  for (LaneRow** matrix : {&lanes_.displacement_of_force, &lanes_.velocity_of_force})
    *matrix = take(s * s);
  for (LaneRow** row : {&lanes_.cosine, &lanes_.sine_over_omega, &lanes_.minus_omega_sine,
                        &lanes_.struck, &lanes_.a, &lanes_.rate, &lanes_.end_a, &lanes_.end_rate})
    *row = take(m);
  for (LaneRow** row :
       {&lanes_.force, &lanes_.displacement, &lanes_.velocity, &lanes_.dissipation,
        &lanes_.force_series, &lanes_.displacement_series, &lanes_.dissipation_series})
    *row = take(s);
}

}  // namespace impactrig::models
