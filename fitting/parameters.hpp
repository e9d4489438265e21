// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "datasets/sensor.hpp"
#include "models/rig.hpp"

namespace impactrig::fitting {

/// A number of the rig that a fit may free, by its key in the rig file.
struct PhysicalParameter {
  std::string_view name;
  std::string_view unit;  ///< SI
  double lower, upper;    ///< bounds; a zero upper bound: ten times the starting value
  bool of_shot;           ///< differs from recording to recording
  double& (*of)(models::Rig& rig);
  bool of_full_motion_only = false;  ///< small motion knows nothing of it
};

/// Its SI unit in a rig, where that of a power law's stiffness depends on the power: "N/m^1.5".
std::string unit_in(const models::Rig& rig, const PhysicalParameter& parameter);

/// A number of a sensor's chain that a fit may free, by its key under sensors.CHANNEL; a band limit
/// by its frequency, whatever its order.
struct ChainParameter {
  std::string_view name;
  std::string_view unit;  ///< SI
  double& (*of)(datasets::Sensor& sensor);
};

/// Every parameter of the physics there is; a new one is one line here.
std::span<const PhysicalParameter> physical_parameters();

/// Masses on the bar, and segments of it, that have names.
inline constexpr int most_numbered = 8;

/// Numbers of the rig that no fit frees, since they are measured apart or act as others do, but on
/// which a prediction depends: weight, section, segments, masses on the bar, what a hinge is turned
/// by, what else a contact is made of. Of the first most_numbered segments and masses and of the
/// first three further stops. Bounds have no meaning.
std::span<const PhysicalParameter> stated_parameters();

const PhysicalParameter* find_physical_parameter(std::string_view name);  ///< none: nullptr
const ChainParameter* find_chain_parameter(std::string_view name);        ///< none: nullptr

/// "sensors.force.amplifier.high_cut": force, high_cut.
struct SensorKey {
  datasets::Quantity quantity;
  std::string what;
};

std::optional<SensorKey> sensor_key(std::string_view name);  ///< none where it is no sensor's

/// "start.velocity[2]": start.velocity of recording 2; a name without number is of recording 0.
struct ParameterKey {
  std::string key;
  int recording = 0;  ///< from 1
};

ParameterKey parameter_key(std::string_view name);

/// SI unit of whatever a fit may free, "1" when dimensionless, of all recordings or of one. Throws
/// std::invalid_argument on an unknown name (and lists the known ones).
std::string unit_of(std::string_view name);

}  // namespace impactrig::fitting
