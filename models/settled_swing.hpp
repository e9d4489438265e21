// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/settled_solution.hpp"

namespace impactrig::models {

/// A swing, or a prescribed rotation, by the full equations: of a bar without a stop. Where its
/// hinge rubs, or it has about the energy to stand upright, or vibrates with a hundredth of its
/// energy, motion magnifies errors that control of single steps does not bound: such a swing is
/// solved at several accuracies, until displacements over the run change by no more than the
/// accuracy asked for, as parts of the bar's length. Where that fails the last solution stands,
/// with a warning.
Simulation solve_swing_until_settled(const Rig& rig, const Solver& solver,
                                     const SimulationOptions& options, const SolveFully& solve);

}  // namespace impactrig::models
