// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "models/simulation.hpp"

namespace impactrig::models {

/// Twice the elements or modes; the same for a rigid bar.
Solver refined(const Solver& solver);

/// Half the elements or modes; none where a number of elements is odd or little would be left, and
/// of a rigid bar.
std::optional<Solver> halved(const Solver& solver);

/// At most 4 modes, axial_modes none, or 16 elements where both parts can be divided alike: enough
/// for what a rotation does that is large, or a comparison of two equations of motion.
Solver coarsened(const Solver& solver);

/// By two runs to the end of the first contact, whole ones where the stop gives way and its
/// sensor's largest force is known: as small motion where that leaves out no more than a hundredth
/// of the result, else by the full equations. None for a rigid bar, or where one of the runs is not
/// possible in the processor time that both may take [s].
std::optional<MeshError> mesh_error(const Rig& rig, const Solver& solver, double time_limit);

struct ChosenMesh {
  Solver solver;       ///< with what is left of its time limit
  double error = 0.0;  ///< estimated, MeshError::largest(); NaN where it cannot be
  std::optional<double> sensor_until{};  ///< MeshError::sensor_until
};

/// The coarsest mesh of 8, 16, 32, ... up to `finest` ANCF elements, split at the struck point,
/// whose error is within half of `solver.accuracy`; else the finest that half of the time limit
/// allows. The error is what twice the elements change, but no less than 1/16 of what half of them
/// change, for two meshes may agree by chance.
ChosenMesh choose_mesh(const Rig& rig, const Solver& solver, int finest);

/// A number of elements split at the struck point, at least one on either side that is not empty.
std::array<int, 2> split_elements(int total, const Rig& rig);

}  // namespace impactrig::models
