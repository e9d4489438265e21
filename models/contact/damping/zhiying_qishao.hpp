// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "models/contact/damping/damping_law_entry.hpp"

namespace impactrig::models {

/// f = f_0(δ) (1 + d δ̇ / v),   d = 3 (1 − e²) exp(2 (1 − e)) / 4
///
/// A free rigid impact rebounds within 0.025 of e for e >= 0.4, with 0.217 for 0.1.
///
/// Source: [ZhiyingQishao2006], as listed by [MachadoEtAl2012].
struct ZhiyingQishao {
  static constexpr DampingLawText text{
      .name = "zhiying-qishao",
      .description = "Lankarani and Nikravesh's, raised for small e",
      .formula = "d = 3 (1-e^2) exp(2(1-e)) / 4",
      .validity = "e > 0.4: within 0.025; rebounds with 0.217 for 0.1",
      .source = "ZhiyingQishao2006"};

  static double factor(double e) { return 0.75 * (1.0 - e * e) * std::exp(2.0 * (1.0 - e)); }
};

}  // namespace impactrig::models
