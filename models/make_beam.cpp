// SPDX-License-Identifier: BSD-3-Clause
#include "models/make_beam.hpp"

#include <stdexcept>

#include "models/beams/ancf.hpp"
#include "models/beams/floating_frame.hpp"
#include "models/beams/linear_bar.hpp"
#include "models/beams/reissner_beam.hpp"

namespace impactrig::models {

std::unique_ptr<BeamDynamics> make_beam(const Rig& rig, const Solver& solver) {
  switch (solver.model) {
    case BeamModel::rigid:
      return std::make_unique<FloatingFrameBeam>(rig, Basis::cantilever, 0, 0);
    case BeamModel::hybrid:
      return std::make_unique<FloatingFrameBeam>(rig, solver.basis, solver.modes,
                                                 solver.axial_modes);
    case BeamModel::ancf:
      if (rig.beam.shears()) return std::make_unique<ReissnerBeam>(rig, solver.elements);
      return std::make_unique<AncfBeam>(rig, solver.elements);
  }
  throw std::logic_error("make_beam: beam model out of range");
}

std::unique_ptr<SmallMotionBeam> make_small_motion_beam(const Rig& rig, const Solver& solver) {
  if (solver.model == BeamModel::ancf)
    return std::make_unique<LinearBar>(
        rig, bar_elements(rig.beam, rig.contact.position, solver.elements),
        LinearBar::negligible_weight_at(solver.accuracy));
  return make_beam(rig, solver);
}

}  // namespace impactrig::models
