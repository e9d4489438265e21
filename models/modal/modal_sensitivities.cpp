// SPDX-License-Identifier: BSD-3-Clause
#include "models/modal/modal_sensitivities.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "models/run_limits.hpp"

namespace impactrig::models {
namespace {

void make_unknown(Sensitivity& result) {
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  result.peak_force = result.max_penetration = result.duration = result.impulse =
      result.separation_velocity = unknown;
  result.restitution = {0.0, unknown, unknown, unknown};
}

/// A row of the bar's modes, as of those with the stop's head.
Eigen::VectorXd widened(const Eigen::VectorXd& row, Eigen::Index modes) {
  Eigen::VectorXd wide = Eigen::VectorXd::Zero(modes);
  wide.head(row.size()) = row;
  return wide;
}

std::optional<ModalBeam> with_head(const Rig& rig, const ModalBeam& bar) {
  if (!rig.stop) return std::nullopt;
  const StopHead::Mode head = StopHead(*rig.stop).mode();
  return bar.with_mode(head.omega, head.damping, head.struck);
}

}  // namespace

ModalSensitivities::ModalSensitivities(const Rig& rig, const Solver& solver,
                                       const SimulationOptions& options, const ModalMotion& motion,
                                       const StoppedMotion* stopped)
    : rig_(rig),
      options_(options),
      motion_(motion),
      stopped_(stopped),
      with_head_(with_head(rig, motion.beam())),
      modes_(with_head_ ? *with_head_ : motion.beam()),
      rule_(motion.rule()),
      velocity_row_(widened(motion.velocity_row(), modes_.modes())),
      displacement_row_(widened(motion.displacement_row(), modes_.modes())),
      stops_(static_cast<std::size_t>(rig.stops())),
      force_(stops_.size()),
      series_(stops_.size()),
      parts_(stops_.size()) {
  if (rig.stop) sensor_row_ = ParameterEffect::SensorRow::of(*rig.stop);
  for (std::size_t k = 1; k < stops_.size(); ++k) stops_[k].gap = rig.further_stops[k - 1].gap;
  place_.series.resize(stops_.size());
  place_.force.resize(stops_.size());
  state_.a = state_.rate = Eigen::VectorXd::Zero(modes_.modes());
  for (const RigParameter parameter : options.sensitivities)
    directions_.emplace_back(*this, solver, parameter);
}

ModalSensitivities::Direction::Direction(const ModalSensitivities& all, const Solver& solver,
                                         RigParameter parameter)
    : effect(all.rig_, solver, all.options_.history, parameter, all.motion_.beam(), all.modes_,
             all.rule_),
      speed(all.stops_.size()),
      first_speed(all.stops_.size()),
      force(all.stops_.size()),
      series(all.stops_.size()) {
  make_unknown(result);
}

/// The run's own state.
void ModalSensitivities::see_state() {
  const Eigen::Index bar = motion_.state().a.size();
  state_.a.head(bar) = motion_.state().a;
  state_.rate.head(bar) = motion_.state().rate;
  if (!stopped_) return;
  const double root = std::sqrt(rig_.stop->mass);
  state_.a[bar] = root * stopped_->head().displacement;
  state_.rate[bar] = root * stopped_->head().velocity;
}

/// The step at hand.
const ModalStep& ModalSensitivities::step() {
  if (!stopped_) return motion_.modal_step();
  const double h = motion_.step();
  const auto found = own_steps_.find(h);
  if (found != own_steps_.end()) return found->second;
  return own_steps_.emplace(h, ModalStep(modes_, rule_, h)).first->second;
}

void ModalSensitivities::begin() {
  const double rate = touch_velocity(rig_) / rig_.contact.position;
  for (Direction& d : directions_) {
    d.state.a = Eigen::VectorXd::Zero(modes_.modes());
    d.state.rate = modes_.rigid() * d.effect.start_rate();
    if (d.effect.moves_modes()) d.state.rate += d.effect.modes().rigid * rate;
    d.end = d.state;
    d.result.history = d.effect.lead(options_.history);
    if (stopped_) d.result.history.sensor_force.resize(d.result.history.force.size(), 0.0);
  }
}

void ModalSensitivities::touch(int stop, const ContactForce& contact, double speed) {
  const auto number = static_cast<std::size_t>(stop);
  const bool first_here = !stops_[number].contact;
  stops_[number].contact = &contact;
  see_state();
  const bool grazing = contact.law_speed() > speed * (1.0 + 1e-12);
  for (Direction& d : directions_) {
    const double slope = struck(d, number, d.state, state_).rate;
    if (first_here) d.first_speed[number] = slope;
    if (contact.speed_is_stated())
      d.speed[number] = 0.0;
    else if (contact.keeps_first_speed())
      d.speed[number] = d.first_speed[number];
    else
      d.speed[number] = grazing ? grazing_fraction * d.first_speed[0] : slope;
    d.effect.law(stop).begin_episode(contact.law_speed());
  }
}

ModalSensitivities::Struck ModalSensitivities::struck(const Direction& d, std::size_t stop,
                                                      const ModalState& slope,
                                                      const ModalState& state) const {
  const auto number = static_cast<int>(stop);
  const Eigen::VectorXd& row = modes_.struck(number);
  Struck s{row.dot(slope.a) - d.effect.law(number).gap(), row.dot(slope.rate)};
  if (!d.effect.moves_modes()) return s;
  s.depth += d.effect.struck(number).dot(state.a);
  s.rate += d.effect.struck(number).dot(state.rate);
  return s;
}

/// Of the pressing force, penetration and rate held.
double ModalSensitivities::law_slope(const Direction& d, std::size_t stop, const Seen& seen) const {
  return d.effect.law(static_cast<int>(stop)).of_force(seen.depth, seen.rate, seen.law) +
         stops_[stop].contact->to_speed(seen.law) * d.speed[stop];
}

void ModalSensitivities::solve(std::span<const StopStep> steps) {
  see_state();
  for (std::size_t k = 0; k < stops_.size(); ++k) {
    Pressed& stop = stops_[k];
    force_[k] = steps[k].force;
    series_[k] = steps[k].force_series;
    stop.laws.clear();
    if (!stop.contact) continue;
    for (Direction& d : directions_)
      d.effect.law(static_cast<int>(k)).set_phase(stop.contact->phase());
    if (stop.contact->phase() == ContactForce::Phase::free) continue;
    for (int i = 0; i < rule_.nodes(); ++i) {
      const double depth = steps[k].displacement[i], rate = steps[k].velocity[i];
      stop.laws.push_back(
          {depth, rate, stop.contact->elastic(depth), stop.contact->pressed(depth, rate)});
    }
  }
  linearise();
  for (Direction& d : directions_) solve(d);
}

/// The laws' equations for the slopes of the forces that press.
void ModalSensitivities::linearise() {
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
      const BarMotion::Response& response =
          step().response(static_cast<int>(p), static_cast<int>(q));
      for (int i = 0; i < s; ++i) {
        const ContactForce::Response& law = point.laws[static_cast<std::size_t>(i)].law;
        jacobian_.block(point.first_row + i, stops_[q].first_row, 1, s) -=
            law.to_depth * response.displacement_of_force.row(i) +
            law.to_rate * response.velocity_of_force.row(i);
      }
    }
  if (rows > 0) inverse_ = jacobian_.inverse();
}

