// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <cstdint>

#include "models/contact/damping/damping_law_entry.hpp"

namespace impactrig::models {

/// As `tsuji`, with the ζ that rebounds with e when the contact does not pull.
///
/// exp(−2 ζ arccos ζ / √(1 − ζ²)) = e for every elastic law, mass and speed; arcosh where ζ > 1, e
/// < 0.135.
///
/// Source: closed form of the reference pages, for any elastic law by the scaling told at `tsuji`.
struct TsujiExact {
  static constexpr DampingLawText text{
      .name = "tsuji-exact",
      .description = "tsuji with the damping that returns e without pulling",
      .formula = "exp(-2 zeta acos(zeta)/sqrt(1-zeta^2)) = e",
      .validity = "tension kept at zero: exact for every elastic law",
      .source = "TsujiEtAl1992, with the closed form of the rebound without tension",
      .form = DampingForm::natural,
      .speed = DampingSpeed::none,
      .smallest_restitution = 0.005};

  static double factor(double e) {
    if (e >= 1.0) return 0.0;
    const double target = std::log(e);
    std::uintmax_t most = 200;
    const auto [low, high] = boost::math::tools::toms748_solve(
        [&](double zeta) { return log_rebound(zeta) - target; }, 0.0, 1.0 + 0.5 / std::sqrt(e),
        boost::math::tools::eps_tolerance<double>(), most);
    return 0.5 * (low + high);
  }

  /// ln of the rebound ratio at a damping ratio, without tension.
  static double log_rebound(double zeta) {
    const double square = 1.0 - zeta * zeta;
    // near 1 by the series of arccos ζ / √(1 − ζ²) in 1 − ζ
    if (const double near = 1.0 - zeta; std::abs(near) < 1e-4)
      return -2.0 * zeta * (1.0 + near / 3.0 + 2.0 / 15.0 * near * near);
    if (square > 0.0) return -2.0 * zeta * std::acos(zeta) / std::sqrt(square);
    return -2.0 * zeta * std::acosh(zeta) / std::sqrt(-square);
  }
};

}  // namespace impactrig::models
