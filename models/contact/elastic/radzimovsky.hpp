// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "models/contact/elastic/contact_numbers.hpp"
#include "models/contact/elastic/elastic_law_entry.hpp"
#include "models/contact/elastic/logarithmic_contact.hpp"

namespace impactrig::models {

/// Radzimovsky's approach of two cylinders, as handbooks print it.
///
///   δ = A f [2/3 + ln(4 R_1 / b) + ln(4 R_2 / b)],   b the width of the contact
///
/// which is δ = A f (1 + ln(f* / f)) with A = σ / L and f* = B e^(−1/3); δ [m], f [N, compression >
/// 0]. Three readings of b are in use:
///
/// - radzimovsky: Hertz's full width b = 4 √(q R_eq / (π E*)), q = f / L: B = π E* L ΔR;
/// - radzimovsky-1.60: b = 1.60 √(q R_eq / E*), a constant made for diameters: B = 16 E* L ΔR /
///   1.6², δ larger by 0.69 A f;
/// - radzimovsky-half-width: half that width: B = 4 π E* L ΔR, δ larger by 1.39 A f.
///
/// Valid for f < 0.9 f* and a half width below 0.15 R_1; a plane has no ΔR.
///
/// Source: [Radzimovsky1953] through handbooks.
struct RadzimovskyLaw {
  static constexpr ElasticLawText text{
      .name = "radzimovsky",
      .description = "line contact, logarithmic; handbooks' form with Hertz's full width",
      .formula = "d = A f (1 + ln(f*/f)), A = sigma/L, f* = pi E* L dR e^(-1/3)",
      .validity = "f < 0.9 f*, half width < 0.15 R1; no plane",
      .source = "Radzimovsky1953, through handbooks"};

  template <typename T>
  static LogarithmicContact<T> make(const ContactNumbers<T>& c) {
    return of_width(text.name, c, std::numbers::pi);
  }

  /// B = `width` E* L ΔR.
  template <typename T>
  static LogarithmicContact<T> of_width(std::string_view name, const ContactNumbers<T>& c,
                                        double width) {
    require_second_radius(name, c.counterface);
    return {c.sigma() / c.length,
            width * std::exp(-1.0 / 3.0) * c.effective_modulus() * c.length * c.radii()};
  }
};

struct RadzimovskyHandbookLaw {
  static constexpr ElasticLawText text{
      .name = "radzimovsky-1.60",
      .description = "the same with the width 1.60 sqrt(q Req/E*), as multibody overviews print it",
      .formula = "d = A f (1 + ln(f*/f)), A = sigma/L, f* = 6.25 E* L dR e^(-1/3)",
      .validity = "f < 0.9 f*, half width < 0.15 R1; no plane; 1.60 belongs to diameters",
      .source = "Radzimovsky1953, through overviews"};

  template <typename T>
  static LogarithmicContact<T> make(const ContactNumbers<T>& c) {
    return RadzimovskyLaw::of_width(text.name, c, 16.0 / (1.6 * 1.6));
  }
};

struct RadzimovskyHalfWidthLaw {
  static constexpr ElasticLawText text{
      .name = "radzimovsky-half-width",
      .description = "the same with half Hertz's width, as some codes have it",
      .formula = "d = A f (1 + ln(f*/f)), A = sigma/L, f* = 4 pi E* L dR e^(-1/3)",
      .validity =
          "f < 0.9 f*, half width < 0.15 R1; no plane; the constant 2/3 belongs to the full width",
      .source = "Radzimovsky1953, through public codes"};

  template <typename T>
  static LogarithmicContact<T> make(const ContactNumbers<T>& c) {
    return RadzimovskyLaw::of_width(text.name, c, 4.0 * std::numbers::pi);
  }
};

}  // namespace impactrig::models
