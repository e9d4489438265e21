// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <numbers>

#include "models/contact/damping/damping_law_entry.hpp"

namespace impactrig::models {

/// f = f_0 + 2 ξ √(m f_0 / δ) δ̇ while closing, f_0 after;   ξ = (9 √5 / 2) (1 − e²) / {e [e (9π −
/// 16) + 16]}
///
/// Made for Hertz's spring, where f_0 / δ is K √δ: a free rigid impact rebounds within 0.009 of e.
/// It never pulls. ξ is quoted from memory in the reference pages, which found it to hold.
///
/// Source: [Jankowski2006].
struct Jankowski {
  static constexpr DampingLawText text{.name = "jankowski",
                                       .description = "damping in approach only",
                                       .formula = "f = f0 + 2 xi sqrt(m f0/d) d' while d' > 0",
                                       .validity = "hertz-point: within 0.009 of e",
                                       .source = "Jankowski2006",
                                       .form = DampingForm::closing,
                                       .speed = DampingSpeed::none,
                                       .smallest_restitution = 0.01};

  static double factor(double e) {
    return 4.5 * std::sqrt(5.0) * (1.0 - e * e) /
           (e * (e * (9.0 * std::numbers::pi - 16.0) + 16.0));
  }
};

}  // namespace impactrig::models
