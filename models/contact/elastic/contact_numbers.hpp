// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string_view>

#include "models/rig.hpp"

namespace impactrig::models {

/// What the elastic laws take from a contact, as numbers or as scalars that carry derivatives.
template <typename T = double>
struct ContactNumbers {
  Counterface counterface = Counterface::groove;
  int exponent = 1;
  T radius;                                  ///< R_1 [m]
  T counter_radius;                          ///< R_2 [m]; of a plane unused
  T counter_depth;                           ///< of a plane, down to what holds it [m]
  T length;                                  ///< L [m]
  T modulus, poisson_ratio;                  ///< bar [Pa], [-]
  T counter_modulus, counter_poisson_ratio;  ///< stop [Pa], [-]
  T reference_length;                        ///< ℓ of exponent 1 [m]
  T stiffness;                               ///< K [N/mⁿ]
  T power;                                   ///< n [-]

  /// σ_l = (1 − ν_l²) / (π E_l) of bar and stop [1/Pa].
  T bar_compliance() const { return plane_strain(modulus, poisson_ratio); }

  T counter_compliance() const { return plane_strain(counter_modulus, counter_poisson_ratio); }

  T sigma() const { return bar_compliance() + counter_compliance(); }

  /// E* = 1 / (π σ) [Pa].
  T effective_modulus() const { return 1.0 / (std::numbers::pi * sigma()); }

  /// 1 / R_eq = ΔR / (R_1 R_2) [1/m], > 0.
  T curvature() const {
    const T own = 1.0 / radius;
    if (counterface == Counterface::plane) return own;
    const T other = 1.0 / counter_radius;
    if (counterface == Counterface::groove) return own - other;
    return own + other;
  }

  /// ΔR: R_2 − R_1 in a groove, R_1 + R_2 against a cylinder [m]; a plane has none.
  T radii() const {
    if (counterface == Counterface::groove) return counter_radius - radius;
    return counter_radius + radius;
  }

 private:
  static T plane_strain(const T& modulus, const T& poisson_ratio) {
    return (1.0 - poisson_ratio * poisson_ratio) / (std::numbers::pi * modulus);
  }
};

/// Both throw std::invalid_argument, for laws that have no formula for a counterface.
inline void require_second_radius(std::string_view law, Counterface counterface) {
  if (counterface == Counterface::plane)
    throw std::invalid_argument(fmt::format(
        "contact.counterface: the law '{}' does not know a plane, against which the approach "
        "depends on the depth; take goldsmith, dubowsky-freudenstein, or johnson with the depth",
        law));
}

inline void require_groove(std::string_view law, Counterface counterface) {
  if (counterface != Counterface::groove)
    throw std::invalid_argument(fmt::format(
        "contact.counterface: the law '{}' is for a groove; dubowsky-freudenstein knows every "
        "counterface",
        law));
}

}  // namespace impactrig::models
