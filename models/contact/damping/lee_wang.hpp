// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/contact/damping/damping_law_entry.hpp"

namespace impactrig::models {

/// f = f_0(δ) (1 + d δ̇ / v),   d = 3 (1 − e) / 4
///
/// Half of what the first order asks for: a free rigid impact rebounds with 0.952 for e = 0.9, with
/// 0.799 for 0.5.
///
/// Source: [LeeWang1983].
struct LeeWang {
  static constexpr DampingLawText text{
      .name = "lee-wang",
      .description = "half of Hunt and Crossley's damping",
      .formula = "d = 3 (1-e) / 4",
      .validity = "e > 0.95: rebounds with 0.952 for 0.9, 0.799 for 0.5",
      .source = "LeeWang1983"};

  static double factor(double e) { return 0.75 * (1.0 - e); }
};

}  // namespace impactrig::models
