// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/contact/damping/damping_law_entry.hpp"

namespace impactrig::models {

/// f = f_0 / (1 − d δ̇ / v),   d = 6 (1 − e) / ((2e − 1)² + 3)
///
/// Exact in this form: a free rigid impact rebounds with e. It needs d < 1, e > 0.5: at 0.5 the
/// force is infinite at touch.
///
/// Source: [HerbertMcWhannell1977].
struct HerbertMcWhannellImplicit {
  static constexpr DampingLawText text{
      .name = "herbert-mcwhannell-implicit",
      .description = "exact restitution in the implicit form",
      .formula = "f = f0 / (1 - d d'/v), d = 6 (1-e) / ((2e-1)^2 + 3)",
      .validity = "e > 0.5, where the force at touch is finite; exact there",
      .source = "HerbertMcWhannell1977",
      .form = DampingForm::implicit,
      .smallest_restitution = 0.52};

  static double factor(double e) {
    const double m = 2.0 * e - 1.0;
    return 6.0 * (1.0 - e) / (m * m + 3.0);
  }
};

}  // namespace impactrig::models