/// Of the points before the stops that touch, without what the forces' slopes do.
void ModalSensitivities::find_free_slopes(Direction& d) {
  const ModalStep* change = d.effect.moves_modes() ? &d.effect.step(motion_.step()) : nullptr;
  NodeVector depth, rate;
  for (std::size_t p = 0; p < stops_.size(); ++p) {
    Pressed& stop = stops_[p];
    if (stop.laws.empty()) continue;
    const auto number = static_cast<int>(p);
    step().coast(number, d.state, stop.depth, stop.rate);
    stop.depth.array() -= d.effect.law(number).gap();
    if (!change) continue;
    change->coast(number, state_, depth, rate);
    stop.depth += depth;
    stop.rate += rate;
    for (std::size_t q = 0; q < stops_.size(); ++q) {
      if (force_[q].isZero(0.0)) continue;
      const BarMotion::Response& response = change->response(number, static_cast<int>(q));
      stop.depth += response.displacement_of_force * force_[q];
      stop.rate += response.velocity_of_force * force_[q];
    }
  }
}

/// The forces at the nodes; then what the first contact dissipates there.
void ModalSensitivities::solve(Direction& d) {
  const int s = rule_.nodes();
  find_free_slopes(d);
  for (std::size_t p = 0; p < stops_.size(); ++p) {
    const Pressed& stop = stops_[p];
    if (!stop.presses()) continue;
    for (int i = 0; i < s; ++i) {
      const NodeLaw& there = stop.laws[static_cast<std::size_t>(i)];
      drive_[stop.first_row + i] =
          there.law.to_depth * stop.depth[i] + there.law.to_rate * stop.rate[i] +
          law_slope(d, p, {there.displacement, there.velocity, 0.0, there.law});
    }
  }
  if (drive_.size() > 0) answer_.noalias() = inverse_ * drive_;
  d.dissipation.setZero(s);
  Pressed& first = stops_[0];
  for (std::size_t q = 0; q < stops_.size(); ++q) {
    d.force[q].setZero(s);
    d.series[q].setZero(s);
    if (!stops_[q].presses()) continue;
    d.force[q] = answer_.segment(stops_[q].first_row, s);
    d.series[q] = rule_.to_series() * d.force[q];
    if (first.laws.empty()) continue;
    const BarMotion::Response& response = step().response(0, static_cast<int>(q));
    first.depth += response.displacement_of_force * d.force[q];
    first.rate += response.velocity_of_force * d.force[q];
  }
  for (std::size_t i = 0; i < first.laws.size(); ++i) {
    const auto node = static_cast<Eigen::Index>(i);
    d.dissipation[node] = dissipation_slope(d, first.laws[i], first.depth[node], first.rate[node]);
  }
}

