// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/simulation.hpp"

namespace impactrig::models {

/// A solution and its CollocationRun::smallness(): below 1 its first contact is much smaller than
/// it was taken for, or ends slowly, and is to be solved again, so that its errors are compared
/// with its own size.
struct Solved {
  Simulation result;
  double smallness = 1.0;
};

/// What it is solved again with.
Solver solver_to_size(const Solver& solver, double smallness);

/// The solution by that, after one of such smallness to the accuracy asked for; with a warning of
/// what is not known of it even so.
Simulation solved_to_size(const Simulation& first, Solved again, double smallness, double accuracy);

/// The first solution where there was no time for another, with a warning.
Simulation not_solved_to_size(Solved first);

}  // namespace impactrig::models
