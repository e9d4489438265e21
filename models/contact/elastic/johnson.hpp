// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <stdexcept>

#include "models/contact/elastic/contact_numbers.hpp"
#include "models/contact/elastic/elastic_law_entry.hpp"
#include "models/contact/elastic/logarithmic_contact.hpp"

namespace impactrig::models {

/// Johnson's approach of two cylinders, or of a cylinder and a plane of finite depth.
///
///   δ = A f (1 + ln(f* / f)),   A = σ / L,   f* = 4 L ΔR / (σ e²)
///
/// δ [m], f [N, compression > 0]; the same as f / (π E* L) [ln(4 R_1 / a) + ln(4 R_2 / a) − 1] with
/// Hertz's half width a. A half-space gives way without bound, so that a plane needs the depth D
/// down to what holds it, `counterface.depth`:
///
///   δ = (f / L) {σ_1 [2 ln(4 R_1 / a) − 1] + σ_2 [2 ln(2 D / a) − ν_2 / (1 − ν_2)]}
///
/// Valid for f < 0.9 f*, a half width below 0.15 R_1 and far below D.
///
/// Source: [Johnson1985] (5.56) to (5.58).
struct JohnsonLaw {
  static constexpr ElasticLawText text{
      .name = "johnson",
      .description = "line contact, logarithmic, from Hertz's pressure; a plane with its depth",
      .formula = "d = A f (1 + ln(f*/f)), A = sigma/L, f* = 4 L dR/(sigma e^2)",
      .validity = "f < 0.9 f*, half width < 0.15 R1 and far below a plane's depth",
      .source = "Johnson1985 (5.56)-(5.58)"};

  template <typename T>
  static LogarithmicContact<T> make(const ContactNumbers<T>& c) {
    using std::exp;
    using std::log;
    const T sigma = c.sigma();
    const T compliance = sigma / c.length;
    if (c.counterface != Counterface::plane)
      return {compliance, 4.0 * std::exp(-2.0) * c.length * c.radii() / sigma};
    if (!(c.counter_depth > 0.0))
      throw std::invalid_argument(
          "contact.counterface.depth: is missing; the law 'johnson' needs the depth of a plane, "
          "down to what holds it, for example { shape = \"plane\", depth = \"30 mm\" }");
    const T own = c.bar_compliance() / sigma;
    const T other = c.counter_compliance() / sigma;
    const T nu = c.counter_poisson_ratio;
    // 2 ln(1/a) = ln(f_a / f), f_a = L / (4 R_1 σ) [N/m²]
    const T inverse_square = c.length / (4.0 * sigma * c.radius);
    const T bracket = own * (2.0 * log(4.0 * c.radius) - 1.0) +
                      other * (2.0 * log(2.0 * c.counter_depth) - nu / (1.0 - nu));
    return {compliance, exp(bracket - 1.0) * inverse_square};
  }
};

}  // namespace impactrig::models
