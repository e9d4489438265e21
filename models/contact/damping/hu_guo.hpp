// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/contact/damping/damping_law_entry.hpp"

namespace impactrig::models {

/// f = f_0(δ) (1 + d δ̇ / v),   d = 3 (1 − e) / (2 e)
///
/// A free rigid impact rebounds within 0.003 of e for e >= 0.7, with 0.488 for 0.5. Ye et al.
/// (2009) have the same factor for a linear spring.
///
/// Source: [HuGuo2015].
struct HuGuo {
  static constexpr DampingLawText text{.name = "hu-guo",
                                       .description = "Hunt and Crossley's divided by e",
                                       .formula = "d = 3 (1-e) / (2e)",
                                       .validity = "e > 0.7: within 0.003; 0.488 for 0.5",
                                       .source = "HuGuo2015",
                                       .smallest_restitution = 0.01};

  static double factor(double e) { return 1.5 * (1.0 - e) / e; }
};

}  // namespace impactrig::models
