// SPDX-License-Identifier: BSD-3-Clause
#include "models/sensitivities/spot_sensitivity.hpp"

#include <vector>

namespace impactrig::models {
namespace {

std::vector<double> still(const std::vector<double>& values) {
  return std::vector<double>(values.size(), 0.0);
}

}  // namespace

History spot_sensitivity(const History& history, Laser laser) {
  History change;
  change.start = history.start;
  change.interval = history.interval;
  for (const auto channel :
       {&History::force, &History::penetration, &History::velocity, &History::displacement,
        &History::sensor_force, &History::deflection, &History::extension})
    change.*channel = still(history.*channel);
  for (const StopHistory& stop : history.further)
    change.further.push_back({still(stop.force), still(stop.penetration)});
  change.jumps.resize(history.jumps.size());
  if (laser == Laser::velocity) {
    change.velocity = history.velocity_slope;
    return change;
  }
  change.displacement = history.displacement_slope;
  change.deflection = history.deflection_slope;
  change.extension = history.extension_slope;
  return change;
}

}  // namespace impactrig::models
