// SPDX-License-Identifier: BSD-3-Clause
#include "models/contact/elastic_law.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace impactrig::models {
namespace {

ElasticLaw make_goldsmith(const Contact& contact) {
  const auto plane_compliance = [](double modulus, double poisson_ratio) {
    return (1.0 - poisson_ratio * poisson_ratio) / (std::numbers::pi * modulus);
  };
  const double sigma = plane_compliance(contact.modulus, contact.poisson_ratio) +
                       plane_compliance(contact.counter_modulus, contact.counter_poisson_ratio);
  return Goldsmith{.compliance = sigma / contact.length,
                   .limit_force = std::pow(contact.length, contact.exponent) *
                                  relative_curvature(contact) / sigma};
}

ElasticLaw make_linear(const Contact& contact) {
  return LinearContact{contact.stiffness};
}

constexpr std::array laws = {
    ElasticLawEntry{Goldsmith::name,
                    "line contact, logarithmic; exponent 1 (the paper) or 3 (consistent in units)",
                    "Goldsmith 1960; Shen et al. (31); Dubowsky and Freudenstein 1971",
                    make_goldsmith},
    ElasticLawEntry{LinearContact::name, "linear spring of stated stiffness", "Hooke", make_linear},
};

}  // namespace

std::span<const ElasticLawEntry> elastic_laws() {
  return laws;
}

ElasticLaw elastic_law(const Contact& contact) {
  std::string known;
  for (const ElasticLawEntry& entry : laws) {
    known += fmt::format("{}{}", known.empty() ? "" : ", ", entry.name);
    if (entry.name != contact.law) continue;
    return std::visit(
        [&](const auto& law) -> ElasticLaw { return law.scaled(contact.stiffness_factor); },
        entry.make(contact));
  }
  throw std::invalid_argument(
      fmt::format("contact.law: there is no elastic law '{}'; known are {}", contact.law, known));
}

double relative_curvature(const Contact& contact) {
  switch (contact.counterface) {
    case Counterface::groove:
      return 1.0 / contact.radius - 1.0 / contact.counter_radius;
    case Counterface::cylinder:
      return 1.0 / contact.radius + 1.0 / contact.counter_radius;
    case Counterface::plane:
      return 1.0 / contact.radius;
  }
  throw std::logic_error("relative_curvature: counterface out of range");
}

}  // namespace impactrig::models
