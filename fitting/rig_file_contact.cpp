// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/rig_file_contact.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

#include "models/contact/damping_law.hpp"
#include "models/contact/elastic_law.hpp"

namespace impactrig::fitting {
namespace {

void read_counterface(TableReader& table, bool needed, models::Contact& contact) {
  auto face = table.table("counterface");
  if (!face) {
    if (needed)
      table.refuse("counterface",
                   "is missing; add counterface = { shape = \"groove\", radius = \"17.5 mm\" }");
    return;
  }
  const auto shape = face->choice("shape", {"groove", "cylinder", "plane"});
  if (!shape)
    face->refuse("shape", "is missing; add shape = \"groove\", \"cylinder\" or \"plane\"");
  contact.counterface = static_cast<models::Counterface>(*shape);
  if (contact.counterface == models::Counterface::plane) {
    face->quantity("radius", "m");
    if (const auto depth = face->quantity("depth", "m")) contact.counter_depth = depth->value;
  } else {
    contact.counter_radius = face->required_quantity("radius", "m", "17.5 mm");
  }
  face->finish();
}

/// Number of the segment that holds a place of the bar, the first of two at a step.
std::size_t segment_at(const models::Beam& beam, double x) {
  std::size_t i = 0;
  double end = beam.segments.empty() ? beam.length : beam.segments[0].length;
  while (i + 1 < beam.segments.size() && x > end * (1.0 + 1e-12)) end += beam.segments[++i].length;
  return i;
}

/// Of the elastic law and of the damping law; an unknown one is told when the rig is validated.
models::LawNeeds needs_of(const models::Contact& contact) {
  const auto known = [](const auto& laws, std::string_view name) {
    return std::ranges::find(laws, name, [](const auto& law) { return law.text.name; });
  };
  const auto elastic = known(models::elastic_laws(), contact.law);
  const auto damping = known(models::damping_laws(), contact.damping);
  models::LawNeeds needs;
  if (elastic != models::elastic_laws().end()) needs = elastic->text.needs;
  if (damping != models::damping_laws().end() &&
      damping->text.form == models::DampingForm::hertzian)
    needs.radii = needs.moduli = true;
  return needs;
}

/// "1.6e10 N/m^1.5": factor and power of a power law; none where the unit tells no power. Throws
/// std::invalid_argument as parse_quantity() does.
std::optional<std::pair<double, double>> factor_and_power(const std::string& text) {
  const std::size_t slash = text.rfind('/'), caret = text.rfind('^');
  if (slash == std::string::npos || caret == std::string::npos || slash > caret)
    return std::nullopt;
  double power = 0.0;
  const char* end = text.data() + text.size();
  if (std::from_chars(text.data() + caret + 1, end, power).ptr != end) return std::nullopt;
  const double metres =
      datasets::parse_quantity("1 " + text.substr(slash + 1, caret - slash - 1), "m").value;
  const double factor = datasets::parse_quantity(text.substr(0, slash), "N").value;
  return std::pair(factor / std::pow(metres, power), power);
}

void read_stiffness(TableReader& table, bool any_power, models::Contact& contact) {
  if (!any_power) {
    contact.stiffness = table.required_quantity("stiffness", "N/m", "1e8 N/m");
    return;
  }
  const std::string text = table.required_text("stiffness", "1.6e10 N/m^1.5");
  std::string why;
  try {
    if (const auto stated = factor_and_power(text)) {
      std::tie(contact.stiffness, contact.power) = *stated;
      return;
    }
  } catch (const std::invalid_argument& error) {
    why = error.what();
    why = ": " + why.substr(0, why.find(';'));  // behind it an example of the factor alone
  }
  table.refuse("stiffness", fmt::format("expected a factor whose unit tells the power, for example "
                                        "\"1.6e10 N/m^1.5\", found \"{}\"{}",
                                        text, why));
}

/// What the damping law takes besides the restitution.
void read_damping(TableReader& table, models::Contact& contact) {
  const auto value = [&](std::string_view key, std::string_view unit) -> std::optional<double> {
    const auto quantity = table.quantity(key, unit);
    return quantity ? std::optional(quantity->value) : std::nullopt;
  };
  contact.restitution_speed = value("restitution_speed", "m/s");
  contact.viscous = value("viscous", "N.s/m");
  contact.relaxation_time = value("relaxation_time", "s");
  contact.effective_mass = value("effective_mass", "kg");
  if (const auto tension = table.choice("tension", {"clip", "allow"}))
    contact.tension = static_cast<models::Tension>(*tension);
  const auto only_for = [&](std::string_view key, std::string_view law, bool stated) {
    if (stated && contact.damping != law)
      table.refuse(key, fmt::format("only the damping law \"{}\" takes it, this contact has \"{}\"",
                                    law, contact.damping));
  };
  only_for("viscous", "viscous", contact.viscous.has_value());
  only_for("relaxation_time", "kuwabara-kono", contact.relaxation_time.has_value());
}

/// What a further stop that does not state it has from the first, or as that has by default.
std::vector<std::string> numbers_from(const toml::table& first, const TableReader& further) {
  std::vector<std::string> keys;
  for (const char* key : {"restitution", "stiffness_factor", "length", "stiffness", "position",
                          "modulus", "counter_modulus", "radius", "viscous", "relaxation_time"})
    if (!further.has(key) && (first.contains(key) || key == std::string_view("stiffness_factor")))
      keys.emplace_back(key);
  if (!further.has("counterface") && first.contains("counterface"))
    keys.emplace_back("counterface.radius");
  if (std::ranges::find(keys, "stiffness") != keys.end()) keys.emplace_back("power");
  return keys;
}

}  // namespace

void read_contact(TableReader& table, const models::Beam& beam, const std::vector<double>& radii,
                  models::Contact& contact) {
  contact.law = table.text("law").value_or(contact.law);
  contact.damping = table.text("damping").value_or(contact.damping);
  contact.position = table.required_quantity("position", "m", "0.69 m");
  const std::size_t struck = segment_at(beam, contact.position);
  const models::LawNeeds needs = needs_of(contact);
  read_counterface(table, needs.radii, contact);
  if (needs.length)
    contact.length = table.required_quantity("length", "m", "20 mm");
  else
    contact.length = table.quantity("length", "m").value_or(datasets::UncertainValue{}).value;
  if (needs.stiffness)
    read_stiffness(table, needs.power, contact);
  else if (table.has("stiffness"))
    table.refuse("stiffness",
                 fmt::format("the law \"{}\" follows from geometry and moduli; scale it with "
                             "stiffness_factor, or take \"linear\" or "
                             "\"lankarani-nikravesh-cylinder\"",
                             contact.law));
  const auto radius = table.quantity("radius", "m");
  if (!radius && radii[struck] == 0.0 && needs.radii)
    table.refuse("radius",
                 "is missing; the section has no radius of its own, state that of the contact "
                 "patch, for example "
                 "radius = \"15 mm\"");
  contact.radius = radius ? radius->value : radii[struck];
  const auto modulus = table.quantity("modulus", "Pa");
  const double beam_modulus =
      beam.segments.empty() ? beam.youngs_modulus
                            : beam.segments[struck].youngs_modulus.value_or(beam.youngs_modulus);
  contact.modulus = modulus ? modulus->value : beam_modulus;
  contact.poisson_ratio = table.number("poisson_ratio").value_or(beam.poisson_ratio);
  const auto counter_modulus = table.quantity("counter_modulus", "Pa");
  if (!counter_modulus && needs.moduli)
    table.refuse("counter_modulus", "is missing; add counter_modulus = \"68.952 GPa\"");
  if (counter_modulus) contact.counter_modulus = counter_modulus->value;
  contact.counter_poisson_ratio = table.number("counter_poisson_ratio").value_or(0.3);
  contact.exponent = table.integer("exponent").value_or(contact.exponent);
  if (const auto unit = table.quantity("reference_length", "m"))
    contact.reference_length = unit->value;
  contact.stiffness_factor = table.number("stiffness_factor").value_or(1.0);
  read_damping(table, contact);
  const auto restitution = table.number("restitution");
  if (!restitution && contact.takes_restitution())
    table.refuse("restitution", "is missing; add restitution = 0.5 (or damping = \"none\")");
  contact.restitution = restitution.value_or(1.0);
  table.finish();
}

FurtherStops read_further_stops(TableReader& root, const models::Beam& beam,
                                const std::vector<double>& radii) {
  FurtherStops read;
  const toml::table* first = root.raw()["contact"].as_table();
  for (TableReader& table : root.tables("contacts")) {
    if (!first)
      root.refuse("contacts", "there is no [contact]; state the stop that is struck first there");
    toml::table inherited = *first;
    if (table.has("law")) inherited.erase("stiffness");
    if (table.has("damping")) {  // of the first stop's law
      inherited.erase("viscous");
      inherited.erase("relaxation_time");
    }
    const std::vector<std::string> keys = numbers_from(inherited, table);
    table.inherit(inherited);
    models::FurtherStop stop;
    stop.gap = table.required_quantity("gap", "m", "0.1 mm");
    if (const auto side = table.choice("side", {"near", "far"}))
      stop.side = static_cast<models::StopSide>(*side);
    read_contact(table, beam, radii, stop.contact);
    read.stops.push_back(stop);
    for (const std::string& key : keys)
      if (key != "restitution" || stop.contact.takes_restitution())
        read.inherited.push_back(fmt::format("contacts.{}.{}", read.stops.size(), key));
  }
  return read;
}

}  // namespace impactrig::fitting