double ModalSensitivities::dissipation_slope(const Direction& d, const NodeLaw& there, double depth,
                                             double rate) const {
  const auto& [displacement, velocity, elastic, law] = there;
  const ContactForce& contact = *stops_[0].contact;
  const double own = d.effect.law(0).of_dissipation(displacement, velocity);
  if (contact.phase() == ContactForce::Phase::slack)
    return own - law.stiffness * velocity * depth - elastic * rate;
  // of (f − f_0) δ̇
  return own + (law.to_depth - law.stiffness) * velocity * depth +
         (law.force - elastic + law.to_rate * velocity) * rate +
         contact.to_speed(law) * velocity * d.speed[0];
}

double ModalSensitivities::force_truncation(int i) const {
  double worst = 0.0;
  for (const NodeVector& series : at(i).series) worst = std::max(worst, truncation(series));
  return worst;
}

double ModalSensitivities::dissipation_truncation(int i) const {
  return truncation(rule_.to_series() * at(i).dissipation);
}

double ModalSensitivities::integral(const NodeVector& at_nodes, double part) const {
  const double h = motion_.step();
  if (part >= 1.0) return h * rule_.weights().dot(at_nodes);
  const NodeVector series = rule_.to_series() * at_nodes;
  return part * h * rule_.restricted(series, part)[0];
}

/// Goes to a place of the solved step.
void ModalSensitivities::look(double part) {
  place_.part = part;
  place_.state = state_;
  for (std::size_t k = 0; k < stops_.size(); ++k) {
    place_.series[k] = rule_.restricted(series_[k], part);
    place_.force[k] = place_.series[k].sum();
  }
  if (part >= 1.0)
    step().advance(state_, force_, place_.state);
  else if (part > 0.0)
    advance(modes_, part * motion_.step(), place_.series, state_, place_.state);
  accelerate();
}

void ModalSensitivities::accelerate() {
  place_.acceleration = -modes_.omega().cwiseAbs2().cwiseProduct(place_.state.a) -
                        modes_.damping().cwiseProduct(place_.state.rate);
  for (std::size_t k = 0; k < stops_.size(); ++k)
    place_.acceleration -= modes_.struck(static_cast<int>(k)) * place_.force[k];
  seen_.clear();
  for (std::size_t k = 0; k < stops_.size(); ++k) seen_.push_back(see(k));
}

ModalSensitivities::Seen ModalSensitivities::see(std::size_t stop) const {
  const Eigen::VectorXd& row = modes_.struck(static_cast<int>(stop));
  Seen seen{row.dot(place_.state.a) - stops_[stop].gap, row.dot(place_.state.rate),
            row.dot(place_.acceleration)};
  if (stops_[stop].presses()) seen.law = stops_[stop].contact->pressed(seen.depth, seen.rate);
  return seen;
}

/// The state's slope at the place, at the same time from the step's beginning: d.end.
void ModalSensitivities::state_here(Direction& d) {
  d.end = d.state;
  if (!(place_.part > 0.0)) return;
  const bool whole = place_.part >= 1.0;
  const double h = place_.part * motion_.step();
  if (whole) {
    step().advance(d.state, d.force, d.end);
  } else {
    for (std::size_t k = 0; k < stops_.size(); ++k)
      parts_[k] = rule_.restricted(d.series[k], place_.part);
    advance(modes_, h, parts_, d.state, d.end);
  }
  if (!d.effect.moves_modes()) return;
  if (!whole) {
    d.effect.add_advance(h, place_.series, state_, d.end);
    return;
  }
  there_ = d.end;
  d.effect.step(motion_.step()).advance(state_, force_, there_);
  d.end.a += there_.a;
  d.end.rate += there_.rate;
}

