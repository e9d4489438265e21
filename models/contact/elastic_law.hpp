// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "models/contact/elastic/elastic_law_entry.hpp"
#include "models/contact/elastic/elastic_state.hpp"
#include "models/contact/elastic/liu.hpp"
#include "models/contact/elastic/logarithmic_contact.hpp"
#include "models/contact/elastic/persson.hpp"
#include "models/contact/elastic/power_contact.hpp"
#include "models/rig.hpp"

namespace impactrig::models {

/// What every elastic law comes down to: force, energy, stiffness, curvature and both inverses of a
/// penetration [m, N, J].
using ElasticLaw =
    std::variant<LogarithmicContact<>, PowerContact<>, LiuContact<>, PerssonContact<>>;

/// How force and energy at a penetration change with a key of the contact.
struct LawDerivative {
  std::string_view key;      ///< "contact.length"
  std::string_view unit;     ///< of the key
  double value = 0.0;        ///< of the key
  double force = 0.0;        ///< ∂f/∂key [N a unit]
  double energy = 0.0;       ///< ∂U/∂key [J a unit]
  double penetration = 0.0;  ///< ∂δ/∂key, force held [m a unit]
};

/// A law of the table.
struct ElasticLawEntry {
  ElasticLawText text;
  ElasticLaw (*make)(const Contact& contact);  ///< stiffness_factor not applied
  std::vector<LawDerivative> (*derivatives)(const Contact& contact, double penetration);
  /// Adds a sentence for each limit of its own that a contact is beyond at a force [N] and depth
  /// [m].
  void (*limits)(const Contact& contact, double force, double penetration,
                 std::vector<std::string>& beyond);
};

/// A new law is one header, one line of this table, one test and one entry in docs/laws.md.
std::span<const ElasticLawEntry> elastic_laws();

/// Throws std::invalid_argument on an unknown name (and lists the known ones).
const ElasticLawEntry& elastic_law_entry(std::string_view name);

/// The law a contact asks for, its stiffness factor applied. Throws std::invalid_argument on an
/// unknown name and on a contact that the law has no formula for.
ElasticLaw elastic_law(const Contact& contact);

/// By every key the contact's law is made of and by its stiffness factor, exact to rounding: the
/// formulas are differentiated, nothing is stepped. Penetration [m], > 0.
std::vector<LawDerivative> elastic_derivatives(const Contact& contact, double penetration);

/// Sentences that name each limit of the elastic law a contact is beyond at a penetration [m], with
/// the number: half width against radius, load against the range where the law rises, what the law
/// was fitted to.
std::vector<std::string> elastic_limits(const Contact& contact, double penetration);

/// A sentence on what the unit of length changes, where Goldsmith's exponent 1 leaves that open and
/// the contact does not state it, with the numbers at a penetration [m]; else empty.
std::string unit_dependence(const Contact& contact, double penetration);

/// Hertz's half width a = √(4 f R_eq / (π E* L)) [m]; 0 where the contact states no radii or
/// moduli.
double half_width(const Contact& contact, double force);

/// ΔR / (R_1 R_2) [1/m], > 0: the relative curvature of bar and counterface.
double relative_curvature(const Contact& contact);

/// Calls on the law itself.
inline double elastic_force(const ElasticLaw& law, double penetration) {
  return std::visit([&](const auto& own) { return own.force(penetration); }, law);
}

inline double stored_energy(const ElasticLaw& law, double penetration) {
  return std::visit([&](const auto& own) { return own.energy(penetration); }, law);
}

inline ForceAndStiffness<> force_and_stiffness(const ElasticLaw& law, double penetration) {
  return std::visit([&](const auto& own) { return own.force_and_stiffness(penetration); }, law);
}

inline double limit_penetration(const ElasticLaw& law) {
  return std::visit([](const auto& own) { return own.limit_penetration(); }, law);
}

inline double penetration_at(const ElasticLaw& law, double force) {
  return std::visit([&](const auto& own) { return own.penetration(force); }, law);
}

inline double penetration_storing(const ElasticLaw& law, double energy) {
  return std::visit([&](const auto& own) { return own.penetration_storing(energy); }, law);
}

ElasticState elastic_state(const ElasticLaw& law, double penetration);

}  // namespace impactrig::models
