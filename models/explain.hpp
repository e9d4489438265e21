// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "models/simulation.hpp"

namespace impactrig::models {

/// "small motion", "fast vibration" ...
std::string_view name(Simplification what);

/// What one simplification of a run does, found by the run without it.
struct Explanation {
  Simplification what;
  std::string sentence;  ///< as simulate() has it
  /// Relative change of the first contact's peak force, duration and impulse by it; of a swing
  /// without a stop unknown: NaN, as of a contact that does not end.
  double peak_force = 0.0, duration = 0.0, impulse = 0.0;
  double seconds = 0.0, seconds_without = 0.0;  ///< processor time of the run and of that without
  std::string failure;  ///< why the run without it gives no answer; empty when it does
};

/// Solves again without each of the simplifications that simulate() takes. A run without one may
/// take `time_limit` [s] of processor time.
std::vector<Explanation> explain(const Rig& rig, const Solver& solver,
                                 const SimulationOptions& options, double time_limit);

}  // namespace impactrig::models
