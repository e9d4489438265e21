// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string_view>
#include <variant>

#include "models/contact/goldsmith.hpp"
#include "models/contact/linear.hpp"
#include "models/rig.hpp"

namespace impactrig::models {

/// Every elastic law there is. A new one is one header, one member here, one line of elastic_laws()
/// and one test.
using ElasticLaw = std::variant<Goldsmith, LinearContact>;

/// One line of `impactrig laws`.
struct ElasticLawEntry {
  std::string_view name;
  std::string_view description;
  std::string_view source;
  ElasticLaw (*make)(const Contact& contact);  ///< stiffness_factor not applied
};

std::span<const ElasticLawEntry> elastic_laws();

/// The law a contact asks for, its stiffness factor applied. Throws std::invalid_argument on an
/// unknown name (and lists the known ones).
ElasticLaw elastic_law(const Contact& contact);

/// ΔR / (R_1 R_2) [1/m], > 0: the relative curvature of bar and counterface.
double relative_curvature(const Contact& contact);

}  // namespace impactrig::models
