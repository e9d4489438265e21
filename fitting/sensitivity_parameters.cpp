// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/sensitivity_parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace impactrig::fitting {
namespace {

/// Those that a fit frees and those that it does not.
std::vector<PhysicalParameter> known_parameters() {
  const auto fitted = physical_parameters(), stated = stated_parameters();
  std::vector<PhysicalParameter> known(fitted.begin(), fitted.end());
  known.insert(known.end(), stated.begin(), stated.end());
  return known;
}

/// Of what a rig has not, reading makes it; without a stop its contact is none.
bool has(const models::Rig& rig, const PhysicalParameter& parameter) {
  models::Rig copy = rig;
  parameter.of(copy);
  return copy == rig && (rig.has_stop() || !parameter.name.starts_with("contact."));
}

std::string sentence_on_names(const std::string& unknown) {
  std::string known;
  for (const PhysicalParameter& parameter : known_parameters())
    if (!parameter.name.starts_with("contacts.")) known += fmt::format("{}, ", parameter.name);
  return fmt::format(
      "'{}' is no number of a rig to differentiate by; they are {}contacts.1. (2, 3) with "
      "restitution, stiffness_factor, length, stiffness, position, gap, or all",
      unknown, known);
}

}  // namespace

std::vector<PhysicalParameter> sensitivity_parameters(const models::Rig& rig,
                                                      const std::vector<std::string>& names) {
  std::vector<PhysicalParameter> chosen = known_parameters();
  if (names.size() == 1 && names.front() == "all") {
    std::erase_if(chosen, [&](const PhysicalParameter& parameter) {
      models::Rig copy = rig;
      return !has(rig, parameter) || parameter.of(copy) == 0.0;
    });
    return chosen;
  }
  const std::vector<PhysicalParameter> known = std::move(chosen);
  chosen.clear();
  for (const std::string& name : names) {
    const auto found = std::ranges::find(known, name, &PhysicalParameter::name);
    if (found == known.end()) throw std::invalid_argument(sentence_on_names(name));
    if (std::ranges::find(chosen, name, &PhysicalParameter::name) != chosen.end())
      throw std::invalid_argument(fmt::format("'{}' is named twice", name));
    if (!has(rig, *found))
      throw std::invalid_argument(fmt::format("'{}' is nothing that this rig has", name));
    chosen.push_back(*found);
  }
  return chosen;
}

}  // namespace impactrig::fitting
