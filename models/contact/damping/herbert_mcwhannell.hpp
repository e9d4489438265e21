// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/contact/damping/damping_law_entry.hpp"

namespace impactrig::models {

/// f = f_0(δ) (1 + d δ̇ / v),   d = 6 (1 − e) / ((2e − 1)² + 3)
///
/// The third order of the exact law. A free rigid impact rebounds with 0.901 for e = 0.9, with
/// 0.594 for 0.5. In the implicit form f = f_0 / (1 − d δ̇ / v) the same factor is exact.
///
/// Source: [HerbertMcWhannell1977].
struct HerbertMcWhannell {
  static constexpr DampingLawText text{
      .name = "herbert-mcwhannell",
      .description = "exact for the implicit form; here near e = 1",
      .formula = "d = 6 (1-e) / ((2e-1)^2 + 3)",
      .validity = "e > 0.85: rebounds with 0.901 for 0.9, 0.594 for 0.5",
      .source = "HerbertMcWhannell1977"};

  static double factor(double e) {
    const double m = 2.0 * e - 1.0;
    return 6.0 * (1.0 - e) / (m * m + 3.0);
  }
};

}  // namespace impactrig::models
