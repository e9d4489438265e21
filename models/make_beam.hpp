// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "models/beams/beam_dynamics.hpp"

namespace impactrig::models {

/// The bar of a rig as the solver's model has it.
std::unique_ptr<BeamDynamics> make_beam(const Rig& rig, const Solver& solver);

/// The same for small motion alone.
std::unique_ptr<SmallMotionBeam> make_small_motion_beam(const Rig& rig, const Solver& solver);

}  // namespace impactrig::models
