// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/contact/damping/damping_law_entry.hpp"

namespace impactrig::models {

/// f = f_0(δ) (1 + d δ̇ / v),   d = (3/2) (1 − e) (11 − e) / (1 + 9 e)
///
/// A free rigid impact rebounds within 0.0002 of e for e >= 0.5, within 0.004 for e >= 0.3, with
/// 0.129 for 0.1.
///
/// Source: [CarvalhoMartins2019].
struct CarvalhoMartins {
  static constexpr DampingLawText text{
      .name = "carvalho-martins",
      .description = "rational approximation of the exact law",
      .formula = "d = 3/2 (1-e)(11-e) / (1+9e)",
      .validity = "within 0.0002 of e for e >= 0.5, 0.004 for e >= 0.3",
      .source = "CarvalhoMartins2019"};

  static double factor(double e) { return 1.5 * (1.0 - e) * (11.0 - e) / (1.0 + 9.0 * e); }
};

}  // namespace impactrig::models
