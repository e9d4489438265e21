// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace impactrig::models {

/// Which keys of a contact an elastic law is made of.
struct LawNeeds {
  bool radii = true;       ///< `radius` and `counterface`
  bool length = true;      ///< `length`
  bool moduli = true;      ///< moduli and Poisson ratios of both sides
  bool stiffness = false;  ///< `stiffness`
  bool power = false;      ///< the power of the penetration in the unit of `stiffness`
};

/// What a law says of itself.
struct ElasticLawText {
  std::string_view name;
  std::string_view description;
  std::string_view formula;   ///< d penetration, f force, L length, E* = 1/(pi sigma)
  std::string_view validity;  ///< with numbers
  std::string_view source;    ///< a key of docs/references.bib, with the equation where known
  LawNeeds needs = {};
};

}  // namespace impactrig::models
