// SPDX-License-Identifier: BSD-3-Clause
#include "models/sensitivities/parameter_stencil.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "models/beams/assumed_modes.hpp"
#include "models/beams/bending_modes.hpp"
#include "models/contact/damping_law.hpp"
#include "models/sensitivities/element_layout.hpp"

namespace impactrig::models {
namespace {

// Of a parameter's size: truncation and rounding of the stencil are both below 1e-9.
constexpr double step = 3e-4;
// Of a bar with sections that turn: along a straight way through a turn of an angle a stencil of
// five places finds its pull wrong by the angle's fourth power.
constexpr double step_through_turns = 6e-5;
// Of shapes that come from a mesh rounding is 1e-12: below 1e-8 of a derivative, as truncation is.
constexpr double step_of_meshed_shapes = 2e-3;
// Of the bar's length, how far a gap may be changed that is none, and of critical damping or of the
// bar's stiffness, how far a damper or a spring.
constexpr double of_closed_gap = 1e-5, of_none = 1e-3;
// Of the way along the bar to a mass or of a segment: within it the bar bends several times.
constexpr double of_way = 0.25;

/// The contact of which the parameter is this number, or none.
const Contact* contact_with(const Rig& rig, const double* number, double Contact::*member) {
  for (int stop = 0; stop < rig.stops(); ++stop)
    if (const Contact& contact = rig.contact_of(stop); &(contact.*member) == number)
      return &contact;
  return nullptr;
}

/// Of what the rig may have none of: by what makes itself felt in the bar's slowest bending.
double size_of_none(Rig& rig, const double* number) {
  const double inertia = rig.beam.hinge_inertia();
  const double compliance = elastic_compliance(rig.beam, rig.contact.position);
  const double omega = 1.0 / std::sqrt(compliance * rig.effective_mass(0));
  if (number == &rig.beam.damping.mass) return of_none * omega;
  if (number == &rig.beam.damping.stiffness) return of_none / omega;
  if (number == &rig.hinge.viscous) return of_none * inertia * omega;
  if (number == &rig.hinge.spring) return of_none * inertia * omega * omega;
  if (rig.stop && number == &rig.stop->viscous)
    return of_none * std::sqrt(rig.stop->stiffness * rig.stop->mass);
  for (const FurtherStop& stop : rig.further_stops)
    if (number == &stop.gap) return of_closed_gap * rig.beam.length;
  return 0.0;
}

/// Whether it is where a mass sits, or how long a segment is.
bool places_part(const Beam& beam, const double* number) {
  return std::ranges::any_of(beam.masses,
                             [&](const LumpedMass& lump) { return number == &lump.position; }) ||
         std::ranges::any_of(beam.segments,
                             [&](const BeamSegment& segment) { return number == &segment.length; });
}

/// Of most its own size, of the direction of gravity a radian, for the radii of a groove the little
/// by which they differ, for places along the bar the way to the next, or a part of the way from
/// the hinge.
double size_of(Rig rig, RigParameter parameter) {
  const double* number = &parameter(rig);
  const double length = rig.beam.length;
  if (number == &rig.gravity_direction) return 1.0;
  const Contact* placed = contact_with(rig, number, &Contact::position);
  if (number == &rig.beam.length) placed = &rig.contact;
  if (placed && length > placed->position)
    return std::min(length - placed->position, placed->position);
  double size = (places_part(rig.beam, number) ? of_way : 1.0) * std::abs(*number);
  for (double Contact::*radius : {&Contact::radius, &Contact::counter_radius})
    if (const Contact* contact = contact_with(rig, number, radius))
      if (contact->counterface == Counterface::groove)
        size = std::abs(contact->counter_radius - contact->radius);
  size = std::max(size, size_of_none(rig, number));
  return size > 0.0 ? size : 1.0;
}

/// A restitution coefficient keeps to the range of its law.
Stencil stencil_for(Rig rig, RigParameter parameter, double spacing) {
  const Contact* contact = contact_with(rig, &parameter(rig), &Contact::restitution);
  if (!contact) return Stencil::centred();
  if (contact->restitution + 2.0 * spacing > 1.0) return Stencil::backward();
  const double smallest = damping_law(contact->damping).text.smallest_restitution;
  return contact->restitution - 2.0 * spacing < smallest ? Stencil::forward() : Stencil::centred();
}

/// Whether a place of the bar, or what it is made of, differs.
bool moves_elements(const Rig& one, const Rig& other) {
  for (int stop = 0; stop < one.stops(); ++stop)
    if (one.contact_of(stop).position != other.contact_of(stop).position) return true;
  return one.beam != other.beam;
}

double length_of_segments(const Beam& beam) {
  double sum = 0.0;
  for (const BeamSegment& segment : beam.segments) sum += segment.length;
  return sum;
}

double step_for(const Rig& rig) {
  return swings_far(rig) && rig.beam.shears() ? step_through_turns : step;
}

double step_for(const Rig& rig, const Solver& solver) {
  const bool meshed = solver.model == BeamModel::hybrid &&
                      !elements_of_shapes(rig.beam, solver.modes).empty() && !swings_far(rig);
  return meshed ? step_of_meshed_shapes : step_for(rig);
}

}  // namespace

bool swings_far(const Rig& rig) {
  return !rig.has_stop() || rig.start.release_angle;
}

ParameterStencil::ParameterStencil(const Rig& rig, RigParameter parameter)
    : rig_(rig),
      parameter_(parameter),
      size_(size_of(rig, parameter)),
      spacing_(step_for(rig) * size_),
      stencil_(stencil_for(rig, parameter, spacing_)) {}

ParameterStencil::ParameterStencil(const Rig& rig, RigParameter parameter, const Solver& solver,
                                   const HistoryRequest& history)
    : ParameterStencil(rig, parameter) {
  if (!moves_elements(rig, rig_beside())) return;
  const double part = step_for(rig, solver);
  spacing_ = std::min(part * size_, part * way_of_elements(solver, history));
  // An element's end that is passed farther off is left to a smaller spacing: 64 times smaller,
  // rounding is 3e-11.
  for (int times = 0; times < 3; ++times, spacing_ /= 8.0)
    for (const Stencil& stencil : {stencil_, Stencil::backward(), Stencil::forward()})
      if (fits(stencil, solver, history)) {
        stencil_ = stencil;
        return;
      }
  keeps_elements_ = false;
}

/// Over which an element changes, or what lies on one moves, by as much as it is long: its
/// stiffness goes by the third power of that.
double ParameterStencil::way_of_elements(const Solver& solver,
                                         const HistoryRequest& history) const {
  constexpr double little = 1e-6;
  const double part = little * size_ / spacing_;
  const double change = largest_change_of_elements(rig_, moved(part), solver, history);
  return change > 0.0 ? little * size_ / change : std::numeric_limits<double>::infinity();
}

bool ParameterStencil::fits(const Stencil& stencil, const Solver& solver,
                            const HistoryRequest& history) const {
  const ElementLayout here = ElementLayout::of(rig_, solver, history);
  return std::ranges::all_of(stencil.offsets, [&](double offset) {
    return ElementLayout::of(moved(offset), solver, history) == here;
  });
}

Rig ParameterStencil::moved(double offset) const {
  Rig there = rig_;
  parameter_(there) += offset * spacing_;
  there.beam.length += length_of_segments(there.beam) - length_of_segments(rig_.beam);
  const bool ends_at_tip = !rig_.has_stop() && rig_.contact.position == rig_.beam.length;
  if (ends_at_tip) there.contact.position = there.beam.length;
  return there;
}

}  // namespace impactrig::models
