// SPDX-License-Identifier: BSD-3-Clause
#include "models/sensitivities/run_sensitivities.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "models/history_recorder.hpp"
#include "models/run_limits.hpp"

namespace impactrig::models {
namespace {

void make_unknown(Sensitivity& result) {
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  result.peak_force = result.max_penetration = result.duration = result.impulse =
      result.separation_velocity = unknown;
  result.restitution = {0.0, unknown, unknown, unknown};
}

}  // namespace

RunSensitivities::RunSensitivities(const Rig& rig, const SimulationOptions& options,
                                   const BarMotion& motion, const StoppedMotion* stopped)
    : rig_(rig),
      options_(options),
      stopped_(stopped),
      rule_(motion.rule()),
      stops_(static_cast<std::size_t>(rig.stops())),
      force_(stops_.size()),
      series_(stops_.size()),
      motion_(motion) {
  for (std::size_t k = 1; k < stops_.size(); ++k) stops_[k].gap = rig.further_stops[k - 1].gap;
  place_.series.resize(stops_.size());
  place_.force.resize(stops_.size());
}

void RunSensitivities::add(std::unique_ptr<RigEffect> effect) {
  Direction& d = directions_.emplace_back();
  d.effect = std::move(effect);
  d.speed.resize(stops_.size());
  d.first_speed.resize(stops_.size());
  d.force.resize(stops_.size());
  d.series.resize(stops_.size());
  make_unknown(d.result);
}

void RunSensitivities::begin(double speed, std::size_t samples) {
  see_state();
  for (int i = 0; i < count(); ++i) {
    Direction& d = direction(i);
    d.result.history = d.effect->lead(options_.history, speed, struck(i, 0).velocity);
    if (stopped_) d.result.history.sensor_force.resize(d.result.history.force.size(), 0.0);
    make_room(samples, d.result.history);
    d.time = d.impulse = d.dissipated = d.force_at_end = 0.0;
    begin_more(i);
  }
}

/// At the place, the gap's own slope off.
PointMotion RunSensitivities::against_stop(int i, std::size_t stop) const {
  PointMotion p = struck_at_place(i, stop);
  p.displacement -= direction(i).effect->law(static_cast<int>(stop)).gap();
  return p;
}

void RunSensitivities::touch(int stop, const ContactForce& contact, double speed) {
  const auto number = static_cast<std::size_t>(stop);
  const bool first_here = !stops_[number].contact;
  stops_[number].contact = &contact;
  see_state();
  const bool grazing = contact.law_speed() > speed * (1.0 + 1e-12);
  for (int i = 0; i < count(); ++i) {
    Direction& d = direction(i);
    const double slope = struck(i, number).velocity;
    if (first_here) d.first_speed[number] = slope;
    if (contact.speed_is_stated())
      d.speed[number] = 0.0;
    else if (contact.keeps_first_speed())
      d.speed[number] = d.first_speed[number];
    else
      d.speed[number] = grazing ? grazing_fraction * d.first_speed[0] : slope;
    d.effect->law(stop).begin_episode(contact.law_speed());
  }
}

/// Of the pressing force, penetration and rate held.
double RunSensitivities::law_slope(const Direction& d, std::size_t stop, const Seen& seen) const {
  return d.effect->law(static_cast<int>(stop)).of_force(seen.depth, seen.rate, seen.law) +
         stops_[stop].contact->to_speed(seen.law) * d.speed[stop];
}

bool RunSensitivities::solve(std::span<const StopStep> steps) {
  see_state();
  for (std::size_t k = 0; k < stops_.size(); ++k) {
    Pressed& stop = stops_[k];
    force_[k] = steps[k].force;
    series_[k] = steps[k].force_series;
    stop.laws.clear();
    if (!stop.contact) continue;
    for (Direction& d : directions_)
      d.effect->law(static_cast<int>(k)).set_phase(stop.contact->phase());
    if (stop.contact->phase() == ContactForce::Phase::free) continue;
    for (int i = 0; i < rule_.nodes(); ++i) {
      const double depth = steps[k].displacement[i], rate = steps[k].velocity[i];
      stop.laws.push_back(
          {depth, rate, stop.contact->elastic(depth), stop.contact->pressed(depth, rate)});
    }
  }
  prepare();
  for (int i = 0; i < count(); ++i) {
    if (!solve(i)) return false;
    Direction& d = direction(i);
    for (std::size_t k = 0; k < stops_.size(); ++k) d.series[k] = rule_.to_series() * d.force[k];
    find_dissipation(d);
  }
  return true;
}

void RunSensitivities::linearise_laws() {
  const int s = rule_.nodes();
  Eigen::Index rows = 0;
  for (Pressed& stop : stops_) {
    stop.first_row = stop.presses() ? rows : -1;
    if (stop.presses()) rows += s;
  }
  drive_.resize(rows);
  jacobian_.setIdentity(rows, rows);
  for (std::size_t p = 0; p < stops_.size(); ++p)
    for (std::size_t q = 0; q < stops_.size(); ++q) {
      const Pressed& point = stops_[p];
      if (!point.presses() || !stops_[q].presses()) continue;
      const BarMotion::Response& answer = response(static_cast<int>(p), static_cast<int>(q));
      for (int i = 0; i < s; ++i) {
        const ContactForce::Response& law = point.laws[static_cast<std::size_t>(i)].law;
        jacobian_.block(point.first_row + i, stops_[q].first_row, 1, s) -=
            law.to_depth * answer.displacement_of_force.row(i) +
            law.to_rate * answer.velocity_of_force.row(i);
      }
    }
  if (rows > 0) inverse_ = jacobian_.inverse();
}

void RunSensitivities::drive_laws(const Direction& d) {
  for (std::size_t p = 0; p < stops_.size(); ++p) {
    const Pressed& stop = stops_[p];
    if (!stop.presses()) continue;
    for (int i = 0; i < rule_.nodes(); ++i) {
      const NodeLaw& there = stop.laws[static_cast<std::size_t>(i)];
      drive_[stop.first_row + i] =
          there.law.to_depth * stop.depth[i] + there.law.to_rate * stop.rate[i] +
          law_slope(d, p, {there.displacement, there.velocity, 0.0, there.law});
    }
  }
}

/// Of what the first contact dissipates at the nodes.
void RunSensitivities::find_dissipation(Direction& d) {
  const Pressed& first = stops_[0];
  d.dissipation.setZero(rule_.nodes());
  for (std::size_t i = 0; i < first.laws.size(); ++i) {
    const auto node = static_cast<Eigen::Index>(i);
    d.dissipation[node] = dissipation_slope(d, first.laws[i], first.depth[node], first.rate[node]);
  }
}

double RunSensitivities::dissipation_slope(const Direction& d, const NodeLaw& there, double depth,
                                           double rate) const {
  const auto& [displacement, velocity, elastic, law] = there;
  const ContactForce& contact = *stops_[0].contact;
  const double own = d.effect->law(0).of_dissipation(displacement, velocity);
  if (contact.phase() == ContactForce::Phase::slack)
    return own - law.stiffness * velocity * depth - elastic * rate;
  // of (f − f_0) δ̇
  return own + (law.to_depth - law.stiffness) * velocity * depth +
         (law.force - elastic + law.to_rate * velocity) * rate +
         contact.to_speed(law) * velocity * d.speed[0];
}

double RunSensitivities::force_truncation(int i) const {
  double worst = 0.0;
  for (const NodeVector& series : direction(i).series) worst = std::max(worst, truncation(series));
  return worst;
}

double RunSensitivities::dissipation_truncation(int i) const {
  return truncation(rule_.to_series() * direction(i).dissipation);
}

double RunSensitivities::integral(const NodeVector& at_nodes, double part) const {
  const double h = motion_.step();
  if (part >= 1.0) return h * rule_.weights().dot(at_nodes);
  const NodeVector series = rule_.to_series() * at_nodes;
  return part * h * rule_.restricted(series, part)[0];
}

void RunSensitivities::look(double part) {
  place_.part = part;
  for (std::size_t k = 0; k < stops_.size(); ++k) {
    place_.series[k] = rule_.restricted(series_[k], part);
    place_.force[k] = place_.series[k].sum();
  }
  go_to_place();
  see_points();
}

void RunSensitivities::see_points() {
  seen_.clear();
  for (std::size_t k = 0; k < stops_.size(); ++k) {
    const Passing p = passing(k);
    Seen& seen = seen_.emplace_back(p.displacement - stops_[k].gap, p.velocity, p.acceleration);
    if (stops_[k].presses()) seen.law = stops_[k].contact->pressed(seen.depth, seen.rate);
  }
}

void RunSensitivities::peak(double part) {
  peak_part_ = part;
  look(part);
  const Seen& seen = seen_[0];
  for (int i = 0; i < count(); ++i) {
    Direction& d = direction(i);
    follow_to_place(i);
    const PointMotion s = against_stop(i, 0);
    d.result.peak_force =
        seen.law.to_depth * s.displacement + seen.law.to_rate * s.velocity + law_slope(d, 0, seen);
  }
}

void RunSensitivities::deepest(double part, double dissipated) {
  deepest_part_ = part;
  look(part);
  dissipated_at_deepest_ = dissipated;
  for (int i = 0; i < count(); ++i) {
    Direction& d = direction(i);
    follow_to_place(i);
    const PointMotion s = against_stop(i, 0);
    const double shift = -s.velocity / seen_[0].acceleration;
    d.result.max_penetration = s.displacement;
    d.compression = d.impulse + integral(d.force[0], part) + place_.force[0] * shift;
    d.dissipated_at_deepest = d.dissipated + integral(d.dissipation, part);
  }
}

/// At the place, which moves in time like this.
double RunSensitivities::shown_force(int i, std::size_t stop, double moved) const {
  if (!stops_[stop].presses()) return 0.0;
  const Direction& d = direction(i);
  const Seen& seen = seen_[stop];
  const PointMotion s = against_stop(i, stop);
  return seen.law.to_depth * (s.displacement + moved * seen.rate) +
         seen.law.to_rate * (s.velocity + moved * seen.acceleration) + law_slope(d, stop, seen);
}

/// Of the first stop, at the place.
double RunSensitivities::force_at_touch(int i) const {
  if (!stops_[0].presses()) return 0.0;
  Seen touching = seen_[0];
  touching.depth = 0.0;
  touching.law = stops_[0].contact->pressed(0.0, touching.rate);
  return touching.law.to_rate * against_stop(i, 0).velocity + law_slope(direction(i), 0, touching);
}

/// One sample.
void RunSensitivities::show(int i) {
  Direction& d = direction(i);
  History& history = d.result.history;
  for (std::size_t k = 0; k < stops_.size(); ++k) {
    const double moved_depth = against_stop(i, k).displacement - d.time * seen_[k].rate;
    (k == 0 ? history.force : history.further[k - 1].force).push_back(shown_force(i, k, -d.time));
    (k == 0 ? history.penetration : history.further[k - 1].penetration).push_back(moved_depth);
  }
  const Spots spots = this->spots(i);
  history.velocity.push_back(spots.velocity - d.time * spots.velocity_rate);
  history.displacement.push_back(spots.displacement - d.time * spots.displacement_rate - d.rest);
  if (stopped_)
    history.sensor_force.push_back(spots.sensor_force - d.time * spots.sensor_force_rate);
}

void RunSensitivities::go_to_sample(double part, double, bool) {
  look(part);
  for (int i = 0; i < count(); ++i) follow_to_place(i);
}

void RunSensitivities::note_change(double time) {
  for (Direction& d : directions_) d.impulses.note_change(time);
}

void RunSensitivities::jump(bool at_touch) {
  jumped_ = true;
  touches_ = at_touch;
  for (Direction& d : directions_) d.result.history.jumps.push_back({d.time, d.force_at_end, 0.0});
}

/// What the force does there is known when the step that begins there is. At touch the depth stays
/// 0, whatever the parameter: laws may be so steep there that its rounding would be magnified.
void RunSensitivities::look_beyond_jump() {
  if (!jumped_) return;
  jumped_ = false;
  look(0.0);
  for (int i = 0; i < count(); ++i) {
    follow_to_place(i);
    direction(i).result.history.jumps.back().after =
        touches_ ? force_at_touch(i) : shown_force(i, 0, 0.0);
  }
}

/// Of the first stop, the place's time held.
double RunSensitivities::impulse_at_place(int i) const {
  const Direction& d = direction(i);
  return d.impulse + integral(d.force[0], place_.part) - d.time * place_.force[0];
}

void RunSensitivities::sample(double first, double spacing, std::size_t count) {
  look_beyond_jump();
  for (std::size_t k = 0; k < count; ++k) {
    place_.part = first + static_cast<double>(k) * spacing;
    go_to_sample(place_.part, spacing, k == 0);
    for (int i = 0; i < this->count(); ++i) {
      show(i);
      Direction& d = direction(i);
      History& history = d.result.history;
      if (d.impulses.wants() || k + 1 == count)
        d.impulses.see(history.force.size() - 1, impulse_at_place(i), history);
    }
  }
}

/// Of the step's length, where its end is an event's; the place is that end.
double RunSensitivities::end_shift(int i, End end, std::size_t stop) {
  const Direction& d = direction(i);
  if (end == End::step) return 0.0;
  if (end == End::time) return -d.time;
  if (end == End::hinge) return hinge_shift(i);
  const Seen& seen = seen_[stop];
  const PointMotion s = against_stop(i, stop);
  if (end == End::gap) return -s.displacement / seen.rate;
  const ContactForce::Switch change = stops_[stop].contact->switching(seen.depth, seen.rate);
  const double slope = d.effect->law(static_cast<int>(stop)).of_switching(seen.depth, seen.rate) +
                       change.to_depth * s.displacement + change.to_rate * s.velocity +
                       change.to_speed * d.speed[stop];
  return -slope / (change.to_depth * seen.rate + change.to_rate * seen.acceleration);
}

/// Where that is within the step: its time is held, since it is flat there.
void RunSensitivities::find_sensor_peak() {
  look(*stopped_->peak_part());
  for (int i = 0; i < count(); ++i) {
    follow_to_place(i);
    direction(i).result.sensor_peak_force = spots(i).sensor_force;
  }
}

/// The place is the step's end, which moves like this: a force that rises up to there moves with
/// it.
void RunSensitivities::see_sensor_peak_at_end(int i, double shift) {
  const Spots spots = this->spots(i);
  direction(i).result.sensor_peak_force = spots.sensor_force + shift * spots.sensor_force_rate;
}

/// Likewise of a force and a penetration that rise up to there: within a step they are flat where
/// they are largest.
void RunSensitivities::move_largest_at_end(int i, double shift, double part) {
  if (shift == 0.0) return;
  const Seen& seen = seen_[0];
  Sensitivity& result = direction(i).result;
  if (peak_part_ >= part)
    result.peak_force +=
        shift * (seen.law.to_depth * seen.rate + seen.law.to_rate * seen.acceleration);
  if (deepest_part_ >= part) result.max_penetration += shift * seen.rate;
}

void RunSensitivities::take(double part, End end, int stop) {
  look_beyond_jump();
  const std::optional<double> peak = stopped_ ? stopped_->peak_part() : std::nullopt;
  if (peak && *peak < part) find_sensor_peak();
  look(part);
  const double power =
      stops_[0].contact ? stops_[0].contact->dissipation(seen_[0].depth, seen_[0].rate) : 0.0;
  for (int i = 0; i < count(); ++i) {
    Direction& d = direction(i);
    follow_to_place(i);
    const double shift = end_shift(i, end, static_cast<std::size_t>(stop));
    if (peak && *peak >= part) see_sensor_peak_at_end(i, shift);
    move_largest_at_end(i, shift, part);
    d.force_at_end = shown_force(i, 0, shift);
    d.impulse += integral(d.force[0], part) + shift * place_.force[0];
    d.dissipated += integral(d.dissipation, part) + shift * power;
    d.time += shift;
    move_on(i, shift);
  }
  peak_part_ = deepest_part_ = -1.0;
}

void RunSensitivities::separate(const Simulation& result) {
  see_state();
  const Episode& e = result.episodes.front();
  const Restitution& r = result.restitution;
  const ContactForce& contact = *stops_[0].contact;
  const double compression = e.impulse / (1.0 + r.kinetic);
  const double stored = contact.stored(e.max_penetration);
  const double work_in = stored + dissipated_at_deepest_;
  const double work_out = stored - (e.dissipated - dissipated_at_deepest_);
  for (int i = 0; i < count(); ++i) {
    Direction& d = direction(i);
    Sensitivity& to = d.result;
    to.duration = d.time;
    to.impulse = d.impulse;
    to.separation_velocity = -struck(i, 0).velocity;
    to.restitution.kinematic =
        (to.separation_velocity - r.kinematic * d.first_speed[0]) / e.approach_velocity;
    to.restitution.kinetic = (d.impulse - (1.0 + r.kinetic) * d.compression) / compression;
    const double stored_slope = contact.elastic(e.max_penetration) * to.max_penetration +
                                d.effect->law(0).of_stored(e.max_penetration);
    const double in_slope = stored_slope + d.dissipated_at_deepest;
    const double out_slope = stored_slope - (d.dissipated - d.dissipated_at_deepest);
    to.restitution.energetic =
        work_out > 0.0 ? 0.5 * r.energetic * (out_slope / work_out - in_slope / work_in) : 0.0;
  }
}

std::vector<Sensitivity> RunSensitivities::take_results() {
  std::vector<Sensitivity> results;
  for (Direction& d : directions_) results.push_back(std::move(d.result));
  return results;
}

}  // namespace impactrig::models
