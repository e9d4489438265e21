// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include "models/simulation.hpp"

namespace impactrig::models {

/// Solves a rig's full equations, to the accuracy that the solver states.
using SolveFully = std::function<Simulation(const Solver&, const SimulationOptions&)>;

/// The solution by the full equations, of a bar before its stop. Of one that is strained much, by
/// its speed or by its weight, whose hinge rubs, or that moves like a chain in a long contact,
/// motion may magnify errors so far that the control of single steps does not bound them: such a
/// one is solved at several accuracies, until its first contact changes by no more than the
/// accuracy asked for; where that fails the last of them stands, with a warning that says by how
/// much it changed.
///
/// What magnifies them: Reissner's bar stretched to Λ times its length turns its sections against
/// the pull where E (Λ - 1) > κ G Λ. A limp bar whips, as several pendulums in a row do. A hinge
/// that all but stops sticks, or does not, by the last digit of the bar's vibration.
Simulation solve_until_settled(const Rig& rig, const Solver& solver,
                               const SimulationOptions& options, const SolveFully& solve);

}  // namespace impactrig::models
