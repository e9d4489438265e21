// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/contact/damping/damping_law_entry.hpp"

namespace impactrig::models {

/// f = f_0(δ) (1 + d δ̇ / v),   d = 3 (1 − e²) / 4
///
/// Credited to Hunt and Crossley by Shen et al. A free rigid impact rebounds with 0.913 for e =
/// 0.9, with 0.725 for 0.5.
///
/// Source: [LankaraniNikravesh1990], [ShenEtAl2007] (33).
struct LankaraniNikravesh {
  static constexpr DampingLawText text{
      .name = "lankarani-nikravesh",
      .description = "the paper's; rebounds faster than e (0.725 for e = 0.5)",
      .formula = "d = 3 (1-e^2) / 4",
      .validity = "e > 0.9: rebounds with 0.913 for 0.9, 0.725 for 0.5",
      .source = "LankaraniNikravesh1990, ShenEtAl2007 (33)"};

  static double factor(double e) { return 0.75 * (1.0 - e * e); }
};

}  // namespace impactrig::models
