// SPDX-License-Identifier: BSD-3-Clause
#include "models/sensitivities/derivative_refusal.hpp"

#include <algorithm>

#include "models/contact/contact_force.hpp"
#include "models/sensitivities/parameter_stencil.hpp"
#include "models/sensitivities/rig_effect.hpp"

namespace impactrig::models {
namespace {

/// Of a bar of segments.
std::string refusal_of_segments(const Beam& beam, const double* number) {
  if (beam.segments.empty()) return {};
  for (const double* own : {&beam.length, &beam.area, &beam.second_moment, &beam.shear_coefficient})
    if (number == own) return "beam.segments state it, of each segment";
  return {};
}

bool moves_tip(const Beam& beam, const double* number) {
  return number == &beam.length ||
         std::ranges::any_of(beam.segments,
                             [&](const BeamSegment& segment) { return number == &segment.length; });
}

}  // namespace

std::string derivative_refusal(const Rig& rig, const Solver& solver, RigParameter parameter) {
  Rig copy = rig;
  const double* number = &parameter(copy);
  if (!contacts_end_smoothly(rig))
    return "with this damping law and contact.tension = \"allow\" the slope of the contact's force "
           "grows without limit where the gap opens, and no derivative converges there; take "
           "contact.tension = \"clip\" or another contact.damping";
  if (number == &copy.hinge.friction && *number == 0.0)
    return "there is no friction, and the least of it changes how the hinge moves: only one side "
           "exists; state a hinge.friction";
  if (copy.hinge.rotation && number == &copy.hinge.rotation->time && *number == 0.0)
    return "without a time the hinge turns from the beginning, with any it starts from rest; state "
           "a hinge.rotation.time";
  for (int stop = 0; stop < copy.stops(); ++stop)
    if (const double& depth = copy.contact_of(stop).counter_depth; number == &depth && depth == 0.0)
      return "without a depth the plane's counterface has none down to what holds it; state a "
             "counterface.depth";
  const bool at_tip = rig.has_stop() && rig.contact.position == rig.beam.length;
  if (at_tip && (moves_tip(copy.beam, number) || number == &copy.contact.position))
    return "the bar is struck at its tip, and cannot be struck beyond it: only one side exists";
  if (std::string why = refusal_of_segments(copy.beam, number); !why.empty()) return why;
  if (ParameterStencil(rig, parameter, solver, {}).keeps_elements()) return {};
  return "beside it the bar would be divided into its elements in another way, as where it is "
         "struck at a step of its section: only one side exists; state another place or other "
         "elements";
}

std::string small_motion_derivative_refusal(const Rig& rig, RigParameter parameter) {
  if (RigEffect(rig, parameter).small_motion_knows()) return {};
  return "small motion does not know what it changes; the full equations do";
}

}  // namespace impactrig::models
