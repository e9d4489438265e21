// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/contact/elastic/contact_numbers.hpp"
#include "models/contact/elastic/elastic_law_entry.hpp"
#include "models/contact/elastic/logarithmic_contact.hpp"

namespace impactrig::models {

/// Dubowsky and Freudenstein's line contact: Goldsmith's with the exponent 3, sound in its units.
///
///   δ = A f (1 + ln(f* / f)),   A = σ / L,   f* = L³ ΔR / (R_1 R_2 σ)
///
/// δ [m], f [N, compression > 0]; ΔR / R_2 = 1 against a plane. In structure the contact of a line
/// of finite length of Lundberg (1939).
///
/// Valid for f < 0.9 f* and a half width below 0.15 R_1.
///
/// Source: [DubowskyFreudenstein1971].
struct DubowskyFreudensteinLaw {
  static constexpr ElasticLawText text{
      .name = "dubowsky-freudenstein",
      .description = "line contact, logarithmic, of finite length; consistent in its units",
      .formula = "d = A f (1 + ln(f*/f)), A = sigma/L, f* = L^3 dR/(R1 R2 sigma)",
      .validity = "f < 0.9 f*, half width < 0.15 R1",
      .source = "DubowskyFreudenstein1971"};

  template <typename T>
  static LogarithmicContact<T> make(const ContactNumbers<T>& c) {
    const T sigma = c.sigma();
    return {sigma / c.length, c.length * c.length * c.length * c.curvature() / sigma};
  }
};

}  // namespace impactrig::models
