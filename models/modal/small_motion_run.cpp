// SPDX-License-Identifier: BSD-3-Clause
#include "models/modal/small_motion_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "models/beams/bar_element.hpp"
#include "models/contact/contact_force.hpp"
#include "models/contact_log.hpp"
#include "models/free_run.hpp"
#include "models/modal/modal_flight.hpp"

namespace impactrig::models {
namespace {

// Beyond, all modes cost more than they save: their work and their memory grow with the square of
// their number.
constexpr int most_modes = 520;
// Of what terms of third order change, as ThirdOrder has it, and of what shortening moves. That is
// right to a few per cent in half of the scenes tried. With this safety 684 random scenes of
// laboratories err by 0.91 of what is told and less, and six of some 700 absurd ones by more, up to
// 1.8 times; before a stop that gives way, whose head it does not know, without it by 5.5 times.
constexpr double safety = 3.0, safety_of_giving_stop = 6.0, share_of_shortening = 0.1;
// Of the strain that hangs and turns the bar: most of that is known too, and 0.13 times it was
// left. A bar that shears shears as well in its stretched length, which is not known: 17 random
// scenes err by 0.9 of the strain and less, one whose bar leaves at an eighth of its approach by 2.
// The pieces of a stepped bar are stretched by different parts: of 49 random ones five err by 1 to
// 3 times the largest strain, one, whose strain is 0.003, by 4.
constexpr double share_of_strain = 0.5, share_of_uneven_strain = 3.0;
// Last bits of where a load holds the modes, which add up over the steps.
constexpr double roundings_of_load = 16.0;
// Without it what vibration is said to change was 0.75 times to hundreds of times what it changed.
constexpr double safety_of_vibration = 2.0;
// Of the accuracy. Energy of fourth order that is such a part of all moves forces by some four
// times that, and is far from its bound, which has one element bend.
constexpr double negligible_part = 1e-2;

bool stretches(const Solver& solver) {
  return solver.model == BeamModel::ancf ||
         (solver.model == BeamModel::hybrid && solver.axial_modes > 0);
}

/// Of its sections, along their axis [1/N].
struct Flexibility {
  double least = std::numeric_limits<double>::infinity(), largest = 0.0;

  explicit Flexibility(const Beam& beam) {
    for (const BarElement& piece : bar_pieces(beam)) {
      least = std::min(least, 1.0 / piece.axial_stiffness);
      largest = std::max(largest, 1.0 / piece.axial_stiffness);
    }
  }

