// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <limits>

#include "reports/json_parts.hpp"

namespace impactrig::reports {

namespace {

Json limit_json(const std::optional<double>& limit) {
  return limit ? Json(*limit) : Json(nullptr);
}

std::optional<double> limit_from(double value) {
  return std::isnan(value) ? std::nullopt : std::optional(value);
}

Json error_json(double error) {
  return std::isfinite(error) ? Json(error) : Json(nullptr);
}

}  // namespace

Json identifiability_json(const fitting::Identifiability& found) {
  Json combinations = Json::array();
  for (const fitting::Combination& c : found.combinations) {
    Json exponents = Json::object();
    for (const auto& [name, exponent] : c.exponents) exponents[name] = exponent;
    combinations.push_back(
        {{"exponents", exponents}, {"relative_error", error_json(c.relative_error)}});
  }
  return {{"combinations", combinations},
          {"contact_stiffness",
           {{"force_n", found.contact.force},
            {"stiffness_n_m", found.contact.stiffness},
            {"relative_error", error_json(found.contact.relative_error)}}},
          {"remedy", found.remedy}};
}

fitting::Identifiability identifiability_from(const JsonReader& json) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  fitting::Identifiability found;
  const JsonReader combinations = json["combinations"];
  for (std::size_t i = 0; i < combinations.size(); ++i) {
    const JsonReader from = combinations.element(i);
    fitting::Combination c;
    for (const std::string& name : from["exponents"].keys())
      c.exponents.emplace_back(name, from["exponents"][name].number());
    c.relative_error = from["relative_error"].number_or(infinity);
    found.combinations.push_back(std::move(c));
  }
  const JsonReader contact = json["contact_stiffness"];
  found.contact = {contact["force_n"].number(), contact["stiffness_n_m"].number(),
                   contact["relative_error"].number_or(infinity)};
  found.remedy = json["remedy"].text();
  return found;
}

Json profile_json(const fitting::Profile& profile) {
  return {{"name", profile.name},
          {"unit", profile.unit},
          {"value", profile.value},
          {"delta_chi2", profile.delta_chi2},
          {"ci95", Json::array({limit_json(profile.lower), limit_json(profile.upper)})},
          {"found_better", profile.found_better}};
}

fitting::Profile profile_from(const JsonReader& json) {
  fitting::Profile profile;
  profile.name = json["name"].text();
  profile.unit = json["unit"].text();
  profile.value = json["value"].numbers();
  profile.delta_chi2 = json["delta_chi2"].numbers();
  if (profile.value.size() != profile.delta_chi2.size())
    json.fail("value and delta_chi2 must be of one length");
  const auto [lower, upper] = json["ci95"].pair();
  profile.lower = limit_from(lower);
  profile.upper = limit_from(upper);
  profile.found_better = json["found_better"].boolean();
  return profile;
}

Json bootstrap_json(const fitting::Bootstrap& bootstrap) {
  Json parameters = Json::array();
  for (const fitting::Bootstrap::Parameter& p : bootstrap.parameters)
    parameters.push_back({{"name", p.name},
                          {"bias", p.bias},
                          {"std_error", p.std_error},
                          {"ci95", pair_json(p.ci95)},
                          {"draws", p.draws}});
  return {{"kind", fitting::name(bootstrap.kind)},
          {"seed", bootstrap.seed},
          {"draws", bootstrap.draws},
          {"failed", bootstrap.failed},
          {"parameters", parameters},
          {"at_bounds", bootstrap.at_bounds},
          {"seconds", bootstrap.seconds}};
}

fitting::Bootstrap bootstrap_from(const JsonReader& json) {
  fitting::Bootstrap bootstrap;
  try {
    bootstrap.kind = fitting::bootstrap_named(json["kind"].text());
  } catch (const std::invalid_argument& error) {
    json["kind"].fail(error.what());
  }
  bootstrap.seed = json["seed"].count();
  bootstrap.draws = static_cast<int>(json["draws"].integer());
  bootstrap.failed = static_cast<int>(json["failed"].integer());
  bootstrap.seconds = json["seconds"].number();
  const JsonReader parameters = json["parameters"];
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const JsonReader p = parameters.element(i);
    bootstrap.parameters.push_back({.name = p["name"].text(),
                                    .bias = p["bias"].number(),
                                    .std_error = p["std_error"].number(),
                                    .ci95 = p["ci95"].pair(),
                                    .draws = p["draws"].numbers()});
  }
  return bootstrap;
}

}  // namespace impactrig::reports
