// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "models/contact/elastic/contact_numbers.hpp"
#include "models/contact/elastic/elastic_law_entry.hpp"
#include "models/contact/elastic/power_contact.hpp"

namespace impactrig::models {

/// Palmgren's approach of a roller and its race.
///
///   δ = 0.39 (4 / E*)^0.9 f^0.9 / L^0.8
///
/// inverted: f = K δ^(10/9) with K = L^(8/9) E* / (4 · 0.39^(10/9)); δ [m], f [N, compression > 0].
/// The radii do not enter. Homogeneous in its dimensions. A logarithmic law has this local exponent
/// where ln(f* / f) = 9.
///
/// Valid for rolling bearings' proportions, a half width below 0.15 R_1.
///
/// Source: [Palmgren1959].
struct PalmgrenLaw {
  static constexpr ElasticLawText text{
      .name = "palmgren",
      .description = "roller and race, power 10/9, of any materials",
      .formula = "d = 0.39 (4/E*)^0.9 f^0.9 / L^0.8",
      .validity = "proportions of rolling bearings, half width < 0.15 R1",
      .source = "Palmgren1959"};

  template <typename T>
  static PowerContact<T> make(const ContactNumbers<T>& c) {
    using std::pow;
    const double constant = 0.25 * std::pow(0.39, -10.0 / 9.0);
    return {constant * c.effective_modulus() * T(pow(c.length, 8.0 / 9.0)), T(10.0 / 9.0)};
  }
};

}  // namespace impactrig::models