void ModalSensitivities::peak(double part) {
  look(part);
  const Seen& seen = seen_[0];
  for (Direction& d : directions_) {
    state_here(d);
    const Struck s = struck(d, 0, d.end, place_.state);
    d.result.peak_force =
        seen.law.to_depth * s.depth + seen.law.to_rate * s.rate + law_slope(d, 0, seen);
  }
}

void ModalSensitivities::deepest(double part, double dissipated) {
  look(part);
  dissipated_at_deepest_ = dissipated;
  for (Direction& d : directions_) {
    state_here(d);
    const Struck s = struck(d, 0, d.end, place_.state);
    const double shift = -s.rate / seen_[0].acceleration;
    d.result.max_penetration = s.depth;
    d.compression = d.impulse + integral(d.force[0], part) + place_.force[0] * shift;
    d.dissipated_at_deepest = d.dissipated + integral(d.dissipation, part);
  }
}

/// Of what the sensor of a stop that gives way carries at the place, whose time is held.
double ModalSensitivities::sensor_slope(const Direction& d) const {
  const Eigen::Index head = modes_.modes() - 1;
  const ParameterEffect::SensorRow& change = d.effect.sensor_row();
  return sensor_row_.of_a * d.end.a[head] + sensor_row_.of_rate * d.end.rate[head] +
         change.of_a * place_.state.a[head] + change.of_rate * place_.state.rate[head];
}

void ModalSensitivities::note_sensor_peak() {
  if (!stopped_ || !stopped_->peak_part()) return;
  look(*stopped_->peak_part());
  for (Direction& d : directions_) {
    state_here(d);
    d.result.sensor_peak_force = sensor_slope(d);
  }
}

/// One sample: the state's slopes are in d.end.
void ModalSensitivities::show(Direction& d) const {
  History& history = d.result.history;
  for (std::size_t k = 0; k < stops_.size(); ++k) {
    const Seen& seen = seen_[k];
    const Struck s = struck(d, k, d.end, place_.state);
    const double moved_depth = s.depth - d.time * seen.rate;
    double force = 0.0;
    if (stops_[k].presses())
      force = seen.law.to_depth * moved_depth +
              seen.law.to_rate * (s.rate - d.time * seen.acceleration) + law_slope(d, k, seen);
    (k == 0 ? history.force : history.further[k - 1].force).push_back(force);
    (k == 0 ? history.penetration : history.further[k - 1].penetration).push_back(moved_depth);
  }
  double displacement =
      displacement_row_.dot(d.end.a) - d.time * displacement_row_.dot(place_.state.rate);
  double velocity = velocity_row_.dot(d.end.rate) - d.time * velocity_row_.dot(place_.acceleration);
  if (d.effect.moves_modes()) {
    displacement += d.effect.displacement_row().dot(place_.state.a);
    velocity += d.effect.velocity_row().dot(place_.state.rate);
  }
  history.velocity.push_back(velocity);
  history.displacement.push_back(displacement);
  if (!stopped_) return;
  const Eigen::Index head = modes_.modes() - 1;
  const double sensor_rate =
      sensor_row_.of_a * place_.state.rate[head] + sensor_row_.of_rate * place_.acceleration[head];
  history.sensor_force.push_back(sensor_slope(d) - d.time * sensor_rate);
}

void ModalSensitivities::sample(double first, double spacing, std::size_t count) {
  const double interval = options_.history.interval;
  const bool single = interval <= ModalStep::longest(modes_);
  if (single && !sampling_) sampling_.emplace(modes_, rule_, interval);
  for (std::size_t k = 0; k < count; ++k) {
    const double part = first + static_cast<double>(k) * spacing;
    if (k > 0 && single) {
      step_sample(part - spacing, spacing);
    } else {
      look(part);
      for (Direction& d : directions_) state_here(d);
    }
    for (Direction& d : directions_) show(d);
  }
}

