// SPDX-License-Identifier: BSD-3-Clause
#include "models/contact/elastic_law.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <unsupported/Eigen/AutoDiff>

#include "models/contact/elastic/brandlein.hpp"
#include "models/contact/elastic/dubowsky_freudenstein.hpp"
#include "models/contact/elastic/esdu_78035.hpp"
#include "models/contact/elastic/goldsmith.hpp"
#include "models/contact/elastic/hertz_point.hpp"
#include "models/contact/elastic/johnson.hpp"
#include "models/contact/elastic/lankarani_nikravesh_cylinder.hpp"
#include "models/contact/elastic/linear.hpp"
#include "models/contact/elastic/palmgren.hpp"
#include "models/contact/elastic/pereira.hpp"
#include "models/contact/elastic/radzimovsky.hpp"

namespace impactrig::models {
namespace {

ContactNumbers<> numbers_of(const Contact& contact) {
  return {.counterface = contact.counterface,
          .exponent = contact.exponent,
          .radius = contact.radius,
          .counter_radius = contact.counter_radius,
          .counter_depth = contact.counter_depth,
          .length = contact.length,
          .modulus = contact.modulus,
          .poisson_ratio = contact.poisson_ratio,
          .counter_modulus = contact.counter_modulus,
          .counter_poisson_ratio = contact.counter_poisson_ratio,
          .reference_length = contact.reference_length.value_or(1.0),
          .stiffness = contact.stiffness,
          .power = contact.power};
}

/// The keys by which laws are differentiated, in the order of the derivatives.
struct Key {
  std::string_view name, unit;
  bool LawNeeds::*need;
  double ContactNumbers<>::*value;
};

constexpr std::array keys = {
    Key{"contact.radius", "m", &LawNeeds::radii, &ContactNumbers<>::radius},
    Key{"contact.counterface.radius", "m", &LawNeeds::radii, &ContactNumbers<>::counter_radius},
    Key{"contact.counterface.depth", "m", &LawNeeds::radii, &ContactNumbers<>::counter_depth},
    Key{"contact.length", "m", &LawNeeds::length, &ContactNumbers<>::length},
    Key{"contact.modulus", "Pa", &LawNeeds::moduli, &ContactNumbers<>::modulus},
    Key{"contact.poisson_ratio", "1", &LawNeeds::moduli, &ContactNumbers<>::poisson_ratio},
    Key{"contact.counter_modulus", "Pa", &LawNeeds::moduli, &ContactNumbers<>::counter_modulus},
    Key{"contact.counter_poisson_ratio", "1", &LawNeeds::moduli,
        &ContactNumbers<>::counter_poisson_ratio},
    Key{"contact.reference_length", "m", &LawNeeds::length, &ContactNumbers<>::reference_length},
    Key{"contact.stiffness", "N/m^n", &LawNeeds::stiffness, &ContactNumbers<>::stiffness},
    Key{"contact.power", "1", &LawNeeds::power, &ContactNumbers<>::power},
};

using Slopes = Eigen::Matrix<double, static_cast<int>(keys.size()) + 1, 1>;
using Dual = Eigen::AutoDiffScalar<Slopes>;

ContactNumbers<Dual> with_derivatives(const ContactNumbers<>& n) {
  constexpr int count = static_cast<int>(keys.size()) + 1;
  int next = 0;
  const auto seed = [&](double value) { return Dual(value, count, next++); };
  ContactNumbers<Dual> d;
  d.counterface = n.counterface;
  d.exponent = n.exponent;
  for (const auto& [to, value] :
       {std::pair{&ContactNumbers<Dual>::radius, n.radius},
        {&ContactNumbers<Dual>::counter_radius, n.counter_radius},
        {&ContactNumbers<Dual>::counter_depth, n.counter_depth},
        {&ContactNumbers<Dual>::length, n.length},
        {&ContactNumbers<Dual>::modulus, n.modulus},
        {&ContactNumbers<Dual>::poisson_ratio, n.poisson_ratio},
        {&ContactNumbers<Dual>::counter_modulus, n.counter_modulus},
        {&ContactNumbers<Dual>::counter_poisson_ratio, n.counter_poisson_ratio},
        {&ContactNumbers<Dual>::reference_length, n.reference_length},
        {&ContactNumbers<Dual>::stiffness, n.stiffness},
        {&ContactNumbers<Dual>::power, n.power}})
    d.*to = seed(value);
  return d;
}

template <typename Law>
std::vector<LawDerivative> derivatives_of(const Contact& contact, double penetration) {
  const ContactNumbers<> numbers = numbers_of(contact);
  const int last = static_cast<int>(keys.size());
  const Dual factor(contact.stiffness_factor, last + 1, last);
  const auto law = Law::make(with_derivatives(numbers)).scaled(factor);
  const ForceAndStiffness<Dual> there = law.force_and_stiffness(Dual(penetration));
  const Dual energy = law.energy(Dual(penetration));
  std::vector<LawDerivative> result;
  const auto add = [&](std::string_view key, std::string_view unit, double value, int i) {
    const double slope = there.force.derivatives()[i];
    result.push_back(
        {key, unit, value, slope, energy.derivatives()[i], -slope / there.stiffness.value()});
  };
  for (int i = 0; i < last; ++i) {
    const Key& key = keys[static_cast<std::size_t>(i)];
    // a contact states what its law and counterface need, and no more
    if (Law::text.needs.*key.need && there.force.derivatives()[i] != 0.0)
      add(key.name, !Law::text.needs.power && key.need == &LawNeeds::stiffness ? "N/m" : key.unit,
          numbers.*key.value, i);
  }
  add("contact.stiffness_factor", "1", contact.stiffness_factor, last);
  return result;
}

template <typename Law>
constexpr ElasticLawEntry entry() {
  return {
      .text = Law::text,
      .make = [](const Contact& contact) -> ElasticLaw { return Law::make(numbers_of(contact)); },
      .derivatives = derivatives_of<Law>,
      .limits =
          [](const Contact& contact, double force, double penetration,
             std::vector<std::string>& beyond) {
            if constexpr (requires { Law::limits; })
              Law::limits(numbers_of(contact), force, penetration, beyond);
          }};
}

constexpr std::array laws = {
    entry<GoldsmithLaw>(),                   //
    entry<DubowskyFreudensteinLaw>(),        //
    entry<Esdu78035Law>(),                   //
    entry<JohnsonLaw>(),                     //
    entry<RadzimovskyLaw>(),                 //
    entry<RadzimovskyHandbookLaw>(),         //
    entry<RadzimovskyHalfWidthLaw>(),        //
    entry<LiuLaw>(),                         //
    entry<PalmgrenLaw>(),                    //
    entry<BrandleinLaw>(),                   //
    entry<PereiraLaw>(),                     //
    entry<PerssonLaw>(),                     //
    entry<LankaraniNikraveshCylinderLaw>(),  //
    entry<HertzPointLaw>(),                  //
    entry<LinearLaw>(),                      //
};

// Above these a law is told to be beyond its limits.
constexpr double widest = 0.15;       // half width, or radius of a point's contact, of R_1
constexpr double largest_part = 0.5;  // of f*

}  // namespace

std::span<const ElasticLawEntry> elastic_laws() {
  return laws;
}

const ElasticLawEntry& elastic_law_entry(std::string_view name) {
  std::string known;
  for (const ElasticLawEntry& entry : laws) {
    if (entry.text.name == name) return entry;
    known += fmt::format("{}{}", known.empty() ? "" : ", ", entry.text.name);
  }
  throw std::invalid_argument(
      fmt::format("contact.law: there is no elastic law '{}'; known are {}", name, known));
}

ElasticLaw elastic_law(const Contact& contact) {
  return std::visit(
      [&](const auto& law) -> ElasticLaw { return law.scaled(contact.stiffness_factor); },
      elastic_law_entry(contact.law).make(contact));
}

std::vector<LawDerivative> elastic_derivatives(const Contact& contact, double penetration) {
  return elastic_law_entry(contact.law).derivatives(contact, penetration);
}

double half_width(const Contact& contact, double force) {
  const LawNeeds& needs = elastic_law_entry(contact.law).text.needs;
  if (!needs.radii || !needs.moduli || !needs.length) return 0.0;
  const ContactNumbers<> c = numbers_of(contact);
  return std::sqrt(4.0 * force * c.sigma() / (c.length * c.curvature()));
}

std::vector<std::string> elastic_limits(const Contact& contact, double penetration) {
  const ElasticLawEntry& entry = elastic_law_entry(contact.law);
  const ElasticLaw law = elastic_law(contact);
  const double force = elastic_force(law, penetration);
  std::vector<std::string> beyond;
  if (const auto* own = std::get_if<LogarithmicContact<>>(&law);
      own && force > largest_part * own->limit_force)
    beyond.push_back(fmt::format(
        "the law '{}' rises up to {:.4g} N and is no good near that; here it is at {:.4g} N",
        contact.law, own->limit_force, force));
  if (const double a = half_width(contact, force); a > widest * contact.radius &&
                                                   contact.law != PerssonLaw::text.name &&
                                                   contact.law != LiuLaw::text.name)
    beyond.push_back(fmt::format(
        "the contact's half width is {:.3g} of the bar's radius at {:.4g} N; the law '{}' is good "
        "up to {:g} of it{}",
        a / contact.radius, force, contact.law, widest,
        contact.counterface == Counterface::groove ? ": take 'persson' or 'liu' for a pin that "
                                                     "fits its groove"
                                                   : ""));
  entry.limits(contact, force, penetration, beyond);
  return beyond;
}

std::string unit_dependence(const Contact& contact, double penetration) {
  if (contact.law != GoldsmithLaw::text.name || contact.exponent != 1 || contact.reference_length)
    return {};
  const double force = elastic_force(elastic_law(contact), penetration);
  Contact consistent = contact;
  consistent.exponent = 3;
  Contact millimetres = contact;
  millimetres.reference_length = 1e-3;
  const auto depth_of = [&](const Contact& other) {
    const ElasticLaw law = elastic_law(other);
    const double most = elastic_force(law, models::limit_penetration(law));
    return force < most ? fmt::format("{:.4g} um", 1e6 * penetration_at(law, force))
                        : fmt::format("no depth at all (beyond its {:.3g} N)", most);
  };
  return fmt::format(
      "goldsmith with exponent 1 has a logarithm that depends on the unit of length. Lengths in "
      "metres, as in the paper: {:.4g} N press {:.4g} um deep; in millimetres {}; the consistent "
      "exponent 3 gives {}. contact.reference_length = \"1 m\" states the choice.",
      force, 1e6 * penetration, depth_of(millimetres), depth_of(consistent));
}

double relative_curvature(const Contact& contact) {
  return numbers_of(contact).curvature();
}

ElasticState elastic_state(const ElasticLaw& law, double penetration) {
  return std::visit(
      [&](const auto& own) -> ElasticState {
        const auto [force, stiffness] = own.force_and_stiffness(penetration);
        return {force, stiffness, own.curvature(penetration), own.energy(penetration)};
      },
      law);
}

}  // namespace impactrig::models
