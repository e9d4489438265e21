// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/contact/damping/damping_law_entry.hpp"

namespace impactrig::models {

/// f = f_0(δ) (1 + d δ̇ / v),   d = (1 − e²) / e
///
/// Their closed approximation of the exact law: within 0.005 for e < 0.3, within 0.013 for e <=
/// 0.5; 0.876 for 0.9.
///
/// Source: [GonthierEtAl2004].
struct Gonthier {
  static constexpr DampingLawText text{
      .name = "gonthier",
      .description = "closed form near the exact law for small e",
      .formula = "d = (1-e^2) / e",
      .validity = "e < 0.5: within 0.013 there; rebounds with 0.876 for 0.9",
      .source = "GonthierEtAl2004",
      .smallest_restitution = 0.005};

  static double factor(double e) { return (1.0 - e * e) / e; }
};

}  // namespace impactrig::models
