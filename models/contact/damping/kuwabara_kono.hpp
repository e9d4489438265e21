// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/contact/damping/damping_law_entry.hpp"

namespace impactrig::models {

/// f = f_0 + τ f_0'(δ) δ̇
///
/// A Kelvin-Voigt solid of retardation time τ [s]; beside Hertz's spring K (δ^(3/2) + (3/2) A √δ δ̇)
/// with τ = A. Its restitution falls with the speed, about 1 − 1.1534 β, β = (3/2) A (K/m)^(2/5)
/// v^(1/5). `relaxation_time` states τ; without it τ is found so that a free rigid impact of the
/// effective mass rebounds with e at the speed of the first contact, or at `restitution_speed`.
///
/// Source: [KuwabaraKono1987], [BrilliantovEtAl1996].
struct KuwabaraKono {
  static constexpr DampingLawText text{
      .name = "kuwabara-kono",
      .description = "viscoelastic solid; restitution falls with the speed",
      .formula = "f = f0 + tau f0' d'",
      .validity = "e near 1; tau from e at the first speed unless stated",
      .source = "KuwabaraKono1987, BrilliantovEtAl1996",
      .form = DampingForm::relaxing,
      .speed = DampingSpeed::first,
      .smallest_restitution = 0.05};

  static double factor(double e) { return 1.0 - e; }
};

}  // namespace impactrig::models
