// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "models/simulation.hpp"

namespace impactrig::tests {

/// Largest relative difference of what accuracy promises: peak, duration and impulse of the first
/// contact.
inline double first_contact_difference(const models::Simulation& a, const models::Simulation& b) {
  const models::Episode& x = a.episodes.at(0);
  const models::Episode& y = b.episodes.at(0);
  return std::max({std::abs(x.peak_force / y.peak_force - 1.0), std::abs(x.end / y.end - 1.0),
                   std::abs(x.impulse / y.impulse - 1.0)});
}

inline models::Simulation simulate_as(models::Motion motion, const models::Rig& rig,
                                      models::Solver solver, double accuracy) {
  models::SimulationOptions options;
  options.motion = motion;
  solver.accuracy = accuracy;
  return models::simulate(rig, solver, options);
}

}  // namespace impactrig::tests