  bool is_uneven() const { return largest > (1.0 + 1e-6) * least; }
};

/// Largest strain of a bar that can stretch, by its weight and its turning at this rate [-]. Small
/// motion has it as it is made.
double steady_strain(const Rig& rig, const Solver& solver, double rate) {
  if (!stretches(solver)) return 0.0;
  const double pull = rig.gravity * rig.beam.total_mass() + rate * rate * rig.beam.first_moment();
  return pull * Flexibility(rig.beam).largest;
}

/// Small motion leaves friction in the hinge out: what it could change until the last contact ends,
/// as a part of the first one's impulse about the hinge.
double missing_friction(const Rig& rig, const Simulation& run) {
  if (rig.hinge.friction == 0.0 || run.episodes.empty()) return 0.0;
  const Episode& last = run.episodes.back();  // one that goes on has no end yet
  return rig.hinge.friction * std::max(last.start, last.end) /
         (rig.contact.position * run.episodes.front().impulse);
}

/// What terms of third order would have changed in peak, duration and impulse of the first contact.
double missing_terms(const ThirdOrder& terms, const Simulation& run) {
  const double missing = std::max(std::abs(terms.of_peak()), std::abs(terms.of_impulse()));
  if (run.episodes.empty() || run.episodes.front().open) return missing;
  const Episode& first = run.episodes.front();
  const double way = first.separation_velocity * (first.end - first.start);
  return std::max(missing, std::abs(terms.displacement() / way));
}

/// The sensor of a stop that gives way may carry most in a later contact: a light head flies off at
/// first touch and meets the bar again. What is left out grows, until then, about with the square
/// of how far a rigid bar turns. One that bends is inclined by its waves, and what that leaves out
/// had grown with the fourth power of time where it was smallest at first.
double growth_until_sensor_peak(const SensorForce& sensor, const Simulation& run, bool bends) {
  if (run.episodes.size() < 2) return 1.0;
  if (sensor.peak_time <= run.episodes[1].start) return 1.0;
  const double later = sensor.peak_time / run.episodes.front().end;
  return std::max(1.0, std::pow(later, bends ? 4.0 : 2.0));
}

/// What bending by a spring's moment, and tension by the bar's weight that comes at once as it is
/// let go, do to a swing beyond small motion, as a part of its result. Of 219 random swings
/// (springs of 3 to 3000 N m/rad, slenderness 100 to 300, angles of 1e-4 to 0.06) the full
/// equations differed by no more in 213, by up to three times as much in five, and in one the bar
/// came back before it touched.
double left_out_of_bent_swing(const Rig& rig) {
  constexpr double of_bending = 0.05, of_tension = 0.01;
  double flexibility = 0.0, slenderness = 0.0;  // ∫ dx / EI, the largest L / r
  for_each_piece(rig.beam, [&](const BarElement& piece) {
    flexibility += piece.length / piece.bending_stiffness;
    slenderness = std::max(
        slenderness, rig.beam.length * std::sqrt(piece.axial_stiffness / piece.bending_stiffness));
  });
  const double bent = rig.hinge.spring * flexibility / (3.0 + rig.hinge.spring * flexibility);
  const double weight = rig.beam.total_mass() * rig.gravity * rig.beam.length * flexibility;
  return of_bending * std::pow(*rig.start.release_angle * slenderness, 2) * bent +
         of_tension * weight;
}

/// Of a swing's result, a part of it: of a pendulum's time and of the sine that bends the bar as it
/// is let go; of gravity from the side, which changes on the way; and, as these move the time of
/// touch, of the phases in which the vibration that letting go leaves in the bar arrives. An
/// elastic contact of such a time [s] feels of what is faster the way, not the speed.
double left_out_of_swing(const Rig& rig, const ModalBeam& modes, double contact) {
  const double angle = *rig.start.release_angle;
  const double speed = touch_velocity(rig), rate = speed / rig.contact.position;
  const double work = 0.5 * rig.beam.hinge_inertia() * rate * rate;
  const double of_side =
      rig.beam.first_moment() * std::abs(rig.gravity_across()) * std::pow(angle, 3) / (12.0 * work);
  // a spring's moment is in proportion to the angle
  const double weight = rig.beam.first_moment() * rig.gravity * angle;
  const double of_weight = weight / (weight + rig.hinge.spring * angle);
  const double of_time = angle * angle * of_weight / (spring_bends_bar(rig) ? 6.0 : 16.0) + of_side;
  const double late = of_time * 2.0 * angle / rate;  // [s]
  const Eigen::VectorXd off = modes.rigid() * -angle - ModalLoad(modes).held();
  double of_phases = 0.0;  // of so many modes they are not alike: the squares add
  for (Eigen::Index i = 1; i < modes.modes(); ++i) {
    const double omega = modes.omega()[i];
    const double felt = rig.contact.damping == "none" ? std::max(1.0, omega * contact) : 1.0;
    of_phases +=
        std::pow(omega * off[i] * modes.struck()[i] * std::min(1.0, omega * late) / felt, 2);
  }
  const double of_bending = spring_bends_bar(rig) ? left_out_of_bent_swing(rig) : 0.0;
  return of_time + of_bending + 2.0 * std::sqrt(of_phases) / speed;
}

}  // namespace

/// Of few modes steps are as long as the force's series allows: 8 nodes then need fewer of them at
/// most accuracies. With 40 modes and more the vibration ends them, whatever the nodes.
int nodes_of(const Solver& solver) {
  const bool few = solver.model == BeamModel::hybrid && solver.modes <= 30;
  return solver.accuracy > (few ? 3e-4 : 2e-7) ? 6 : 8;
}

int modes_of(const Solver& solver) {
  if (solver.model != BeamModel::ancf) return 1 + solver.modes;
  return 2 * (solver.elements[0] + solver.elements[1]) + 1;
}

std::string small_motion_refusal(const Rig& rig, const Solver& solver) {
  if (const std::string keys = beyond_small_motion(rig); !keys.empty())
    return fmt::format(
        "small motion was asked for, but it does not know {}; ask for the full equations", keys);
  if (modes_of(solver) <= most_modes) return {};
  return fmt::format(
      "small motion was asked for, but {} modes are too many to be computed; at most {}",
      modes_of(solver), most_modes);
}

bool may_leave_out_vibration(const Rig& rig, const Solver& solver,
                             const SimulationOptions& options) {
  const bool known = solver.model == BeamModel::ancf && rig.has_stop() &&
                     beyond_small_motion(rig).empty() && !follows_swing(rig, options);
  return known && allows(options, Simplification::fast_vibration) &&
         std::ranges::all_of(options.sensitivities, [&](RigParameter parameter) {
           return RigEffect(rig, parameter).keeps_bar();
         });
}

SmallMotionRun::SmallMotionRun(const Rig& rig, const Solver& solver,
                               const SimulationOptions& options,
                               std::shared_ptr<const ModalBar> bar)
    : rig_(rig),
      solver_(solver),
      options_(options),
      bar_(std::move(bar)),
      motion_(*bar_, Collocation::of(nodes_of(solver)), options.history),
      stopped_(rig.stop ? std::make_unique<StoppedMotion>(motion_, *rig.stop) : nullptr),
      run_(rig, solver, options, stopped_ ? static_cast<BarMotion&>(*stopped_) : motion_) {
  if (rig.stop || !options.sensitivities.empty() ||
      !allows(options, Simplification::flight_at_once))
    motion_.step_flights();
  motion_.judge_coarsely(negligible_part * solver.accuracy);
  motion_.judge_friction(rig.hinge.friction);
  if (!judges()) motion_.leave_judging();
  const bool follows = follows_swing(rig, options);
  if (rig.start.release_angle && !follows) {
    Arrival arrival = arrive(rig, bar_->modes());
    of_arrival_ = arrival.error;
    motion_.arrives(std::move(arrival));
  }
  if (options.sensitivities.empty() || follows || !contacts_end_smoothly(rig)) return;
  const auto known = [&](RigParameter parameter) {
    const RigEffect effect(rig, parameter, solver, options.history);
    return effect.has_slopes() && effect.small_motion_knows();
  };
  // of what small motion knows nothing: rather no slope than zero
  if (!std::ranges::all_of(options.sensitivities, known)) return;
  if (stopped_) stopped_->keep_responding();
  sensitivities_ =
      std::make_unique<ModalSensitivities>(rig, solver, options, motion_, stopped_.get());
  run_.follow(*sensitivities_);
}

bool SmallMotionRun::judges() const {
  return options_.judge_small_motion || options_.motion != Motion::small;
}

void SmallMotionRun::complete(const std::optional<Trial>& trial) {
  if (!trial) return run_.complete();
  Looks looks;
  run_.begin();
  while (!run_.done()) {
    run_.propose();
    run_.judge(run_.solve());
    if (looks.due() && trial->time.over() && !promises(trial->accuracy))
      throw std::runtime_error("small motion leaves out too much, or takes too long to tell");
  }
}

/// Whether what is known by now speaks for it.
bool SmallMotionRun::promises(double accuracy) const {
  const std::vector<Episode>& episodes = run_.so_far().episodes;
  return !episodes.empty() && !episodes.front().open && neglected(run_.so_far()) <= accuracy;
}

/// What small motion leaves out of a result; of vibration that a ReducedBar does not have, once
/// find_left_out() has looked for it.
double SmallMotionRun::neglected(const Simulation& result) const {
  const double part = neglected_of_forces(result);
  return may_end_otherwise(result, part) ? std::max(1.0, part) : part;
}

/// Whether the first contact may end at another time than it did: the bar has all but left before,
/// or came back at once, by less than what is left out moves it.
bool SmallMotionRun::may_end_otherwise(const Simulation& result, double part) const {
  if (result.episodes.empty() || result.episodes.front().open) return false;
  const Episode& first = result.episodes.front();
  const double of_terms = rig_.stop ? safety_of_giving_stop : safety;
  const double unsure =
      std::max(of_terms * motion_.third_order().most_displacement(), part * first.max_penetration);
  if (run_.shallowest_turn() < unsure) return true;
  const auto next = std::find_if(result.episodes.begin() + 1, result.episodes.end(),
                                 [](const Episode& episode) { return episode.stop == 0; });
  if (next == result.episodes.end()) return false;
  // as far as what leaves at that speed and is back by then has got
  return 0.25 * first.separation_velocity * (next->start - first.end) < unsure;
}

/// The same of forces and of a contact that is sure to end as it did.
double SmallMotionRun::neglected_of_forces(const Simulation& result) const {
  const double rate = touch_velocity(rig_) / rig_.contact.position;
  const ThirdOrder& terms = motion_.third_order();
  const bool sheared = solver_.model == BeamModel::ancf && rig_.beam.shears();
  const bool uneven = sheared || Flexibility(rig_.beam).is_uneven();
  const bool bends = bar_->modes().modes() > 1;
  const double growth =
      stopped_ ? growth_until_sensor_peak(stopped_->sensor(result.impulse), result, bends) : 1.0;
  return growth * ((rig_.stop ? safety_of_giving_stop : safety) * missing_terms(terms, result) +
                   share_of_shortening * terms.shortening()) +
         (uneven ? share_of_uneven_strain : share_of_strain) * steady_strain(rig_, solver_, rate) +
         bar_->modes().rounding() + rounding_of_load(result) + missing_friction(rig_, result) +
         of_swing(result) + left_out_;
}

/// What rounding may leave of the first contact: displacements are what the modes are off where a
/// steady load holds them, and where that is, which may be far more than the contact is deep.
double SmallMotionRun::rounding_of_load(const Simulation& result) const {
  const ModalLoad& load = motion_.load();
  if (!load.acts() || result.episodes.empty()) return 0.0;
  const double held = load.held().cwiseAbs().dot(bar_->modes().struck().cwiseAbs());
  return roundings_of_load * std::numeric_limits<double>::epsilon() * held /
         result.episodes.front().max_penetration;
}

/// What is left out of how the bar arrives.
double SmallMotionRun::of_swing(const Simulation& result) const {
  if (!follows_swing(rig_, options_)) return of_arrival_;
  const Episode& first = result.episodes.front();
  const double until = first.open ? result.duration : first.end;
  return left_out_of_swing(rig_, bar_->modes(), until - first.start);
}

Simulation SmallMotionRun::conclude() {
  Simulation result = conclude_untold();
  if (judges()) tell_taken(result);
  return result;
}

Simulation SmallMotionRun::conclude_untold() {
  Simulation result = run_.conclude();
  if (stopped_) result.sensor = stopped_->sensor(result.impulse);
  if (sensitivities_) result.sensitivities = sensitivities_->take_results();
  result.small_motion = true;
  if (bar_->is_reduced() && !result.episodes.empty()) find_left_out(result);
  if (!judges()) return result;
  result.neglected = neglected(result);
  result.taken.push_back(Simplification::small_motion);
  if (bar_->is_reduced()) result.taken.push_back(Simplification::fast_vibration);
  if (missing_friction(rig_, result) > 0.0) result.taken.push_back(Simplification::hinge_friction);
  if (motion_.flights().count > 0) result.taken.push_back(Simplification::flight_at_once);
  return result;
}

/// A sentence for each of what was taken, in that order.
void SmallMotionRun::tell_taken(Simulation& result) const {
  const bool damped = bar_->modes().damped();
  result.skipped.push_back(fmt::format(
      "foreshortening and large rotation{}: the bar was solved in its own modes; what this "
      "leaves out changes peak force, duration and impulse of the first contact{} by less than "
      "{:.1e}",
      damped ? ", and what damping couples modes by" : "",
      rig_.stop ? ", and the sensor's largest force," : "", result.neglected));
  if (bar_->is_reduced())
    result.skipped.push_back(fmt::format(
        "vibration too fast to matter: {} coordinates stand for the {} modes of the mesh, the slow "
        "ones as they are, the others as springs; what of their vibration is left out changes peak "
        "force, duration and impulse of the first contact by less than {:.1e}",
        bar_->modes().modes(), modes_of(solver_), left_out_));
  if (const double friction = missing_friction(rig_, result); friction > 0.0)
    result.skipped.push_back(fmt::format(
        "friction in the hinge from first touch on: over {:.3g} s its impulse is at most {:.1e} of "
        "the first contact's about the hinge",
        result.episodes.back().end, friction));
  const ModalMotion::Flights& flights = motion_.flights();
  if (flights.count > 0)
    result.skipped.push_back(fmt::format(
        "looks at the stop for {:.4g} s in {} flight{}: by gap, speed and largest acceleration the "
        "bar could not reach it; it was moved on in closed form, without error",
        flights.time, flights.count, flights.count == 1 ? "" : "s"));
}

/// Of coordinates that are slower than the modes they stand for, speeds with which these ring by
/// the force's growth at touch, as much as it has grown after a radian at once [m √kg/s]. The
/// others ring as they are seen to.
Eigen::VectorXd SmallMotionRun::rung_at_touch(int stop) const {
  const double speed = touch_velocity(rig_);
  const ContactForce contact(rig_, stop);
  const Eigen::Index own = bar_->own_modes();
  Eigen::VectorXd rung = Eigen::VectorXd::Zero(bar_->modes().modes());
  for (Eigen::Index i = 0; i < bar_->left_out().size(); ++i) {
    const double omega = std::sqrt(bar_->left_out()[i]), slowed = bar_->modes().omega()[own + i];
    if (slowed >= 0.999 * omega) continue;
    rung[own + i] = contact.force_of_impact(speed, speed / omega) *
                    std::abs(bar_->modes().struck(stop)[own + i]) * omega / (slowed * slowed);
  }
  return rung;
}

/// What of a force is damping's errs with the speed.
void SmallMotionRun::find_left_out(const Simulation& result) {
  const ModalMotion::LeftOut& left_out = motion_.left_out();
  const double speed = touch_velocity(rig_), depth = result.max_penetration;
  double of_speed = 0.0, at_stops = left_out.power / result.peak_force, shown = left_out.shown;
  for (int stop = 0; stop < rig_.stops(); ++stop) {
    const Eigen::VectorXd rung = rung_at_touch(stop);
    of_speed = std::max(of_speed, ContactForce(rig_, stop).damping_share(speed, depth));
    at_stops = std::max(at_stops, rung.dot(bar_->modes().struck(stop).cwiseAbs()));
    if (motion_.velocity_row().size() > 0)
      shown = std::max(shown, rung.dot(motion_.velocity_row().cwiseAbs()));
  }
  left_out_ = safety_of_vibration *
              std::max(left_out.displacement / depth + of_speed * at_stops / speed, shown / speed);
}

Simulation swing_freely(const Rig& rig, const Solver& solver, const SimulationOptions& options,
                        const ModalBar& bar) {
  ModalMotion motion(bar, Collocation::of(nodes_of(solver)), options.history);
  FreeRun run(rig, solver, options, motion);
  run.start();
  const double tip = ModalFlight(bar.modes(), motion.load(), motion.state())
                         .neglected(bar.modes().point(rig.beam.length), *solver.duration);
  Simulation result = run.fly();
  warn_of_imbalance(solver.accuracy, result);
  result.small_motion = true;
  result.neglected =
      tip / rig.beam.length + steady_strain(rig, solver, 0.0) + bar.modes().rounding();
  result.taken.push_back(Simplification::small_motion);
  result.skipped.push_back(fmt::format(
      "what a swing changes in the bar's vibration: it vibrates as if it hung, about the swing of "
      "a "
      "pendulum in closed form; displacements err by less than {:.1e} of the bar's length",
      result.neglected));
  return result;
}

void tell_swing(const Rig& rig, const SimulationOptions& options, Simulation& result) {
  if (!rig.has_stop() || !rig.start.release_angle || spring_bends_bar(rig)) return;
  if (!allows(options, Simplification::swing_to_touch)) return;
  const std::string vibration =
      result.solver.model == BeamModel::rigid
          ? ""
          : fmt::format("; the vibration that letting a straight bar go leaves in it is {}",
                        result.small_motion ? "that of its modes" : "less than the accuracy");
  result.taken.push_back(Simplification::swing_to_touch);
  result.skipped.push_back(fmt::format(
      "the swing from {:.4g} rad to first touch: the rigid bar's {} gives {:.6g} m/s at the "
      "struck point{}",
      *rig.start.release_angle, damped(rig) ? "damped swing" : "energy", touch_velocity(rig),
      vibration));
}

}  // namespace impactrig::models
