// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "models/contact/elastic/contact_numbers.hpp"
#include "models/contact/elastic/elastic_law_entry.hpp"
#include "models/contact/elastic/logarithmic_contact.hpp"

namespace impactrig::models {

/// Goldsmith's line contact in the form of the starting paper.
///
///   δ = A f (1 + ln(f* / f)),   A = σ / L,   f* = Lᵐ ℓ^(3−m) ΔR / (R_1 R_2 σ)
///
/// δ is the penetration [m], f the force [N, compression > 0], L the contact length, ΔR = R_2 − R_1
/// in a groove, R_1 + R_2 against a cylinder, ΔR / R_2 = 1 against a plane. m = 1 is Shen et al.
/// (31): printed without ℓ its logarithm has a dimension, and its value is that of the unit in
/// which lengths are written. ℓ is that unit, 1 m unless `reference_length` states another. m = 3
/// needs none.
///
/// Valid for f < 0.9 f* and a half width below 0.15 R_1.
///
/// Source: [Goldsmith1960] as given in [ShenEtAl2007] (31); the page of 1960 not seen.
struct GoldsmithLaw {
  static constexpr ElasticLawText text{
      .name = "goldsmith",
      .description = "line contact, logarithmic; exponent m = 1 (the paper) or 3 (consistent)",
      .formula = "d = A f (1 + ln(f*/f)), A = sigma/L, f* = L^m l^(3-m) dR/(R1 R2 sigma)",
      .validity = "f < 0.9 f*, half width < 0.15 R1; m = 1 depends on the unit of length l",
      .source = "Goldsmith1960, as in ShenEtAl2007 (31)"};

  template <typename T>
  static LogarithmicContact<T> make(const ContactNumbers<T>& c) {
    const T sigma = c.sigma();
    const T area =
        c.exponent == 3 ? T(c.length * c.length) : T(c.reference_length * c.reference_length);
    return {sigma / c.length, c.length * area * c.curvature() / sigma};
  }
};

}  // namespace impactrig::models
