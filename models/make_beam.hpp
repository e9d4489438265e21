// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "models/beams/beam_dynamics.hpp"

namespace impactrig::models {

/// The bar of a rig as the solver's model has it. Throws std::invalid_argument for ANCF elements
/// that should shear.
std::unique_ptr<BeamDynamics> make_beam(const Rig& rig, const Solver& solver);

/// The same for small motion alone, which elements that shear have too.
std::unique_ptr<SmallMotionBeam> make_small_motion_beam(const Rig& rig, const Solver& solver);

}  // namespace impactrig::models
