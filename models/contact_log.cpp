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

void ContactLog::begin(const BeamEnergy& energy) {
  energy_at_touch_ =
      energy.kinetic + energy.elastic + energy.spring + energy.gravitational + energy.stop;
  result_.energy.initial = energy.kinetic;
  result_.energy.gravitational = -energy.gravitational;
}

void ContactLog::touch(double t, double speed, const ContactTotals& totals, ContactForce& contact) {
  if (result_.episodes.size() >= most_episodes)
    throw std::runtime_error(
        fmt::format("more than {} contacts; state a shorter solver.duration", most_episodes));
  Episode episode;
  episode.start = t;
  episode.approach_velocity = speed;
  episode.open = true;
  result_.episodes.push_back(episode);
  const double slowest = grazing_fraction * first_speed();
  if (speed < slowest) ++grazing_;
  contact.begin_episode(std::max(speed, slowest));
  contact.set_phase(ContactForce::Phase::pressed);
  at_start_ = at_deepest_ = totals;
}

void ContactLog::deepest(double depth, const ContactTotals& totals, const ContactForce& contact) {
  Episode& episode = result_.episodes.back();
  if (depth <= episode.max_penetration) return;
  if (depth > contact.limit_penetration())
    throw std::runtime_error(
        fmt::format("the penetration of {:g} m is beyond the range of the elastic law, {:g} m; the "
                    "contact is too soft or the impact too hard for it",
                    depth, contact.limit_penetration()));
  episode.max_penetration = depth;
  at_deepest_ = totals;
}

void ContactLog::peak(double force, double t) {
  Episode& episode = result_.episodes.back();
  if (force <= episode.peak_force) return;
  episode.peak_force = force;
  episode.peak_time = t;
}

void ContactLog::separate(double t, double speed, const ContactTotals& totals,
                          ContactForce& contact) {
  Episode& episode = result_.episodes.back();
  episode.end = t;
  episode.separation_velocity = -speed;
  episode.impulse = totals.impulse - at_start_.impulse;
  episode.dissipated = totals.dissipated - at_start_.dissipated;
  episode.open = false;
  contact.set_phase(ContactForce::Phase::free);
  if (result_.episodes.size() > 1) return;
  const double compression = at_deepest_.impulse - at_start_.impulse;
  const double stored = contact.stored(episode.max_penetration);
  const double work_in = stored + at_deepest_.dissipated - at_start_.dissipated;
  const double work_out = stored - (totals.dissipated - at_deepest_.dissipated);
  result_.restitution.kinematic = episode.separation_velocity / episode.approach_velocity;
  result_.restitution.kinetic = (episode.impulse - compression) / compression;
  result_.restitution.energetic = std::sqrt(std::max(work_out, 0.0) / work_in);
}

void ContactLog::conclude(double t, const ContactTotals& totals, const ContactForce& contact,
                          double penetration, const BeamEnergy& energy, const RigidPart& rigid) {
  if (!result_.episodes.empty() && result_.episodes.back().open) {
    Episode& episode = result_.episodes.back();
    episode.end = t;
    episode.separation_velocity = std::numeric_limits<double>::quiet_NaN();
    episode.impulse = totals.impulse - at_start_.impulse;
    episode.dissipated = totals.dissipated - at_start_.dissipated;
    result_.energy.contact_stored = contact.stored(penetration);
    result_.warnings.push_back(
        "the run ended in contact; state a longer solver.duration to see the separation.");
  }
  result_.duration = t;
  result_.impulse = totals.impulse;
  for (const Episode& episode : result_.episodes) {
    result_.max_penetration = std::max(result_.max_penetration, episode.max_penetration);
    if (episode.peak_force <= result_.peak_force) continue;
    result_.peak_force = episode.peak_force;
    result_.peak_time = episode.peak_time;
  }
  EnergyAudit& audit = result_.energy;
  audit.dissipated = totals.dissipated;
  audit.damped = totals.damped;
  close_audit(rig_, energy_at_touch_, energy, rigid, audit);
  result_.restitution.law = rig_.contact.restitution;
  if (result_.episodes.empty() || result_.episodes.front().open) {
    const double unknown = std::numeric_limits<double>::quiet_NaN();
    result_.restitution = {rig_.contact.restitution, unknown, unknown, unknown};
  }
  warn_of_imbalance(accuracy_, result_);
  if (grazing_ > 0)
    result_.warnings.push_back(
        fmt::format("{} contact(s) began slower than {:g} % of the first approach speed; their "
                    "damping was taken at that speed, since "
                    "the law divides by it. Forces after {:g} s depend on this choice.",
                    grazing_, 100.0 * grazing_fraction,
                    result_.episodes.size() > 1 ? result_.episodes[1].start : 0.0));
}

void close_audit(const Rig& rig, double begun, const BeamEnergy& energy, const RigidPart& rigid,
                 EnergyAudit& audit) {
  audit.kinetic = energy.kinetic;
  audit.elastic = energy.elastic;
  audit.spring = energy.spring;
  audit.stop = energy.stop;
  audit.gravitational += energy.gravitational;
  audit.rigid_rotation = 0.5 * rig.beam.hinge_inertia() * rigid.rate * rigid.rate;
  audit.vibration = audit.kinetic + audit.elastic - audit.rigid_rotation;
  audit.imbalance = (energy.kinetic + energy.elastic + energy.spring + energy.gravitational +
                     energy.stop + audit.contact_stored + audit.dissipated + audit.damped - audit.driven - begun) /
                    audit.initial;
}

void warn_of_imbalance(double accuracy, Simulation& result) {
  const double imbalance = result.energy.imbalance;
  if (std::abs(imbalance) <= 10.0 * accuracy + 1e-10) return;
  result.warnings.push_back(
      fmt::format("the energy does not balance: {:.2g} of the initial energy is missing or too "
                  "much; the forces may be as far off. Ask for more solver.accuracy.",
                  imbalance));
}

bool left_for_good(const Rig& rig, double reach, const RigidPart& rigid, const BeamEnergy& energy) {
  if (!(rigid.rate < 0.0)) return false;
  const double rotation = 0.5 * rig.beam.hinge_inertia() * rigid.rate * rigid.rate;
  const double vibration =
      std::max(energy.kinetic - rotation, 0.0) + std::max(energy.elastic, 0.0) + energy.stop;
  if (!(-rigid.angle * rig.contact.position > reach * std::sqrt(vibration))) return false;
  const RigidSwing swing(rig);
  return swing.shortest_return() >= longest_default_run &&
         !swing.pulled_back(rigid.angle, rigid.rate);
}

}  // namespace impactrig::models
