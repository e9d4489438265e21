// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include "models/simulation.hpp"

namespace impactrig::models {

/// Solves a rig to the accuracy that the solver states.
using SolveRig = std::function<Simulation(const Solver&, const SimulationOptions&)>;

/// Of a stop that gives way, whether its sensor's largest force [N] is known as well as asked for
/// where that lies beyond a second touch: each contact magnifies the errors of those before it, and
/// no step's control bounds that. Solved again 10 times less accurately, until then, in the time
/// left [s], it may change by the accuracy. Where it changes by up to 10 times that, which the
/// coarser solution may err by, one 10 times more accurate decides. Where that changes by more than
/// the accuracy, or none can be had, SensorForce::peak_known is false and a warning says so.
/// Where it lies before, and from the second touch on nearly as much is carried, it is solved again
/// 10 times less accurately over the run: what is carried later may change by a small part of what
/// it lacks.
void confirm_sensor_peak(const Solver& solver, const SimulationOptions& options, double time_left,
                         const SolveRig& solve, Simulation& run);

}  // namespace impactrig::models
