// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

#include "models/contact/elastic/contact_numbers.hpp"
#include "models/contact/elastic/elastic_law_entry.hpp"
#include "models/contact/elastic/power_contact.hpp"

namespace impactrig::models {

/// Hertz's contact of spheres, with the cylinders' equivalent radius.
///
///   f = K δ^(3/2),   K = 4/3 E* √R_eq
///
/// δ [m], f [N, compression > 0]. Often used "for cylinders"; a line contact is stiffer and nearly
/// linear. For comparison, and for bars that strike with a sphere: radius of a sphere against a
/// plane, or equivalent radii.
///
/// Valid for points: a contact radius √(R_eq δ) below 0.15 R_1.
///
/// Source: [Hertz1882], [Johnson1985] (4.23).
struct HertzPointLaw {
  static constexpr ElasticLawText text{
      .name = "hertz-point",
      .description = "spheres, power 3/2, with the equivalent radius; wrong for lines",
      .formula = "f = 4/3 E* sqrt(Req) d^(3/2)",
      .validity = "points, not lines; contact radius sqrt(Req d) < 0.15 R1",
      .source = "Hertz1882, Johnson1985 (4.23)",
      .needs = {.length = false}};

  template <typename T>
  static PowerContact<T> make(const ContactNumbers<T>& c) {
    using std::sqrt;
    return {4.0 / 3.0 * c.effective_modulus() / T(sqrt(c.curvature())), T(1.5)};
  }

  static void limits(const ContactNumbers<>& c, double force, double penetration,
                     std::vector<std::string>& beyond) {
    const double radius = std::sqrt(penetration / c.curvature());
    if (radius > 0.15 * c.radius)
      beyond.push_back(
          fmt::format("the contact's radius is {:.3g} of the bar's at {:.4g} N; the law "
                      "'hertz-point' is good up "
                      "to 0.15 of it",
                      radius / c.radius, force));
  }
};

}  // namespace impactrig::models
