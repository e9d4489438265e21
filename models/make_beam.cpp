// SPDX-License-Identifier: BSD-3-Clause
#include "models/make_beam.hpp"

#include <stdexcept>

#include "models/beams/ancf.hpp"
#include "models/beams/floating_frame.hpp"

namespace impactrig::models {

std::unique_ptr<BeamDynamics> make_beam(const Rig& rig, const Solver& solver) {
  switch (solver.model) {
    case BeamModel::rigid:
      return std::make_unique<FloatingFrameBeam>(rig, Basis::cantilever, 0, 0);
    case BeamModel::hybrid:
      return std::make_unique<FloatingFrameBeam>(rig, solver.basis, solver.modes,
                                                 solver.axial_modes);
    case BeamModel::ancf:
      return std::make_unique<AncfBeam>(rig, solver.elements);
  }
  throw std::logic_error("make_beam: beam model out of range");
}

}  // namespace impactrig::models
