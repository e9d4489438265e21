// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/contact/damping/damping_law_entry.hpp"

namespace impactrig::models {

/// d of the exact-restitution law: the root of d (1 + e) = ln((1 + d) / (1 − e d)) in (0, 1/e), for
/// e in (0, 1]. Relative error below 1e-11; the quotient of two differences loses digits as e -> 1,
/// where a series takes over.
double exact_damping_factor(double restitution);

/// The e with which a free rigid impact rebounds at a damping factor d >= 0: the inverse of
/// exact_damping_factor().
double free_rebound_ratio(double factor);

/// f = f_0(δ) (1 + d δ̇ / v),   d (1 + e) = ln((1 + d) / (1 − e d))
///
/// The first integral of the impact, m ∫ v dv / (1 + μ v) = −∫ f_0 dδ = 0 over the whole contact,
/// holds whatever f_0 is. e d < 1: a free impact never pulls.
///
/// Source: [GonthierEtAl2004] and [CarvalhoMartins2019] for power laws; for any f_0 by that
/// integral.
struct ExactRestitution {
  static constexpr DampingLawText text{
      .name = "exact",
      .description = "a free rigid impact rebounds with e itself, for every elastic law",
      .formula = "d (1+e) = ln((1+d) / (1-e d))",
      .validity = "every e >= 0.005, elastic law, mass and speed",
      .source = "GonthierEtAl2004, CarvalhoMartins2019; any f0 by one integral",
      .smallest_restitution = 0.005};

  static double factor(double e) { return exact_damping_factor(e); }
};

}  // namespace impactrig::models
