// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <vector>

#include "models/simulation.hpp"

namespace impactrig::models {

struct EnsembleOptions {
  /// As for simulate(); `bars` is not used, the ensemble has its own.
  SimulationOptions simulation;
  int threads = 0;  ///< 0: one a processor core
};

/// One rig's answer. `cost.seconds` is the time until it came, that of others beside it included.
struct EnsembleMember {
  Simulation simulation;
  std::string failure;  ///< what simulate() throws, as a sentence; empty when there is a simulation
};

/// simulate() of every rig: members that small motion serves are solved several at a time, a lane
/// each; the others one by one. Each agrees with simulate() within the accuracy asked for, and does
/// not depend on the number of threads or on the other members, to the last bit. What was left out
/// Simulation::taken says, without the sentences of `skipped`.
std::vector<EnsembleMember> simulate_ensemble(std::span<const Rig> rigs, const Solver& solver,
                                              const EnsembleOptions& options = {});

}  // namespace impactrig::models
