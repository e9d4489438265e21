// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include "models/simulation.hpp"

namespace impactrig::models {

/// Solves a rig's full equations, to the accuracy that the solver states.
using SolveFully = std::function<Simulation(const Solver&, const SimulationOptions&)>;

/// The solution by the full equations. Of a bar that moves fast enough to strain it much, motion
/// may magnify errors so far that the control of single steps does not bound them: such a one is
/// solved at several accuracies, until its first contact changes by no more than the accuracy asked
/// for, or a warning says by how much it does.
Simulation solve_until_settled(const Rig& rig, const Solver& solver,
                               const SimulationOptions& options, const SolveFully& solve);

}  // namespace impactrig::models
