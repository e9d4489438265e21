// SPDX-License-Identifier: BSD-3-Clause
#include "models/contact_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "models/rigid_swing.hpp"
#include "models/run_limits.hpp"

namespace impactrig::models {
namespace {

/// What the contact pressed with [N s]. A step's polynomial may err by more than a graze has: no
/// impulse of a contact that cannot pull is below zero.
double impulse_between(const ContactTotals& start, const ContactTotals& end,
                       const ContactForce& contact) {
  const double impulse = end.impulse - start.impulse;
  return contact.may_pull() ? impulse : std::max(impulse, 0.0);
}

}  // namespace

ContactLog::ContactLog(const Rig& rig, double accuracy, Simulation& result)
    : rig_(rig),
      accuracy_(accuracy),
      result_(result),
      last_(static_cast<std::size_t>(rig.stops())) {}

void ContactLog::begin(const BeamEnergy& energy) {
  energy_at_touch_ =
      energy.kinetic + energy.elastic + energy.spring + energy.gravitational + energy.stop;
  result_.energy.initial = energy.kinetic;
  result_.energy.elastic_at_start = energy.elastic;
  result_.energy.gravitational = -energy.gravitational;
}

void ContactLog::touch(int stop, double t, double speed, const ContactTotals& totals,
                       ContactForce& contact) {
  if (result_.episodes.size() >= most_episodes)
    throw std::runtime_error(
        fmt::format("more than {} contacts; state a shorter solver.duration", most_episodes));
  Episode episode;
  episode.stop = stop;
  episode.start = t;
  episode.approach_velocity = speed;
  episode.open = true;
  result_.episodes.push_back(episode);
  const double slowest = grazing_fraction * first_speed();
  if (speed < slowest && contact.takes_own_speed()) ++grazing_;
  contact.begin_episode(std::max(speed, slowest));
  contact.set_phase(ContactForce::Phase::pressed);
  last(stop) = {result_.episodes.size() - 1, totals, totals};
}

void ContactLog::slack(int stop, double t) {
  if (last(stop).slack) return;
  last(stop).slack = true;
  if (slack_++ == 0) first_slack_ = t;
}

void ContactLog::lowest(double force, double t) {
  if (force >= lowest_force_) return;
  lowest_force_ = force;
  lowest_at_ = t;
}

void ContactLog::deepest(int stop, double depth, const ContactTotals& totals,
                         const ContactForce& contact) {
  Episode& episode = result_.episodes[last(stop).episode];
  if (depth <= episode.max_penetration) return;
  if (depth > contact.limit_penetration())
    throw std::runtime_error(
        fmt::format("the penetration of {:g} m is beyond the range of the elastic law, {:g} m; the "
                    "contact is too soft or the impact too hard for it",
                    depth, contact.limit_penetration()));
  episode.max_penetration = depth;
  last(stop).at_deepest = totals;
}

void ContactLog::peak(int stop, double force, double t) {
  Episode& episode = result_.episodes[last(stop).episode];
  if (force <= episode.peak_force) return;
  episode.peak_force = force;
  episode.peak_time = t;
}

void ContactLog::separate(int stop, double t, double speed, const ContactTotals& totals,
                          ContactForce& contact) {
  note_push(stop, contact);
  const auto& [number, at_start, at_deepest, slack] = last(stop);
  Episode& episode = result_.episodes[number];
  episode.end = t;
  episode.separation_velocity = -speed;
  episode.impulse = impulse_between(at_start, totals, contact);
  episode.dissipated = totals.dissipated - at_start.dissipated;
  episode.open = false;
  contact.set_phase(ContactForce::Phase::free);
  if (number > 0) return;
  const double compression = at_deepest.impulse - at_start.impulse;
  const double stored = contact.stored(episode.max_penetration);
  const double work_in = stored + at_deepest.dissipated - at_start.dissipated;
  const double work_out = stored - (totals.dissipated - at_deepest.dissipated);
  result_.restitution.kinematic = episode.separation_velocity / episode.approach_velocity;
  result_.restitution.kinetic = (episode.impulse - compression) / compression;
  result_.restitution.energetic = std::sqrt(std::max(work_out, 0.0) / work_in);
}

/// The mean speed by which the first contact closed, weighted by its force: what went into it by
/// its greatest depth, over the impulse until then. Damping that is too great for a push holds that
/// speed down: then the speed that the energy would have.
void ContactLog::note_push(int stop, const ContactForce& contact) {
  const auto& [number, at_start, at_deepest, slack] = last(stop);
  const double impulse = at_deepest.impulse - at_start.impulse;
  if (number > 0 || !contact.takes_own_speed() || !(impulse > 0.0)) return;
  const double energy = contact.stored(result_.episodes[number].max_penetration) +
                        at_deepest.dissipated - at_start.dissipated;
  pushed_at_ = energy / impulse;
  worth_ = std::sqrt(2.0 * energy / rig_.effective_mass(0));
}

StopTotals ContactLog::sum_up(int stop) const {
  StopTotals sum;
  for (const Episode& episode : result_.episodes) {
    if (episode.stop != stop) continue;
    sum.max_penetration = std::max(sum.max_penetration, episode.max_penetration);
    if (episode.peak_force <= sum.peak_force) continue;
    sum.peak_force = episode.peak_force;
    sum.peak_time = episode.peak_time;
  }
  return sum;
}

void ContactLog::conclude(int stop, double t, const ContactTotals& totals,
                          const ContactForce& contact, double penetration) {
  if (contact.phase() != ContactForce::Phase::free) {
    note_push(stop, contact);
    const auto& [number, at_start, at_deepest, slack] = last(stop);
    Episode& episode = result_.episodes[number];
    episode.end = t;
    episode.separation_velocity = std::numeric_limits<double>::quiet_NaN();
    episode.impulse = impulse_between(at_start, totals, contact);
    episode.dissipated = totals.dissipated - at_start.dissipated;
    result_.energy.contact_stored += contact.stored(penetration);
  }
  StopTotals sum = sum_up(stop);
  sum.impulse = totals.impulse;
  sum.dissipated = totals.dissipated;
  result_.energy.dissipated += totals.dissipated;
  if (!rig_.further_stops.empty()) result_.stops.push_back(sum);
  tell_limits(stop, sum.max_penetration);
  if (stop > 0) return;
  result_.impulse = totals.impulse;
  result_.max_penetration = sum.max_penetration;
  result_.peak_force = sum.peak_force;
  result_.peak_time = sum.peak_time;
}

void ContactLog::conclude(double t, double damped, const BeamEnergy& energy,
                          const RigidPart& rigid) {
  if (std::ranges::any_of(result_.episodes, &Episode::open))
    result_.warnings.push_back(
        "the run ended in contact; state a longer solver.duration to see the separation.");
  result_.duration = t;
  result_.energy.damped = damped;
  close_audit(rig_, energy_at_touch_, energy, rigid, result_.energy);
  result_.restitution.law = rig_.contact.takes_restitution()
                                ? rig_.contact.restitution
                                : std::numeric_limits<double>::quiet_NaN();
  if (result_.episodes.empty() || result_.episodes.front().open) {
    const double unknown = std::numeric_limits<double>::quiet_NaN();
    result_.restitution = {result_.restitution.law, unknown, unknown, unknown};
  }
  warn_of_imbalance(accuracy_, result_);
  if (grazing_ > 0) tell_grazing();
  tell_push();
  tell_tension();
}

void ContactLog::tell_tension() {
  if (slack_ > 0)
    result_.warnings.push_back(
        fmt::format("the damping law would have pulled in {} contact(s), first {:.4g} s after "
                    "touch; the force was kept at zero while it would. contact.tension = "
                    "\"allow\" lets it pull.",
                    slack_, first_slack_));
  constexpr double rounding = 1e-9;  // of the largest force, where a law goes to zero
  if (lowest_force_ < -rounding * result_.peak_force)
    result_.warnings.push_back(
        fmt::format("the contact pulls with up to {:.4g} N, {:.4g} s after touch, as "
                    "contact.tension = \"allow\" has it.",
                    -lowest_force_, lowest_at_));
}

/// Beyond what the elastic law holds for, and what its units leave open.
void ContactLog::tell_limits(int stop, double depth) {
  if (!(depth > 0.0)) return;
  const Contact& contact = rig_.contact_of(stop);
  const std::string where = stop == 0 ? "" : fmt::format("contacts.{}: ", stop);
  for (const std::string& limit : elastic_limits(contact, depth))
    result_.warnings.push_back(where + limit + ".");
  if (const std::string unit = unit_dependence(contact, depth); !unit.empty())
    result_.warnings.push_back(where + unit);
}

void ContactLog::tell_grazing() {
  result_.warnings.push_back(
      fmt::format("{} contact(s) began slower than {:g} % of the first approach speed; their "
                  "damping was taken at that speed, since "
                  "the law divides by it. Forces after {:g} s depend on this choice.",
                  grazing_, 100.0 * grazing_fraction,
                  result_.episodes.size() > 1 ? result_.episodes[1].start : 0.0));
}

void ContactLog::tell_push() {
  constexpr double much_faster = 3.0;
  if (result_.episodes.empty()) return;
  const bool faster = pushed_at_ > much_faster * first_speed();
  if (!faster && !(worth_ > much_faster * first_speed())) return;
  const std::string push =
      faster ? fmt::format("is then closed at {:.3g} m/s on the average, by what presses the bar",
                           pushed_at_)
             : fmt::format(
                   "then takes as much energy as one at {:.3g} m/s has, from what presses "
                   "the bar",
                   worth_);
  result_.warnings.push_back(
      fmt::format("the first contact begins at {:.3g} m/s and {}: its damping divides by the "
                  "former, and all forces depend on that. State contact.restitution_speed, or take "
                  "a law with a dashpot.",
                  first_speed(), push));
}

void close_audit(const Rig& rig, double begun, const BeamEnergy& energy, const RigidPart& rigid,
                 EnergyAudit& audit) {
  audit.kinetic = energy.kinetic;
  audit.elastic = energy.elastic;
  audit.spring = energy.spring;
  audit.stop = energy.stop;
  audit.gravitational += energy.gravitational;
  audit.rigid_rotation = 0.5 * rig.beam.hinge_inertia() * rigid.rate * rigid.rate;
  audit.vibration = audit.kinetic + (audit.elastic - audit.elastic_at_start) - audit.rigid_rotation;
  audit.imbalance =
      (energy.kinetic + energy.elastic + energy.spring + energy.gravitational + energy.stop +
       audit.contact_stored + audit.dissipated + audit.damped - audit.driven - begun) /
      audit.initial;
}

void warn_of_imbalance(double accuracy, Simulation& result) {
  const double imbalance = result.energy.unbalanced();
  if (std::abs(imbalance) <= 10.0 * accuracy + 1e-10) return;
  result.warnings.push_back(
      fmt::format("the energy does not balance: {:.2g} of it is missing or too much; the "
                  "forces may be as far off. Ask for more solver.accuracy.",
                  imbalance));
}

void warn_of_start(Simulation& result) {
  result.warnings.emplace_back(
      "the bar's weight and turning would tear or crush it: there is no length at which it could "
      "have come at rest along its axis. It begins as it is made, and what it then does along its "
      "axis is part of the answer. Look at beam.youngs_modulus, beam.density and the gravity.");
}

namespace {

/// Whether a bar turning away from where it hangs, as a rigid body, cannot bring this point of it
/// to a stop on the far side within the longest run; `near_by` is as good as there [m].
bool out_of_reach(const Rig& rig, const RigidSwing& swing, const FurtherStop& stop, double near_by,
                  const RigidPart& rigid) {
  const double fastest = std::sqrt(rigid.rate * rigid.rate +
                                   2.0 / rig.beam.hinge_inertia() * swing.available(rigid.angle));
  const double way =
      stop.gap / stop.contact.position + rigid.angle - near_by / stop.contact.position;
  return way > fastest * longest_default_run;
}

}  // namespace

bool left_for_good(const Rig& rig, std::span<const double> reach, const RigidPart& rigid,
                   const BeamEnergy& energy) {
  if (!(rigid.rate < 0.0)) return false;
  const double rotation = 0.5 * rig.beam.hinge_inertia() * rigid.rate * rigid.rate;
  const double vibration = std::sqrt(std::max(energy.kinetic - rotation, 0.0) +
                                     std::max(energy.elastic, 0.0) + energy.stop);
  if (!(-rigid.angle * rig.contact.position > reach[0] * vibration)) return false;
  const RigidSwing swing(rig);
  for (std::size_t i = 0; i < rig.further_stops.size(); ++i) {
    const FurtherStop& stop = rig.further_stops[i];
    const double near_by = reach[i + 1] * vibration;
    if (stop.side == StopSide::far && !out_of_reach(rig, swing, stop, near_by, rigid)) return false;
    if (stop.side == StopSide::near && !(stop.gap - rigid.angle * stop.contact.position > near_by))
      return false;
  }
  // What hinge and air take of its turning by then may bring it back; or keep it from a hill, for
  // which twice that counts: it slows down on the way.
  const double rate = -rigid.rate;
  const double lost = longest_default_run *
                      (rig.beam.damping.mass * rate +
                       (rig.hinge.friction + rig.hinge.viscous * rate) / rig.beam.hinge_inertia());
  constexpr double most_lost = 0.1;  // of its rate
  return swing.shortest_return() >= longest_default_run && lost <= most_lost * rate &&
         !swing.pulled_back(rigid.angle, 2.0 * lost - rate);
}

}  // namespace impactrig::models
