// SPDX-License-Identifier: BSD-3-Clause
#include "models/sensitivities/derivative_refusal.hpp"

#include "models/contact/contact_force.hpp"

namespace impactrig::models {
namespace {

/// Of a bar of segments.
std::string refusal_of_segments(const Beam& beam, const double* number) {
  if (beam.segments.empty()) return {};
  for (const double* own : {&beam.length, &beam.area, &beam.second_moment, &beam.shear_coefficient})
    if (number == own) return "beam.segments state it, of each segment";
  return {};
}

}  // namespace

std::string derivative_refusal(const Rig& rig, RigParameter parameter) {
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
  const bool at_tip = rig.has_stop() && rig.contact.position == rig.beam.length;
  if (at_tip && (number == &copy.beam.length || number == &copy.contact.position))
    return "the bar is struck at its tip, and cannot be struck beyond it: only one side exists";
  return refusal_of_segments(copy.beam, number);
}

}  // namespace impactrig::models
