// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>

#include "models/contact/elastic/contact_numbers.hpp"
#include "models/contact/elastic/elastic_law_entry.hpp"
#include "models/contact/elastic/logarithmic_contact.hpp"

namespace impactrig::models {

/// Line contact of ESDU item 78035.
///
///   δ = A f (1 + ln(f* / f)),   A = σ / L,   f* = 4 L ΔR / σ
///
/// δ [m], f [N, compression > 0]. It differs from Johnson's law by 2 A f. A plane has no ΔR: there
/// the approach depends on the depth, which this law does not know.
///
/// Valid for f < 0.9 f* and a half width below 0.15 R_1.
///
/// Source: [ESDU78035], as in [PereiraEtAl2011].
struct Esdu78035Law {
  static constexpr ElasticLawText text{
      .name = "esdu-78035",
      .description = "line contact, logarithmic, between two cylinders or in a groove",
      .formula = "d = A f (1 + ln(f*/f)), A = sigma/L, f* = 4 L dR/sigma",
      .validity = "f < 0.9 f*, half width < 0.15 R1; no plane",
      .source = "ESDU78035, as in PereiraEtAl2011"};

  template <typename T>
  static LogarithmicContact<T> make(const ContactNumbers<T>& c) {
    require_second_radius(text.name, c.counterface);
    const T sigma = c.sigma();
    return {sigma / c.length, 4.0 * c.length * c.radii() / sigma};
  }
};

}  // namespace impactrig::models
