// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <numbers>

#include "models/rig.hpp"

namespace impactrig::tests {

/// A bar of circular section; length and radius [m], [Pa], [kg/m³].
inline models::Beam round_bar(double length, double radius, double youngs_modulus, double density) {
  return {.length = length,
          .area = std::numbers::pi * radius * radius,
          .second_moment = std::numbers::pi * std::pow(radius, 4) / 4.0,
          .youngs_modulus = youngs_modulus,
          .density = density};
}

/// A bar of rectangular section, `height` in the direction of swing; lengths [m], [Pa], [kg/m³].
inline models::Beam rectangular_bar(double length, double width, double height,
                                    double youngs_modulus, double density, double poisson_ratio) {
  return {.length = length,
          .area = width * height,
          .second_moment = width * std::pow(height, 3) / 12.0,
          .youngs_modulus = youngs_modulus,
          .density = density,
          .poisson_ratio = poisson_ratio};
}

}  // namespace impactrig::tests
