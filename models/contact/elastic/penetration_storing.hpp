// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "models/contact/elastic/elastic_state.hpp"

namespace impactrig::models {

/// The penetration at which a law without a closed form for it has stored an energy, from a first
/// guess; both > 0. Newton's method for ln U of ln δ, which is nearly straight: U ~ δ² or so.
template <typename Law, typename T>
T penetration_storing(const Law& law, const T& energy, double guess) {
  double depth = guess;
  for (int i = 0; i < 60; ++i) {
    const double stored = value_of(law.energy(T(depth)));
    const double power = depth * value_of(law.force(T(depth))) / stored;
    const double factor = std::pow(value_of(energy) / stored, 1.0 / power);
    depth *= std::clamp(factor, 1e-30, 1e30);
    if (std::abs(factor - 1.0) < 1e-14) break;
  }
  // the last step carries the derivatives
  return T(depth) - (law.energy(T(depth)) - energy) / law.force(T(depth));
}

}  // namespace impactrig::models
