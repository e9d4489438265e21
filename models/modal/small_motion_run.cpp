// SPDX-License-Identifier: BSD-3-Clause
#include "models/modal/small_motion_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "models/beams/bar_element.hpp"
#include "models/free_run.hpp"
#include "models/modal/modal_flight.hpp"

namespace impactrig::models {
namespace {

// Beyond, computing all modes costs more than it saves: the work grows with the cube of their
// number.
constexpr int most_modes = 260;
// The first contact of small motion errs at most by what ModalMotion::neglected() says, and by
// twice the share of the missing tension (150 random scenes against the full equations); twice that
// for safety.
constexpr double safety = 2.0, safety_of_tension = 4.0;

bool stretches(const Solver& solver) {
  return solver.model == BeamModel::ancf ||
         (solver.model == BeamModel::hybrid && solver.axial_modes > 0);
}

/// Of the whole bar, along its axis [m/N].
double flexibility(const Beam& beam) {
  double sum = 0.0;
  for (const BarElement& piece : bar_pieces(beam)) sum += piece.length / piece.axial_stiffness;
  return sum;
}

double whole_mass(const Beam& beam) {
  double sum = beam.bar_mass();
  for (const LumpedMass& lump : beam.masses) sum += lump.mass;
  return sum;
}

/// A bar that can stretch begins without tension; until its first axial vibration is over the
/// weight does not turn it back as small motion has it. As a part of the energy.
double missing_tension(const Rig& rig, const Solver& solver, double end_of_contact) {
  if (!stretches(solver)) return 0.0;
  // its period at most, by Dunkerley's formula
  const Beam& beam = rig.beam;
  // the whole bar's flexibility, with as much of it at its end as is enough
  const double all = flexibility(beam);
  const bool uniform = beam.segments.empty();
  double square = (uniform ? 4.0 / std::pow(std::numbers::pi, 2) : 1.0) * beam.bar_mass() * all;
  for (const LumpedMass& lump : beam.masses)
    square += lump.mass * all * (uniform ? lump.position / beam.length : 1.0);
  const double period = 2.0 * std::numbers::pi * std::sqrt(square);
  const double time = std::min(end_of_contact, period);
  return 0.5 * rig.gravity * beam.first_moment() / beam.hinge_inertia() * time * time;
}

int nodes_for(double accuracy) {
  return accuracy > 2e-7 ? 6 : 8;
}

}  // namespace

std::string small_motion_refusal(const Rig& rig, const Solver& solver) {
  if (const std::string keys = beyond_small_motion(rig); !keys.empty())
    return fmt::format(
        "small motion was asked for, but it does not know {}; ask for the full equations", keys);
  const int modes = solver.model == BeamModel::ancf
                        ? 2 * (solver.elements[0] + solver.elements[1]) + 1
                        : 1 + solver.modes;
  if (modes <= most_modes) return {};
  return fmt::format(
      "small motion was asked for, but {} modes are too many to be computed; at most {}", modes,
      most_modes);
}

SmallMotionRun::SmallMotionRun(const Rig& rig, const Solver& solver,
                               const SimulationOptions& options,
                               std::shared_ptr<const ModalBar> bar)
    : rig_(rig),
      solver_(solver),
      bar_(std::move(bar)),
      motion_(*bar_, Collocation::of(nodes_for(solver.accuracy)), options.history),
      stopped_(rig.stop ? std::make_unique<StoppedMotion>(motion_, *rig.stop) : nullptr),
      run_(rig, solver, options, stopped_ ? static_cast<BarMotion&>(*stopped_) : motion_) {
  if (rig.stop || !options.sensitivities.empty()) motion_.step_flights();
  const bool begins_at_touch = !rig.start.release_angle || !spring_bends_bar(rig);
  if (options.sensitivities.empty() || !begins_at_touch || !faces_single_rigid_stop()) return;
  sensitivities_ = std::make_unique<ModalSensitivities>(rig, solver, options, motion_);
  run_.follow(*sensitivities_);
}

Simulation SmallMotionRun::conclude() {
  Simulation result = run_.conclude();
  if (stopped_) result.sensor = stopped_->sensor(result.impulse);
  if (sensitivities_) result.sensitivities = sensitivities_->take_results();
  result.small_motion = true;
  const double end_of_contact = result.episodes.empty() ? 0.0 : result.episodes.back().end;
  result.neglected = safety * motion_.neglected() +
                     safety_of_tension * missing_tension(rig_, solver_, end_of_contact);
  result.skipped.push_back(fmt::format(
      "foreshortening and large rotation: the bar was solved in its own modes; the energy this "
      "leaves out is {:.1e} of the whole, peak force, duration and impulse err by no more",
      result.neglected));
  return result;
}

Simulation swing_freely(const Rig& rig, const Solver& solver, const SimulationOptions& options,
                        const ModalBar& bar) {
  ModalMotion motion(bar, Collocation::of(nodes_for(solver.accuracy)), options.history);
  FreeRun run(rig, solver, options, motion);
  run.start();
  const double tip = ModalFlight(bar.modes(), motion.state())
                         .neglected(bar.modes().point(rig.beam.length), *solver.duration);
  // a bar that can stretch begins without tension
  const double stretch =
      stretches(solver) ? rig.gravity * whole_mass(rig.beam) * flexibility(rig.beam) : 0.0;
  Simulation result = run.fly();
  result.small_motion = true;
  result.neglected = (tip + stretch) / rig.beam.length;
  result.skipped.push_back(fmt::format(
      "what a swing changes in the bar's vibration: it vibrates as if it hung, about the swing of "
      "a "
      "pendulum in closed form; displacements err by less than {:.1e} of the bar's length",
      result.neglected));
  return result;
}

void tell_swing(const Rig& rig, const SimulationOptions& options, Simulation& result) {
  if (!rig.has_stop() || !rig.start.release_angle || options.exact || spring_bends_bar(rig)) return;
  result.skipped.push_back(fmt::format(
      "the swing from {:.4g} rad to first touch: the rigid bar's {} gives {:.6g} m/s at the "
      "struck point; a swing this slow hardly bends the bar",
      *rig.start.release_angle, damped(rig) ? "damped swing" : "energy", touch_velocity(rig)));
}

}  // namespace impactrig::models
