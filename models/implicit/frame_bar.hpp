// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "models/beams/floating_frame.hpp"
#include "models/simulation.hpp"

namespace impactrig::models {

/// A bar in a floating frame, and the points of it that a run looks at.
struct FrameBar {
  FrameBar(const Rig& rig, const Solver& solver, const HistoryRequest& history)
      : beam(solver.model == BeamModel::rigid
                 ? std::make_unique<FloatingFrameBeam>(rig, Basis::cantilever, 0, 0)
                 : std::make_unique<FloatingFrameBeam>(rig, solver.basis, solver.modes,
                                                       solver.axial_modes)),
        further(rig.further_stops),
        velocity_place(history.velocity_position > 0.0 ? history.velocity_position
                                                       : rig.contact.position),
        displacement_place(history.displacement_position > 0.0 ? history.displacement_position
                                                               : rig.contact.position),
        spot_slopes(history.spot_slopes) {}

  PointMotion before(int stop, ConstVector q, ConstVector v) const {
    if (stop == 0) return beam->struck_point(q, v);
    const FurtherStop& there = further[static_cast<std::size_t>(stop - 1)];
    const PointMotion p = beam->point(there.contact.position, q, v);
    return {there.direction() * p.displacement, there.direction() * p.velocity};
  }

  /// How far the point before a stop comes from a state, `way` on from there, towards the stop [m].
  double advance(int stop, ConstVector from, ConstVector way) const {
    if (stop == 0) return beam->struck_advance(from, way);
    const FurtherStop& there = further[static_cast<std::size_t>(stop - 1)];
    return there.direction() * beam->point_advance(there.contact.position, from, way);
  }

  std::unique_ptr<FloatingFrameBeam> beam;
  std::vector<FurtherStop> further;
  double velocity_place, displacement_place;  ///< from the hinge [m]
  bool spot_slopes;                           ///< as HistoryRequest has it
};

}  // namespace impactrig::models
