// SPDX-License-Identifier: BSD-3-Clause
#include "models/rig.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "models/beams/bar_element.hpp"
#include "models/contact/damping_law.hpp"
#include "models/contact/elastic_law.hpp"
#include "models/rigid_swing.hpp"
#include "models/spring_bending.hpp"

namespace impactrig::models {
namespace {

[[noreturn]] void refuse(std::string_view key, const std::string& problem) {
  throw std::invalid_argument(fmt::format("{}: {}", key, problem));
}

void require_positive(std::string_view key, double value, std::string_view unit) {
  const std::string_view space = unit.empty() ? "" : " ";
  if (!(value > 0.0))
    refuse(key, fmt::format("must be greater than zero, found {:g}{}{}", value, space, unit));
  if (!std::isfinite(value))
    refuse(key, fmt::format("must be finite, found {:g}{}{}", value, space, unit));
}

void require_not_negative(std::string_view key, double value, std::string_view unit) {
  if (!(value >= 0.0 && std::isfinite(value)))
    refuse(key, fmt::format("must be finite and not negative, found {:g} {}", value, unit));
}

void require_poisson_ratio(std::string_view key, double nu) {
  if (!(nu > -1.0 && nu <= 0.5))
    refuse(key, fmt::format("must lie between -1 and 0.5, found {:g}", nu));
}

void validate_section(const std::string& where, double area, double second_moment,
                      double shear_coefficient, bool shears) {
  require_positive(where + ".section (area)", area, "m^2");
  require_positive(where + ".section (second moment)", second_moment, "m^4");
  if (shears) require_positive(where + ".shear_coefficient", shear_coefficient, "");
}

void validate_segments(const Beam& beam) {
  double length = 0.0;
  for (std::size_t i = 0; i < beam.segments.size(); ++i) {
    const BeamSegment& segment = beam.segments[i];
    const std::string key = fmt::format("beam.segments.{}", i + 1);
    require_positive(key + ".length", segment.length, "m");
    validate_section(key, segment.area, segment.second_moment, segment.shear_coefficient,
                     beam.shears());
    if (segment.youngs_modulus)
      require_positive(key + ".youngs_modulus", *segment.youngs_modulus, "Pa");
    if (segment.density) require_positive(key + ".density", *segment.density, "kg/m^3");
    length += segment.length;
  }
  if (!(std::abs(length - beam.length) <= 1e-12 * length))
    refuse("beam.length", fmt::format("the bar is {:g} m long, its segments are together {:g} m",
                                      beam.length, length));
}

void validate_beam(const Beam& beam) {
  require_positive("beam.length", beam.length, "m");
  require_positive("beam.youngs_modulus", beam.youngs_modulus, "Pa");
  require_positive("beam.density", beam.density, "kg/m^3");
  if (beam.segments.empty())
    validate_section("beam", beam.area, beam.second_moment, beam.shear_coefficient, beam.shears());
  else
    validate_segments(beam);
  require_not_negative("beam.damping.mass", beam.damping.mass, "1/s");
  require_not_negative("beam.damping.stiffness", beam.damping.stiffness, "s");
  require_poisson_ratio("beam.poisson_ratio", beam.poisson_ratio);
  for (std::size_t i = 0; i < beam.masses.size(); ++i) {
    const LumpedMass& lump = beam.masses[i];
    const std::string key = fmt::format("beam.masses.{}", i + 1);
    require_positive(key + ".mass", lump.mass, "kg");
    require_positive(key + ".position", lump.position, "m");
    if (lump.position > beam.length)
      refuse(key + ".position",
             fmt::format("the mass, {:g} m from the hinge, lies beyond the bar's end at {:g} m",
                         lump.position, beam.length));
  }
}

void validate_damping(const Contact& contact) {
  const DampingLawText& damping = damping_law(contact.damping).text;
  if (contact.restitution < damping.smallest_restitution)
    refuse("contact.restitution",
           fmt::format("{:g} needs more damping than the law '{}' can give; use {:g} or more",
                       contact.restitution, damping.name, damping.smallest_restitution));
  if (contact.restitution_speed)
    require_positive("contact.restitution_speed", *contact.restitution_speed, "m/s");
  if (contact.effective_mass)
    require_positive("contact.effective_mass", *contact.effective_mass, "kg");
  if (contact.viscous) require_not_negative("contact.viscous", *contact.viscous, "N s/m");
  if (contact.relaxation_time)
    require_not_negative("contact.relaxation_time", *contact.relaxation_time, "s");
}

void validate_moduli(const Contact& contact) {
  require_positive("contact.modulus", contact.modulus, "Pa");
  require_positive("contact.counter_modulus", contact.counter_modulus, "Pa");
  for (const auto& [key, nu] :
       {std::pair{"contact.poisson_ratio", contact.poisson_ratio},
        std::pair{"contact.counter_poisson_ratio", contact.counter_poisson_ratio}})
    require_poisson_ratio(key, nu);
}

void validate_radii(const Contact& contact) {
  require_positive("contact.radius", contact.radius, "m");
  require_not_negative("contact.counterface.depth", contact.counter_depth, "m");
  if (contact.reference_length)
    require_positive("contact.reference_length", *contact.reference_length, "m");
  if (contact.exponent != 1 && contact.exponent != 3)
    refuse("contact.exponent",
           fmt::format("must be 1 (as the paper prints it) or 3 (consistent in units), found {}",
                       contact.exponent));
  if (contact.counterface == Counterface::plane) return;
  require_positive("contact.counterface.radius", contact.counter_radius, "m");
  if (contact.counterface == Counterface::groove && contact.counter_radius <= contact.radius)
    refuse("contact.counterface.radius",
           fmt::format(
               "a groove of radius {:g} m cannot take a bar of radius {:g} m; it must be wider",
               contact.counter_radius, contact.radius));
}

void validate_contact(const Contact& contact, const Beam& beam) {
  require_positive("contact.position", contact.position, "m");
  if (contact.position > beam.length)
    refuse(
        "contact.position",
        fmt::format("the struck point, {:g} m from the hinge, lies beyond the bar's end at {:g} m",
                    contact.position, beam.length));
  if (!(contact.restitution >= 0.0 && contact.restitution <= 1.0))
    refuse("contact.restitution",
           fmt::format("must lie between 0 and 1, found {:g}", contact.restitution));
  validate_damping(contact);
  require_positive("contact.stiffness_factor", contact.stiffness_factor, "");
  const LawNeeds& needs = elastic_law_entry(contact.law).text.needs;
  if (needs.stiffness)
    require_positive("contact.stiffness", contact.stiffness, needs.power ? "N/m^n" : "N/m");
  if (needs.power && !(contact.power >= 1.0 && contact.power <= 5.0))
    refuse("contact.stiffness",
           fmt::format(
               "the power of the penetration, in its unit, must lie between 1 and 5, found {:g}",
               contact.power));
  if (needs.length) require_positive("contact.length", contact.length, "m");
  if (needs.moduli || damping_law(contact.damping).text.form == DampingForm::hertzian)
    validate_moduli(contact);
  if (needs.radii || damping_law(contact.damping).text.form == DampingForm::hertzian)
    validate_radii(contact);
}

void validate_stop(const Stop& stop) {
  require_positive("stop.mass", stop.mass, "kg");
  require_positive("stop.stiffness", stop.stiffness, "N/m");
  require_not_negative("stop.viscous", stop.viscous, "N.s/m");
}

/// A turned hinge knows neither what else acts on it nor a stop.
void validate_rotation(const Rig& rig) {
  const HingeRotation& rotation = *rig.hinge.rotation;
  if (!(rotation.rate != 0.0 && std::isfinite(rotation.rate)))
    refuse("hinge.rotation.rate",
           fmt::format("must be finite and not zero, found {:g} rad/s", rotation.rate));
  require_not_negative("hinge.rotation.time", rotation.time, "s");
  for (const auto& [key, value] :
       {std::pair{"hinge.spring", rig.hinge.spring}, std::pair{"hinge.viscous", rig.hinge.viscous},
        std::pair{"hinge.friction", rig.hinge.friction}})
    if (value > 0.0)
      refuse(key, "changes nothing where hinge.rotation states how the hinge turns; leave it out");
  if (rig.has_stop())
    refuse("hinge.rotation",
           "a hinge that is turned as stated would press the bar against the stop without limit; "
           "leave [contact] out");
  if (rig.start.velocity != 0.0)
    refuse("start.velocity", "hinge.rotation states how the bar starts; leave it out");
}

/// Largest distance of a place on the bar, on its way to the touch, from where it is there [m].
double way_to_touch(double position, double release_angle) {
  return position * std::sin(std::min(release_angle, 0.5 * std::numbers::pi));
}

void validate_further_stops(const Rig& rig) {
  for (std::size_t i = 0; i < rig.further_stops.size(); ++i) {
    const FurtherStop& stop = rig.further_stops[i];
    const std::string where = fmt::format("contacts.{}", i + 1);
    try {
      validate_contact(stop.contact, rig.beam);
      elastic_law(stop.contact);
    } catch (const std::invalid_argument& error) {
      const std::string_view said = error.what();  // of "contact"
      throw std::invalid_argument(where + std::string(said.substr(said.find('.'))));
    }
    require_not_negative(where + ".gap", stop.gap, "m");
    if (stop.side == StopSide::near || !rig.start.release_angle) continue;
    const double way = way_to_touch(stop.contact.position, *rig.start.release_angle);
    if (stop.gap <= way)
      refuse(where + ".gap",
             fmt::format("{:g} m on the far side: the bar is released from behind this stop, whose "
                         "gap must be more than {:g} m",
                         stop.gap, way));
  }
}

/// The bar swings freely: for how long, and whether it moves at all.
void validate_free(const Rig& rig, const Solver& solver) {
  if (!solver.duration)
    refuse("solver.duration", "is missing: without [contact] the bar swings for as long as stated");
  if (rig.stop) refuse("stop.mass", "there is no [contact] that could press on the stop");
  if (!rig.further_stops.empty())
    refuse("contacts", "there is no [contact] besides; state the stop that is struck first there");
  if (rig.start.release_angle && !rig.hinge.rotation &&
      !(RigidSwing(rig).available(-*rig.start.release_angle) > 0.0))
    refuse("start.release_angle", "neither weight nor spring would move the bar from there");
}

void validate_solver(const Solver& solver, const Rig& rig) {
  if (!(solver.accuracy >= Solver::finest_accuracy && solver.accuracy <= Solver::coarsest_accuracy))
    refuse("solver.accuracy",
           fmt::format("must lie between 1e-13 and 0.1, found {:g}", solver.accuracy));
  if (solver.duration) require_positive("solver.duration", *solver.duration, "s");
  require_positive("solver.time_limit", solver.time_limit, "s");
  if (solver.model == BeamModel::ancf) {
    const std::array<int, 2> fewest = fewest_elements(rig.beam, rig.contact.position);
    const bool at_tip = fewest[1] == 0;
    if (solver.elements[0] < 1 || solver.elements[1] < (at_tip ? 0 : 1) ||
        solver.elements[0] > 4096 || solver.elements[1] > 4096 - solver.elements[0])
      refuse(
          "solver.elements",
          fmt::format(
              "needs at least one element on each side of the struck point and 4096 in all, found "
              "[{}, {}]",
              solver.elements[0], solver.elements[1]));
    if (solver.elements[0] < fewest[0] || solver.elements[1] < fewest[1])
      refuse("solver.elements",
             fmt::format("elements end where the bar changes: hinge to struck point needs at least "
                         "{}, struck point to tip {}, found [{}, {}]",
                         fewest[0], fewest[1], solver.elements[0], solver.elements[1]));
    if (at_tip && solver.elements[1] != 0)
      refuse("solver.elements",
             fmt::format("the struck point is the bar's tip: the second number must be 0, found {}",
                         solver.elements[1]));
  }
  constexpr int most = 2 * Solver::most_modes;  // to tell the error of as many
  if (solver.model == BeamModel::hybrid && !(solver.modes >= 1 && solver.modes <= most))
    refuse("solver.modes", fmt::format("must lie between 1 and {}, found {}", most, solver.modes));
  if (solver.model == BeamModel::hybrid && solver.axial_modes > 0 && !rig.beam.segments.empty())
    refuse("solver.axial_modes",
           fmt::format("axial shapes are those of a uniform bar, this one has segments: must be 0, "
                       "found {}; ANCF elements stretch",
                       solver.axial_modes));
  if (solver.model == BeamModel::hybrid && !(solver.axial_modes >= 0 && solver.axial_modes <= most))
    refuse("solver.axial_modes",
           fmt::format("must lie between 0 and {}, found {}", most, solver.axial_modes));
}

}  // namespace

std::string_view name(BeamModel model) {
  switch (model) {
    case BeamModel::rigid:
      return "rigid";
    case BeamModel::hybrid:
      return "hybrid";
    case BeamModel::ancf:
      return "ancf";
  }
  throw std::logic_error("name: beam model out of range");
}

std::string_view name(BeamTheory theory) {
  return theory == BeamTheory::timoshenko ? "timoshenko" : "euler-bernoulli";
}

std::string_view name(StopSide side) {
  return side == StopSide::near ? "near" : "far";
}

std::string_view name(Basis basis) {
  return basis == Basis::cantilever ? "cantilever" : "pinned-free";
}

double HingeRotation::angle_at(double t) const {
  if (t >= time) return rate * (t - 0.5 * time);
  // cos x − 1 without cancelling
  const double turn = std::numbers::pi / time;
  const double wave = std::sin(turn * t) / turn;
  return 0.5 * rate / time * (t * t - wave * wave);
}

double HingeRotation::rate_at(double t) const {
  if (t >= time) return rate;
  const double turn = 2.0 * std::numbers::pi / time;
  return rate / time * (t - std::sin(turn * t) / turn);
}

double HingeRotation::acceleration_at(double t) const {
  if (t >= time) return 0.0;
  const double wave = std::sin(std::numbers::pi * t / time);
  return 2.0 * rate / time * wave * wave;
}

double Beam::bar_mass() const {
  double sum = 0.0;
  for_each_piece(*this, [&](const BarElement& piece) { sum += piece.line_density * piece.length; });
  return sum;
}

double Beam::total_mass() const {
  double sum = bar_mass();
  for (const LumpedMass& lump : masses) sum += lump.mass;
  return sum;
}

double Beam::first_moment() const {
  double sum = 0.0;
  for_each_piece(*this, [&](const BarElement& piece) {
    sum += piece.line_density * piece.length * (piece.x + 0.5 * piece.length);
  });
  for (const LumpedMass& lump : masses) sum += lump.mass * lump.position;
  return sum;
}

double Beam::hinge_inertia() const {
  double sum = 0.0;
  for_each_piece(*this, [&](const BarElement& piece) {
    const double end = piece.x + piece.length;
    const double square = (piece.x * piece.x + piece.x * end + end * end) / 3.0;
    sum += (piece.line_density * square + piece.rotary_inertia) * piece.length;
  });
  for (const LumpedMass& lump : masses) sum += lump.mass * lump.position * lump.position;
  return sum;
}

double Rig::effective_mass(int number) const {
  const double arm = contact_of(number).position;
  return beam.hinge_inertia() / (arm * arm);
}

const Contact& Rig::contact_of(int number) const {
  return number == 0 ? contact : further_stops[static_cast<std::size_t>(number - 1)].contact;
}

namespace {

/// Neither 90 nor 180 degrees is a number of radians.
double part_of_gravity(double gravity, double part) {
  return std::abs(part) < 1e-15 ? 0.0 : gravity * part;
}

}  // namespace

double Rig::gravity_along() const {
  return part_of_gravity(gravity, std::cos(gravity_direction));
}

double Rig::gravity_across() const {
  return part_of_gravity(gravity, std::sin(gravity_direction));
}

bool damped(const Rig& rig) {
  return rig.hinge.viscous > 0.0 || rig.hinge.friction > 0.0 || rig.beam.damping != BarDamping{};
}

double spring_bending(const Rig& rig) {
  // energy of the bending by the spring's moment, ∫ M² (1 − x / L)² / (2 EI) dx, over that of the
  // spring
  double flexibility = 0.0;
  for_each_piece(rig.beam, [&](const BarElement& piece) {
    const double from = 1.0 - piece.x / rig.beam.length;
    const double to = from - piece.length / rig.beam.length;
    flexibility +=
        piece.length * (from * from + from * to + to * to) / (3.0 * piece.bending_stiffness);
  });
  return rig.hinge.spring * flexibility;
}

bool spring_bends_bar(const Rig& rig) {
  return spring_bending(rig) > 0.01;
}

std::string beyond_small_motion(const Rig& rig) {
  std::vector<std::string_view> keys;
  if (!rig.has_stop() && rig.beam.damping != BarDamping{})
    keys.push_back("beam.damping without a stop");
  if (!rig.has_stop() && rig.hinge.viscous > 0.0) keys.push_back("hinge.viscous without a stop");
  if (rig.gravity_along() < 0.0)
    keys.push_back("environment.gravity_direction beyond 90 degrees");
  else if (!rig.has_stop() && rig.gravity_across() != 0.0)
    keys.push_back("environment.gravity_direction without a stop");
  if (!rig.has_stop() && rig.hinge.spring > 0.0) keys.push_back("hinge.spring without a stop");
  if (!rig.has_stop() && rig.hinge.friction > 0.0) keys.push_back("hinge.friction without a stop");
  if (rig.hinge.rotation) keys.push_back("hinge.rotation");
  return fmt::format("{}", fmt::join(keys, ", "));
}

namespace {

double in_degrees(double angle) {
  return angle * 180.0 / std::numbers::pi;
}

}  // namespace

double touch_velocity(const Rig& rig) {
  if (!rig.start.release_angle) return rig.start.velocity;
  const auto rate = RigidSwing(rig).rate_after_release(*rig.start.release_angle);
  if (!rate)
    refuse("start.release_angle",
           fmt::format("released at {:.6g} degrees the bar does not swing against the stop: weight "
                       "and hinge.spring do not turn it there, hinge.friction holds it, or damping "
                       "stops it on the way; environment.gravity_direction says where down is",
                       in_degrees(*rig.start.release_angle)));
  return rig.contact.position * *rate;
}

void validate(const Rig& rig, const Solver& solver) {
  validate_beam(rig.beam);
  if (rig.has_stop()) {
    validate_contact(rig.contact, rig.beam);
    elastic_law(rig.contact);
    validate_further_stops(rig);
  }
  require_not_negative("hinge.spring", rig.hinge.spring, "N.m/rad");
  require_not_negative("hinge.viscous", rig.hinge.viscous, "N.m.s/rad");
  require_not_negative("hinge.friction", rig.hinge.friction, "N.m");
  if (rig.stop) validate_stop(*rig.stop);
  if (!(rig.gravity >= 0.0 && std::isfinite(rig.gravity)))
    refuse("environment.gravity",
           fmt::format("must be finite and not negative, found {:g} m/s^2", rig.gravity));
  if (!(std::abs(rig.gravity_direction) < std::numbers::pi * (1.0 + 1e-12)))
    refuse("environment.gravity_direction",
           fmt::format("must lie between -180 and 180 degrees, found {:.6g} degrees",
                       in_degrees(rig.gravity_direction)));
  if (rig.hinge.rotation) {
    validate_rotation(rig);
  } else if (rig.start.release_angle) {
    if (!(*rig.start.release_angle > 0.0 && *rig.start.release_angle < 3.14159265358979))
      refuse("start.release_angle",
             fmt::format("must lie between 0 and 180 degrees, found {:.6g} degrees",
                         in_degrees(*rig.start.release_angle)));
    if (!(rig.gravity > 0.0 || rig.hinge.spring > 0.0))
      refuse("start.release_angle",
             "a release needs gravity or a spring; environment.gravity is zero and so is "
             "hinge.spring");
    if (rig.has_stop()) touch_velocity(rig);
  } else {
    require_positive("start.velocity", rig.start.velocity, "m/s");
  }
  validate_solver(solver, rig);
  if (!rig.has_stop()) validate_free(rig, solver);
}

}  // namespace impactrig::models
