// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/contact/damping/damping_law_entry.hpp"

namespace impactrig::models {

/// f = f_0(δ) (1 + d δ̇ / v),   d = 8 (1 − e) / (5 e)
///
/// A free rigid impact rebounds within 0.046 of e: with 0.470 for 0.5, with 0.894 for 0.9.
///
/// Source: [FloresEtAl2011].
struct Flores {
  static constexpr DampingLawText text{
      .name = "flores",
      .description = "made for soft contacts, all e",
      .formula = "d = 8 (1-e) / (5e)",
      .validity = "within 0.046 of e everywhere; 0.470 for 0.5, 0.894 for 0.9",
      .source = "FloresEtAl2011",
      .smallest_restitution = 0.01};

  static double factor(double e) { return 1.6 * (1.0 - e) / e; }
};

}  // namespace impactrig::models
