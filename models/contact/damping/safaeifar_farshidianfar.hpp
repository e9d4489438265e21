// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/contact/damping/damping_law_entry.hpp"

namespace impactrig::models {

/// f = f_0(δ) (1 + d δ̇ / v),   d = 5 (1 − e) / (4 e)
///
/// A free rigid impact rebounds within 0.04 of e: with 0.536 for 0.5, with 0.915 for 0.9. The
/// factor is not confirmed from the printed page.
///
/// Source: [SafaeifarFarshidianfar2020].
struct SafaeifarFarshidianfar {
  static constexpr DampingLawText text{
      .name = "safaeifar-farshidianfar",
      .description = "between the others, all e",
      .formula = "d = 5 (1-e) / (4e)",
      .validity = "within 0.04 of e everywhere; 0.536 for 0.5, 0.915 for 0.9",
      .source = "SafaeifarFarshidianfar2020",
      .smallest_restitution = 0.01};

  static double factor(double e) { return 1.25 * (1.0 - e) / e; }
};

}  // namespace impactrig::models
