// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "models/simulation.hpp"

namespace impactrig::models {

/// Twice the elements or modes; the same for a rigid bar.
Solver refined(const Solver& solver);

/// At most 4 modes, axial_modes none, or 16 elements where both parts can be divided alike: enough
/// for what a rotation does that is large, or a comparison of two equations of motion.
Solver coarsened(const Solver& solver);

/// By two runs as small motion; none for a rigid bar, or where one of the runs is not possible.
std::optional<MeshError> mesh_error(const Rig& rig, const Solver& solver);

/// The solver with the coarsest mesh of 8, 16, 32 or 64 ANCF elements, split at the struck point,
/// whose error is within `solver.accuracy`; else the finest. `error` is what it is estimated to be;
/// for 64 elements by the trend. Left as it is where no error can be estimated.
Solver choose_mesh(const Rig& rig, const Solver& solver, double& error);

/// A number of elements split at the struck point, at least one on either side that is not empty.
std::array<int, 2> split_elements(int total, const Rig& rig);

}  // namespace impactrig::models
