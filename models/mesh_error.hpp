// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "models/simulation.hpp"

namespace impactrig::models {

/// Twice the elements or modes; the same for a rigid bar.
Solver refined(const Solver& solver);

/// Half the elements or modes; none where a number of elements is odd, little would be left or too
/// few for where the bar changes, and of a rigid bar.
std::optional<Solver> halved(const Rig& rig, const Solver& solver);

/// At most 4 modes, axial_modes none, or 16 elements where both parts can be divided alike and the
/// bar does not need more: enough for what a rotation does that is large, or a comparison of two
/// equations of motion.
Solver coarsened(const Rig& rig, const Solver& solver);

/// By two runs to the end of the first contact that is more than a graze (2 % of the largest
/// force), whole ones where the stop gives way and its sensor's largest force is known: as small
/// motion where that leaves out no more than a hundredth of the result, else by the full equations.
/// Of shapes without shear on a bar with it twice what twice as many change, as they converge with
/// their number. None for a rigid bar, or where one of the runs is not possible in the processor
/// time that both may take [s].
std::optional<MeshError> mesh_error(const Rig& rig, const Solver& solver, double time_limit);

/// Which contact of a run meshes are compared by: the first that is more than a graze. A light head
/// on a sensor may leave the bar at once, and be pressed later.
std::size_t compared_contact(std::span<const Episode> episodes);

struct ChosenMesh {
  /// Why none finer was taken: it is accurate enough, the finest allowed, finer ones would take too
  /// long, or could not be compared.
  enum class End { accurate, finest, time, not_compared };

  Solver solver;       ///< with what is left of its time limit
  double error = 0.0;  ///< estimated, MeshError::largest(); NaN where it cannot be
  std::optional<double> sensor_until{};  ///< MeshError::sensor_until
  /// What twice the elements change; none without a stop, and where the error is not known.
  std::optional<MeshError> difference{};
  End end = End::not_compared;
};

/// The coarsest mesh of 8, 16, 32, ... up to `finest` ANCF elements, split at the struck point,
/// whose error is within half of `solver.accuracy`; else the finest that half of the time limit
/// allows. The error is what twice the elements change, but no less than 1/16 of what half of them
/// change, for two meshes may agree by chance. A part of the bar whose elements are far shorter
/// than the others is not divided further. A mesh that would take longer than the time left, by
/// those before, is not tried. Without a stop the error is that of where the tip is over the run,
/// as a part of the bar's length.
ChosenMesh choose_mesh(const Rig& rig, const Solver& solver, int finest);

/// A number of elements split at the struck point, at least one on either side that is not empty.
std::array<int, 2> split_elements(int total, const Rig& rig);

}  // namespace impactrig::models
