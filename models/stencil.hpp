// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

namespace impactrig::models {

/// Derivative of a smooth function from its values at five places around a point, with an error of
/// the fourth order in their distance: f' = Σ weight f(x + offset step) / step.
struct Stencil {
  std::array<double, 5> offsets, weights;

  static Stencil centred() {
    return {{-2.0, -1.0, 0.0, 1.0, 2.0}, {1.0 / 12.0, -8.0 / 12.0, 0.0, 8.0 / 12.0, -1.0 / 12.0}};
  }

  static Stencil forward() {
    return {{0.0, 1.0, 2.0, 3.0, 4.0},
            {-25.0 / 12.0, 48.0 / 12.0, -36.0 / 12.0, 16.0 / 12.0, -3.0 / 12.0}};
  }

  static Stencil backward() {
    return {{-4.0, -3.0, -2.0, -1.0, 0.0},
            {3.0 / 12.0, -16.0 / 12.0, 36.0 / 12.0, -48.0 / 12.0, 25.0 / 12.0}};
  }
};

}  // namespace impactrig::models
