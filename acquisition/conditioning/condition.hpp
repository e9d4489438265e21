// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "datasets/impact.hpp"
#include "datasets/record.hpp"
#include "datasets/sensor.hpp"

namespace impactrig::acquisition {

/// The sensors of a rig, as far as it has them.
struct SensorSet {
  std::optional<datasets::Sensor> force;
  std::optional<datasets::Sensor> velocity;
  std::optional<datasets::Sensor> displacement;
};

/// A record whose channels are force, velocity and displacement in SI, positive in compression and while closing, known
/// delays taken off the clocks. Channels that no sensor claims are left out. Every step is an Edit in the provenance.
/// A sensor that names no channel takes the only channel of its quantity; a sensor set without force, velocity or
/// displacement takes what the record has. Throws datasets::InputError (with the recording as place) when a named channel
/// is absent, a unit is not that of the sensor's quantity and no sensitivity bridges the two, or samples are not finite.
datasets::Record condition(const datasets::Record& record, const SensorSet& sensors);

/// How impacts are looked for.
struct DetectionOptions {
  double threshold = 0.0;       ///< on the trigger channel [SI]; 0 = from noise and peak
  double pre_trigger = 0.5e-3;  ///< kept before first touch [s]
  double post_trigger = 5e-3;   ///< kept after first touch [s]
};

/// Finds impacts in a conditioned record (or any record with a force, acceleration or velocity channel), in order of time.
/// Each holds the channels cut to its window, baseline and noise taken from before the trigger. Empty when there is none.
std::vector<datasets::Impact> find_impacts(const datasets::Record& record,
                                           const DetectionOptions& options = {});

}  // namespace impactrig::acquisition
