// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fitting/rig_file.hpp"
#include "models/simulation.hpp"

namespace impactrig::fitting {

// Of a single run, and of a fit's, which are many: its intervals are widened by what is left.
inline constexpr int finest_mesh = 256, finest_mesh_of_fits = 64;

/// The mesh that was chosen where the rig file leaves it open; all empty where it does not.
struct MeshChoice {
  std::string sentence;  ///< which it is, and its error
  std::string warning;   ///< where it is not known to be as accurate as asked for
  std::optional<models::MeshError> difference;  ///< ChosenMesh::difference
};

/// Chooses the mesh for the accuracy asked for, up to so many elements.
MeshChoice choose_mesh(RigFile& file, int finest);

/// A sentence where a mesh that was not stated is coarser than the accuracy asked for, by the
/// result's mesh error, and where that was not looked at for so long as the sensor's largest force
/// needs.
std::vector<std::string> mesh_warnings(const RigFile& file, const models::Simulation& result);

}  // namespace impactrig::fitting
