// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "models/contact/elastic/contact_numbers.hpp"
#include "models/contact/elastic/elastic_law_entry.hpp"
#include "models/contact/elastic/power_contact.hpp"

namespace impactrig::models {

/// The bearing handbooks' line contact of steel on steel.
///
///   f = K δ^(10/9),   K = 8.06e4 L^(8/9) N/mm^(10/9), L in mm
///
/// δ [m], f [N, compression > 0]: Palmgren's relation inverted for steel, E* = 113.2 GPa. Some
/// handbooks print 7.86e4.
///
/// Valid for steel on steel in rolling bearings' proportions, a half width below 0.15 R_1.
///
/// Source: [BrandleinEtAl1999], attribution not confirmed.
struct BrandleinLaw {
  static constexpr ElasticLawText text{
      .name = "brandlein",
      .description = "roller and race of steel, power 10/9",
      .formula = "f = 8.06e4 L^(8/9) d^(10/9), in N and mm",
      .validity = "steel on steel (E* near 113 GPa), half width < 0.15 R1",
      .source = "BrandleinEtAl1999"};

  template <typename T>
  static PowerContact<T> make(const ContactNumbers<T>& c) {
    using std::pow;
    constexpr double to_metres = 1e6;  // 1000^(8/9 + 10/9)
    return {8.06e4 * to_metres * T(pow(c.length, 8.0 / 9.0)), T(10.0 / 9.0)};
  }

  static void limits(const ContactNumbers<>& c, double, double, std::vector<std::string>& beyond) {
    constexpr double steel = 113.2e9;  // [Pa]
    if (std::abs(c.effective_modulus() / steel - 1.0) > 0.1)
      beyond.push_back(fmt::format(
          "the law 'brandlein' is for steel on steel, E* = 113 GPa; here it is {:.4g} GPa: take "
          "'palmgren', the same relation for any materials",
          1e-9 * c.effective_modulus()));
  }
};

}  // namespace impactrig::models
