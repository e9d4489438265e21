// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/contact/damping/damping_law_entry.hpp"

namespace impactrig::models {

/// f = f_0(δ) (1 + d δ̇ / v),   d = 3 (1 − e) / 2
///
/// The first order of the exact law in 1 − e: a free rigid impact rebounds with 0.909 where e = 0.9
/// was asked for, with 0.663 for 0.5.
///
/// Source: [HuntCrossley1975].
struct HuntCrossley {
  static constexpr DampingLawText text{
      .name = "hunt-crossley",
      .description = "first order of the exact law in 1 - e",
      .formula = "d = 3 (1-e) / 2",
      .validity = "e > 0.9: rebounds with 0.909 for 0.9, 0.663 for 0.5",
      .source = "HuntCrossley1975"};

  static double factor(double e) { return 1.5 * (1.0 - e); }
};

}  // namespace impactrig::models
