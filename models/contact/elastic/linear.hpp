// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/contact/elastic/contact_numbers.hpp"
#include "models/contact/elastic/elastic_law_entry.hpp"
#include "models/contact/elastic/power_contact.hpp"

namespace impactrig::models {

/// A linear spring, f = K δ for δ > 0; δ [m], f [N], K [N/m].
///
/// Valid as far as the user says; the reference every other law is compared with.
struct LinearLaw {
  static constexpr ElasticLawText text{
      .name = "linear",
      .description = "linear spring of stated stiffness",
      .formula = "f = K d",
      .validity = "as far as the user says",
      .source = "Hooke1678",
      .needs = {.radii = false, .length = false, .moduli = false, .stiffness = true}};

  template <typename T>
  static PowerContact<T> make(const ContactNumbers<T>& c) {
    return {c.stiffness, T(1.0)};
  }
};

}  // namespace impactrig::models