/// From sample to sample, all slopes with the state.
void ModalSensitivities::step_sample(double from, double spacing) {
  bool pressed = false;
  for (const Pressed& stop : stops_) pressed = pressed || stop.presses();
  NodeMatrix values;  // of the step's Legendre polynomials at the sample's own nodes
  if (pressed) values = legendre_at(from, spacing);
  const auto go = [&](const ModalStep& by, const ModalState& state,
                      std::span<const NodeVector> series, ModalState& to) {
    if (!pressed) return by.coast(state, to);
    for (std::size_t k = 0; k < parts_.size(); ++k) parts_[k] = values * series[k];
    by.advance(state, parts_, to);
  };
  for (Direction& d : directions_) {
    scratch_ = d.end;
    go(*sampling_, d.end, d.series, scratch_);
    if (d.effect.moves_modes()) {
      there_ = scratch_;
      go(d.effect.step(sampling_->h()), place_.state, series_, there_);
      scratch_.a += there_.a;
      scratch_.rate += there_.rate;
    }
    std::swap(d.end, scratch_);
  }
  scratch_ = place_.state;
  go(*sampling_, place_.state, series_, scratch_);
  std::swap(place_.state, scratch_);
  NodeVector legendre(rule_.nodes());
  shifted_legendre(from + spacing, legendre);
  for (std::size_t k = 0; k < stops_.size(); ++k)
    place_.force[k] = stops_[k].presses() ? legendre.dot(series_[k]) : 0.0;
  accelerate();
}

/// The step's Legendre polynomials at the nodes of a part of it: (s, s), a row a node.
NodeMatrix ModalSensitivities::legendre_at(double from, double spacing) const {
  const int s = rule_.nodes();
  NodeMatrix values(s, s);
  NodeVector legendre(s);
  for (int i = 0; i < s; ++i) {
    shifted_legendre(from + rule_.points()[i] * spacing, legendre);
    values.row(i) = legendre;
  }
  return values;
}

/// Of the step's length, where its end is an event's: the state's slopes are in d.end.
double ModalSensitivities::end_shift(const Direction& d, End end, std::size_t stop) const {
  if (end == End::step) return 0.0;
  if (end == End::time) return -d.time;
  const Seen& seen = seen_[stop];
  const Struck s = struck(d, stop, d.end, place_.state);
  if (end == End::gap) return -s.depth / seen.rate;
  const ContactForce::Switch change = stops_[stop].contact->switching(seen.depth, seen.rate);
  const double slope = d.effect.law(static_cast<int>(stop)).of_switching(seen.depth, seen.rate) +
                       change.to_depth * s.depth + change.to_rate * s.rate +
                       change.to_speed * d.speed[stop];
  return -slope / (change.to_depth * seen.rate + change.to_rate * seen.acceleration);
}

void ModalSensitivities::take(double part, End end, int stop) {
  note_sensor_peak();
  look(part);
  const double power =
      stops_[0].contact ? stops_[0].contact->dissipation(seen_[0].depth, seen_[0].rate) : 0.0;
  for (Direction& d : directions_) {
    state_here(d);
    const double shift = end_shift(d, end, static_cast<std::size_t>(stop));
    d.end.a += shift * place_.state.rate;
    d.end.rate += shift * place_.acceleration;
    d.impulse += integral(d.force[0], part) + shift * place_.force[0];
    d.dissipated += integral(d.dissipation, part) + shift * power;
    d.time += shift;
    std::swap(d.state, d.end);
  }
}

void ModalSensitivities::separate(const Simulation& result) {
  see_state();
  const Episode& e = result.episodes.front();
  const Restitution& r = result.restitution;
  const ContactForce& contact = *stops_[0].contact;
  const double compression = e.impulse / (1.0 + r.kinetic);
  const double stored = contact.stored(e.max_penetration);
  const double work_in = stored + dissipated_at_deepest_;
  const double work_out = stored - (e.dissipated - dissipated_at_deepest_);
  for (Direction& d : directions_) {
    Sensitivity& to = d.result;
    to.duration = d.time;
    to.impulse = d.impulse;
    to.separation_velocity = -struck(d, 0, d.state, state_).rate;
    to.restitution.kinematic =
        (to.separation_velocity - r.kinematic * d.first_speed[0]) / e.approach_velocity;
    to.restitution.kinetic = (d.impulse - (1.0 + r.kinetic) * d.compression) / compression;
    const double stored_slope = contact.elastic(e.max_penetration) * to.max_penetration +
                                d.effect.law(0).of_stored(e.max_penetration);
    const double in_slope = stored_slope + d.dissipated_at_deepest;
    const double out_slope = stored_slope - (d.dissipated - d.dissipated_at_deepest);
    to.restitution.energetic =
        work_out > 0.0 ? 0.5 * r.energetic * (out_slope / work_out - in_slope / work_in) : 0.0;
  }
}

std::vector<Sensitivity> ModalSensitivities::take_results() {
  std::vector<Sensitivity> results;
  for (Direction& d : directions_) results.push_back(std::move(d.result));
  return results;
}

}  // namespace impactrig::models
