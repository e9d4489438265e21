// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/parameters.hpp"

#include <fmt/format.h>

#include <array>
#include <optional>
#include <stdexcept>
#include <string>

namespace impactrig::fitting {
namespace {

using models::Rig;

/// Of a rigid stop all zero: nothing a fit could start from.
models::Stop& stop_of(Rig& rig) {
  return rig.stop ? *rig.stop : rig.stop.emplace();
}

double& stated(std::optional<double>& value) {
  return value ? *value : value.emplace();
}

constexpr std::array parameters = {
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
};

}  // namespace

std::span<const PhysicalParameter> physical_parameters() {
  return parameters;
}

const PhysicalParameter& physical_parameter(std::string_view name) {
  std::string known;
  for (const PhysicalParameter& parameter : parameters) {
    if (parameter.name == name) return parameter;
    known += fmt::format("{}{}", known.empty() ? "" : ", ", parameter.name);
  }
  throw std::invalid_argument(
      fmt::format("'{}' cannot be fitted; parameters are {}, and sensors.CHANNEL.gain and "
                  "sensors.CHANNEL.delay",
                  name, known));
}

}  // namespace impactrig::fitting
