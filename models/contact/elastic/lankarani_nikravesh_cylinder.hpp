// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/contact/elastic/contact_numbers.hpp"
#include "models/contact/elastic/elastic_law_entry.hpp"
#include "models/contact/elastic/power_contact.hpp"

namespace impactrig::models {

/// A power law of stated factor and exponent, as Lankarani and Nikravesh use it for cylinders; with
/// the exponent 3/2 the general form of Hertz.
///
///   f = K δⁿ,   1 <= n <= 1.5 for cylinders
///
/// δ [m], f [N, compression > 0], K [N/mⁿ]. For n other than 1.5 no formula gives K: both are
/// inputs, n through the unit of `stiffness`.
///
/// Valid as far as K and n were measured.
///
/// Source: [LankaraniNikravesh1994].
struct LankaraniNikraveshCylinderLaw {
  static constexpr ElasticLawText text{
      .name = "lankarani-nikravesh-cylinder",
      .description = "power law of stated factor and exponent",
      .formula = "f = K d^n",
      .validity = "as far as K and n were measured; 1 <= n <= 1.5 for cylinders",
      .source = "LankaraniNikravesh1994",
      .needs = {
          .radii = false, .length = false, .moduli = false, .stiffness = true, .power = true}};

  template <typename T>
  static PowerContact<T> make(const ContactNumbers<T>& c) {
    return {c.stiffness, c.power};
  }
};

}  // namespace impactrig::models
