// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "models/contact/damping/damping_law_entry.hpp"

namespace impactrig::models {

/// As `tsuji`, with the polynomial of degree 6 that particle codes fitted to ζ(e).
///
/// A free rigid impact that may pull rebounds within 0.0012 of e, for e >= 0.1; 0.9994 for e = 1.
///
/// Source: [Marshall2009].
struct TsujiMarshall {
  static constexpr DampingLawText text{
      .name = "tsuji-marshall",
      .description = "tsuji with the polynomial of particle codes",
      .formula = "zeta = sqrt(2/5) (1.2728 - 4.2783 e + ... + 4.8218 e^6)",
      .validity = "tension allowed: within 0.0012 of e; kept at zero: 0.550 for 0.5",
      .source = "Marshall2009",
      .form = DampingForm::natural,
      .speed = DampingSpeed::none};

  static double factor(double e) {
    constexpr double by_power[] = {1.2728, -4.2783, 11.087, -22.348, 27.467, -18.022, 4.8218};
    double sum = 0.0;
    for (int i = 6; i >= 0; --i) sum = sum * e + by_power[i];
    return std::sqrt(0.4) * sum;
  }
};

}  // namespace impactrig::models
