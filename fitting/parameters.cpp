// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "models/contact/elastic_law.hpp"

namespace impactrig::fitting {
namespace {

using models::Rig;

/// Of a rigid stop all zero: nothing a fit could start from.
models::Stop& stop_of(Rig& rig) {
  return rig.stop ? *rig.stop : rig.stop.emplace();
}

/// Of a stop there is not, likewise.
template <std::size_t K>
models::FurtherStop& further(Rig& rig) {
  if (rig.further_stops.size() < K) rig.further_stops.resize(K);
  return rig.further_stops[K - 1];
}

double& stated(std::optional<double>& value) {
  return value ? *value : value.emplace();
}

double& first_order(std::optional<datasets::BandLimit>& limit) {
  return limit ? limit->frequency : limit.emplace().frequency;
}

datasets::Resonance& resonance_of(datasets::Sensor& sensor) {
  return sensor.resonance ? *sensor.resonance : sensor.resonance.emplace();
}

constexpr std::array chain_parameters = {
    ChainParameter{"resonance.frequency", "Hz",
                   [](datasets::Sensor& s) -> double& { return resonance_of(s).frequency; }},
    ChainParameter{"resonance.quality", "1",
                   [](datasets::Sensor& s) -> double& { return resonance_of(s).quality; }},
    ChainParameter{"low_cut", "Hz",
                   [](datasets::Sensor& s) -> double& { return first_order(s.low_cut); }},
    ChainParameter{"high_cut", "Hz",
                   [](datasets::Sensor& s) -> double& { return first_order(s.high_cut); }},
    ChainParameter{"position", "m", [](datasets::Sensor& s) -> double& { return s.position; }},
};

constexpr std::array<std::string_view, 4> hums = {"hum.sin", "hum.cos", "hum.third_sin",
                                                  "hum.third_cos"};

constexpr std::array of_rig = {
    PhysicalParameter{"contact.restitution", "1", 0.0, 1.0, false,
                      [](Rig& r) -> double& { return r.contact.restitution; }},
    PhysicalParameter{"contact.stiffness_factor", "1", 0.01, 100.0, false,
                      [](Rig& r) -> double& { return r.contact.stiffness_factor; }},
    PhysicalParameter{"start.velocity", "m/s", 0.0, 0.0, true,
                      [](Rig& r) -> double& { return r.start.velocity; }},
    PhysicalParameter{"contact.length", "m", 0.0, 0.0, false,
                      [](Rig& r) -> double& { return r.contact.length; }},
    PhysicalParameter{"contact.stiffness", "N/m", 0.0, 0.0, false,
                      [](Rig& r) -> double& { return r.contact.stiffness; }},
    PhysicalParameter{"contact.power", "1", 1.0, 5.0, false,
                      [](Rig& r) -> double& { return r.contact.power; }},
    PhysicalParameter{"contact.viscous", "N s/m", 0.0, 0.0, false,
                      [](Rig& r) -> double& { return stated(r.contact.viscous); }},
    PhysicalParameter{"contact.relaxation_time", "s", 0.0, 0.0, false,
                      [](Rig& r) -> double& { return stated(r.contact.relaxation_time); }},
    PhysicalParameter{"contact.modulus", "Pa", 0.0, 0.0, false,
                      [](Rig& r) -> double& { return r.contact.modulus; }},
    PhysicalParameter{"contact.counter_modulus", "Pa", 0.0, 0.0, false,
                      [](Rig& r) -> double& { return r.contact.counter_modulus; }},
    PhysicalParameter{"contact.radius", "m", 0.0, 0.0, false,
                      [](Rig& r) -> double& { return r.contact.radius; }},
    PhysicalParameter{"contact.counterface.radius", "m", 0.0, 0.0, false,
                      [](Rig& r) -> double& { return r.contact.counter_radius; }},
    PhysicalParameter{"contact.position", "m", 0.0, 0.0, false,
                      [](Rig& r) -> double& { return r.contact.position; }},
    PhysicalParameter{"stop.mass", "kg", 0.0, 0.0, false,
                      [](Rig& r) -> double& { return stop_of(r).mass; }},
    PhysicalParameter{"stop.stiffness", "N/m", 0.0, 0.0, false,
                      [](Rig& r) -> double& { return stop_of(r).stiffness; }},
    PhysicalParameter{"stop.viscous", "N s/m", 0.0, 0.0, false,
                      [](Rig& r) -> double& { return stop_of(r).viscous; }},
    PhysicalParameter{"beam.youngs_modulus", "Pa", 0.0, 0.0, false,
                      [](Rig& r) -> double& { return r.beam.youngs_modulus; }},
    PhysicalParameter{"beam.density", "kg/m^3", 0.0, 0.0, false,
                      [](Rig& r) -> double& { return r.beam.density; }},
    PhysicalParameter{"beam.length", "m", 0.0, 0.0, false,
                      [](Rig& r) -> double& { return r.beam.length; }},
    PhysicalParameter{"beam.shear_coefficient", "1", 0.05, 2.0, false,
                      [](Rig& r) -> double& { return r.beam.shear_coefficient; }},
    PhysicalParameter{"beam.damping.mass", "1/s", 0.0, 0.0, false,
                      [](Rig& r) -> double& { return r.beam.damping.mass; }},
    PhysicalParameter{"beam.damping.stiffness", "s", 0.0, 0.0, false,
                      [](Rig& r) -> double& { return r.beam.damping.stiffness; }},
    PhysicalParameter{"hinge.spring", "N m/rad", 0.0, 0.0, false,
                      [](Rig& r) -> double& { return r.hinge.spring; }},
    PhysicalParameter{"hinge.viscous", "N m s/rad", 0.0, 0.0, false,
                      [](Rig& r) -> double& { return r.hinge.viscous; }},
    PhysicalParameter{"hinge.friction", "N m", 0.0, 0.0, false,
                      [](Rig& r) -> double& { return r.hinge.friction; }, true},
};

double& release_angle_of(Rig& rig) {
  return stated(rig.start.release_angle);
}

models::HingeRotation& rotation_of(Rig& rig) {
  return rig.hinge.rotation ? *rig.hinge.rotation : rig.hinge.rotation.emplace();
}

/// Of a body there is not, nothing likewise.
template <std::size_t K>
models::LumpedMass& lump(Rig& rig) {
  if (rig.beam.masses.size() < K) rig.beam.masses.resize(K);
  return rig.beam.masses[K - 1];
}

/// Of a segment there is not, likewise.
template <std::size_t K>
models::BeamSegment& segment(Rig& rig) {
  if (rig.beam.segments.size() < K) rig.beam.segments.resize(K);
  return rig.beam.segments[K - 1];
}

constexpr std::array not_fitted = {
    PhysicalParameter{"environment.gravity", "m/s^2", 0.0, 0.0, false,
                      [](Rig& r) -> double& { return r.gravity; }},
    PhysicalParameter{"environment.gravity_direction", "rad", 0.0, 0.0, false,
                      [](Rig& r) -> double& { return r.gravity_direction; }},
    PhysicalParameter{"start.release_angle", "rad", 0.0, 0.0, true, release_angle_of},
    PhysicalParameter{"beam.section.area", "m^2", 0.0, 0.0, false,
                      [](Rig& r) -> double& { return r.beam.area; }},
    PhysicalParameter{"beam.section.second_moment", "m^4", 0.0, 0.0, false,
                      [](Rig& r) -> double& { return r.beam.second_moment; }},
    PhysicalParameter{"hinge.rotation.rate", "rad/s", 0.0, 0.0, false,
                      [](Rig& r) -> double& { return rotation_of(r).rate; }},
    PhysicalParameter{"hinge.rotation.time", "s", 0.0, 0.0, false,
                      [](Rig& r) -> double& { return rotation_of(r).time; }},
    PhysicalParameter{"contact.poisson_ratio", "1", 0.0, 0.0, false,
                      [](Rig& r) -> double& { return r.contact.poisson_ratio; }},
    PhysicalParameter{"contact.counter_poisson_ratio", "1", 0.0, 0.0, false,
                      [](Rig& r) -> double& { return r.contact.counter_poisson_ratio; }},
    PhysicalParameter{"contact.counterface.depth", "m", 0.0, 0.0, false,
                      [](Rig& r) -> double& { return r.contact.counter_depth; }},
    PhysicalParameter{"contact.reference_length", "m", 0.0, 0.0, false,
                      [](Rig& r) -> double& { return stated(r.contact.reference_length); }},
    PhysicalParameter{"contact.restitution_speed", "m/s", 0.0, 0.0, false,
                      [](Rig& r) -> double& { return stated(r.contact.restitution_speed); }},
    PhysicalParameter{"contact.effective_mass", "kg", 0.0, 0.0, false,
                      [](Rig& r) -> double& { return stated(r.contact.effective_mass); }},
};

/// Of the body K on the bar.
template <std::size_t K>
std::array<PhysicalParameter, 2> of_mass() {
  static const std::array names = {fmt::format("beam.masses.{}.mass", K),
                                   fmt::format("beam.masses.{}.position", K)};
  return {PhysicalParameter{names[0], "kg", 0.0, 0.0, false,
                            [](Rig& r) -> double& { return lump<K>(r).mass; }},
          {names[1], "m", 0.0, 0.0, false, [](Rig& r) -> double& { return lump<K>(r).position; }}};
}

/// Of the bar's segment K.
template <std::size_t K>
std::array<PhysicalParameter, 6> of_segment() {
  static const std::array names = {fmt::format("beam.segments.{}.length", K),
                                   fmt::format("beam.segments.{}.section.area", K),
                                   fmt::format("beam.segments.{}.section.second_moment", K),
                                   fmt::format("beam.segments.{}.shear_coefficient", K),
                                   fmt::format("beam.segments.{}.youngs_modulus", K),
                                   fmt::format("beam.segments.{}.density", K)};
  return {PhysicalParameter{names[0], "m", 0.0, 0.0, false,
                            [](Rig& r) -> double& { return segment<K>(r).length; }},
          {names[1], "m^2", 0.0, 0.0, false, [](Rig& r) -> double& { return segment<K>(r).area; }},
          {names[2], "m^4", 0.0, 0.0, false,
           [](Rig& r) -> double& { return segment<K>(r).second_moment; }},
          {names[3], "1", 0.0, 0.0, false,
           [](Rig& r) -> double& { return segment<K>(r).shear_coefficient; }},
          {names[4], "Pa", 0.0, 0.0, false,
           [](Rig& r) -> double& { return stated(segment<K>(r).youngs_modulus); }},
          {names[5], "kg/m^3", 0.0, 0.0, false,
           [](Rig& r) -> double& { return stated(segment<K>(r).density); }}};
}

/// Of the further stop K what no fit frees.
template <std::size_t K>
std::array<PhysicalParameter, 6> stated_of_further_stop() {
  static const std::array names = {fmt::format("contacts.{}.poisson_ratio", K),
                                   fmt::format("contacts.{}.counter_poisson_ratio", K),
                                   fmt::format("contacts.{}.counterface.depth", K),
                                   fmt::format("contacts.{}.reference_length", K),
                                   fmt::format("contacts.{}.restitution_speed", K),
                                   fmt::format("contacts.{}.effective_mass", K)};
  return {PhysicalParameter{names[0], "1", 0.0, 0.0, false,
                            [](Rig& r) -> double& { return further<K>(r).contact.poisson_ratio; }},
          {names[1], "1", 0.0, 0.0, false,
           [](Rig& r) -> double& { return further<K>(r).contact.counter_poisson_ratio; }},
          {names[2], "m", 0.0, 0.0, false,
           [](Rig& r) -> double& { return further<K>(r).contact.counter_depth; }},
          {names[3], "m", 0.0, 0.0, false,
           [](Rig& r) -> double& { return stated(further<K>(r).contact.reference_length); }},
          {names[4], "m/s", 0.0, 0.0, false,
           [](Rig& r) -> double& { return stated(further<K>(r).contact.restitution_speed); }},
          {names[5], "kg", 0.0, 0.0, false,
           [](Rig& r) -> double& { return stated(further<K>(r).contact.effective_mass); }}};
}

std::vector<PhysicalParameter> all_stated_parameters() {
  std::vector<PhysicalParameter> all(not_fitted.begin(), not_fitted.end());
  const auto append = [&](const auto& more) { all.insert(all.end(), more.begin(), more.end()); };
  const auto append_each = [&]<std::size_t... K>(std::index_sequence<K...>) {
    (append(of_mass<K + 1>()), ...);
    (append(of_segment<K + 1>()), ...);
  };
  append_each(std::make_index_sequence<most_numbered>());
  append(stated_of_further_stop<1>());
  append(stated_of_further_stop<2>());
  append(stated_of_further_stop<3>());
  return all;
}

/// Of the further stop K; its keys are those of [[contacts]] behind its number.
template <std::size_t K>
std::array<PhysicalParameter, 13> of_further_stop() {
  static const std::array names = {
      fmt::format("contacts.{}.restitution", K), fmt::format("contacts.{}.stiffness_factor", K),
      fmt::format("contacts.{}.length", K),      fmt::format("contacts.{}.stiffness", K),
      fmt::format("contacts.{}.position", K),    fmt::format("contacts.{}.gap", K),
      fmt::format("contacts.{}.modulus", K),     fmt::format("contacts.{}.counter_modulus", K),
      fmt::format("contacts.{}.radius", K),      fmt::format("contacts.{}.counterface.radius", K),
      fmt::format("contacts.{}.viscous", K),     fmt::format("contacts.{}.relaxation_time", K),
      fmt::format("contacts.{}.power", K)};
  return {PhysicalParameter{names[0], "1", 0.0, 1.0, false,
                            [](Rig& r) -> double& { return further<K>(r).contact.restitution; }},
          {names[1], "1", 0.01, 100.0, false,
           [](Rig& r) -> double& { return further<K>(r).contact.stiffness_factor; }},
          {names[2], "m", 0.0, 0.0, false,
           [](Rig& r) -> double& { return further<K>(r).contact.length; }},
          {names[3], "N/m", 0.0, 0.0, false,
           [](Rig& r) -> double& { return further<K>(r).contact.stiffness; }},
          {names[4], "m", 0.0, 0.0, false,
           [](Rig& r) -> double& { return further<K>(r).contact.position; }},
          {names[5], "m", 0.0, 0.0, false, [](Rig& r) -> double& { return further<K>(r).gap; }},
          {names[6], "Pa", 0.0, 0.0, false,
           [](Rig& r) -> double& { return further<K>(r).contact.modulus; }},
          {names[7], "Pa", 0.0, 0.0, false,
           [](Rig& r) -> double& { return further<K>(r).contact.counter_modulus; }},
          {names[8], "m", 0.0, 0.0, false,
           [](Rig& r) -> double& { return further<K>(r).contact.radius; }},
          {names[9], "m", 0.0, 0.0, false,
           [](Rig& r) -> double& { return further<K>(r).contact.counter_radius; }},
          {names[10], "N s/m", 0.0, 0.0, false,
           [](Rig& r) -> double& { return stated(further<K>(r).contact.viscous); }},
          {names[11], "s", 0.0, 0.0, false,
           [](Rig& r) -> double& { return stated(further<K>(r).contact.relaxation_time); }},
          {names[12], "1", 1.0, 5.0, false,
           [](Rig& r) -> double& { return further<K>(r).contact.power; }}};
}

std::vector<PhysicalParameter> all_parameters() {
  std::vector<PhysicalParameter> all(of_rig.begin(), of_rig.end());
  const auto append = [&](const auto& more) { all.insert(all.end(), more.begin(), more.end()); };
  append(of_further_stop<1>());
  append(of_further_stop<2>());
  append(of_further_stop<3>());
  return all;
}

}  // namespace

std::span<const PhysicalParameter> physical_parameters() {
  static const std::vector<PhysicalParameter> all = all_parameters();
  return all;
}

std::span<const PhysicalParameter> stated_parameters() {
  static const std::vector<PhysicalParameter> all = all_stated_parameters();
  return all;
}

const PhysicalParameter* find_physical_parameter(std::string_view name) {
  const std::span<const PhysicalParameter> all = physical_parameters();
  const auto found = std::ranges::find(all, name, &PhysicalParameter::name);
  return found == all.end() ? nullptr : &*found;
}

const ChainParameter* find_chain_parameter(std::string_view name) {
  const auto found = std::ranges::find(chain_parameters, name, &ChainParameter::name);
  return found == chain_parameters.end() ? nullptr : &*found;
}

std::optional<SensorKey> sensor_key(std::string_view name) {
  for (const datasets::Quantity quantity : {datasets::Quantity::force, datasets::Quantity::velocity,
                                            datasets::Quantity::displacement}) {
    const std::string head = fmt::format("sensors.{}.", datasets::name(quantity));
    if (!name.starts_with(head)) continue;
    std::string_view rest = name.substr(head.size());
    if (rest.starts_with("amplifier.")) rest.remove_prefix(std::string_view("amplifier.").size());
    return SensorKey{quantity, std::string(rest)};
  }
  return std::nullopt;
}

ParameterKey parameter_key(std::string_view name) {
  const std::size_t bracket = name.rfind('[');
  const ParameterKey whole{std::string(name), 0};
  if (bracket == std::string_view::npos || !name.ends_with(']')) return whole;
  int number = 0;
  const char* const end = name.data() + name.size() - 1;
  const auto [stop, error] = std::from_chars(name.data() + bracket + 1, end, number);
  if (error != std::errc{} || stop != end || number < 1) return whole;
  return {std::string(name.substr(0, bracket)), number};
}

std::string unit_in(const models::Rig& rig, const PhysicalParameter& parameter) {
  models::Rig copy = rig;
  const double* const number = &parameter.of(copy);
  for (int stop = 0; stop < rig.stops(); ++stop) {
    const models::Contact& contact = copy.contact_of(stop);
    if (number == &contact.stiffness && models::elastic_law_entry(contact.law).text.needs.power)
      return fmt::format("N/m^{:g}", contact.power);
  }
  return std::string(parameter.unit);
}

std::string unit_of(std::string_view numbered) {
  const std::string name = parameter_key(numbered).key;
  if (const PhysicalParameter* physical = find_physical_parameter(name))
    return std::string(physical->unit);
  if (name == "impact.time") return "s";
  if (const auto key = sensor_key(name)) {
    const std::string unit(datasets::si_unit(key->quantity));
    if (key->what == "gain") return "1";
    if (key->what == "delay") return "s";
    if (key->what == "drift") return unit + "/s";
    if (key->what == "offset" || std::ranges::find(hums, key->what) != hums.end()) return unit;
    if (const ChainParameter* chain = find_chain_parameter(key->what))
      return std::string(chain->unit);
  }
  std::string known;
  for (const PhysicalParameter& parameter : of_rig) known += fmt::format("{}, ", parameter.name);
  std::string of_chain;
  for (const std::string_view hum : hums) of_chain += fmt::format(", {}", hum);
  for (const ChainParameter& parameter : chain_parameters)
    of_chain += fmt::format(", {}", parameter.name);
  throw std::invalid_argument(fmt::format(
      "'{}' cannot be fitted; parameters are {}impact.time, contacts.1. (2, 3) with gap and what "
      "contact. has, and sensors.CHANNEL. with gain, delay, offset, drift{}; NAME[K] is that of "
      "recording K, where each has its own",
      numbered, known, of_chain));
}

}  // namespace impactrig::fitting
