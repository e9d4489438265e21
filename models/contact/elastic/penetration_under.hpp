// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "models/contact/elastic/elastic_state.hpp"

namespace impactrig::models {

/// The penetration under a force > 0, for a law without a closed form for it, from a first guess
/// that is too deep. The law is convex: Newton's method descends to the root.
template <typename Law, typename T>
T penetration_under(const Law& law, const T& force, double guess) {
  double depth = guess;
  for (int i = 0; i < 60; ++i) {
    const ForceAndStiffness<T> there = law.force_and_stiffness(T(depth));
    const double step = (value_of(there.force) - value_of(force)) / value_of(there.stiffness);
    depth -= step;
    if (!(std::abs(step) > 1e-15 * depth)) break;
  }
  // the last step carries the derivatives
  const ForceAndStiffness<T> there = law.force_and_stiffness(T(depth));
  return T(depth) - (there.force - force) / there.stiffness;
}

}  // namespace impactrig::models
