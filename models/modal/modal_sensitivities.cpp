// SPDX-License-Identifier: BSD-3-Clause
#include "models/modal/modal_sensitivities.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "models/history_recorder.hpp"
#include "models/make_beam.hpp"
#include "models/run_limits.hpp"

namespace impactrig::models {
namespace {

// Of a parameter's size, and of how far a bar's modes are moved: truncation and rounding of the
// stencil are both below 1e-9.
constexpr double parameter_step = 3e-4;
constexpr double mode_step = 1e-4;

Rig rig_at(const Rig& rig, RigParameter parameter, double change) {
  Rig there = rig;
  parameter(there) += change;
  return there;
}

/// How far a parameter may change for the rig to change by its like: its own size, for the radii of
/// a groove the little by which they differ, for places along the bar the way to the next.
double size_of(const Rig& rig, RigParameter parameter) {
  Rig copy = rig;
  const double* place = &parameter(copy);
  const double beyond = rig.beam.length - rig.contact.position;
  if ((place == &copy.contact.position || place == &copy.beam.length) && beyond > 0.0)
    return std::min(beyond, rig.contact.position);
  const bool of_groove = copy.contact.counterface == Counterface::groove &&
                         (place == &copy.contact.radius || place == &copy.contact.counter_radius);
  const double size =
      of_groove ? std::abs(copy.contact.counter_radius - copy.contact.radius) : std::abs(*place);
  return size > 0.0 ? size : 1.0;
}

/// A restitution coefficient keeps inside [0, 1].
Stencil stencil_for(const Rig& rig, RigParameter parameter, double spacing) {
  Rig copy = rig;
  if (&parameter(copy) != &copy.contact.restitution) return Stencil::centred();
  if (copy.contact.restitution + 2.0 * spacing > 1.0) return Stencil::backward();
  return copy.contact.restitution < 2.0 * spacing ? Stencil::forward() : Stencil::centred();
}

/// A sum that begins empty.
template <typename Matrix>
void add(double weight, const Matrix& part, Matrix& sum) {
  if (sum.size() == 0)
    sum = weight * part;
  else
    sum += weight * part;
}

Eigen::VectorXd row_of(const SmallMotionBeam& beam, double asked, double struck) {
  return beam.small_motion_row(asked > 0.0 ? asked : struck);
}

void make_unknown(Sensitivity& result) {
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  result.peak_force = result.max_penetration = result.duration = result.impulse =
      result.separation_velocity = unknown;
  result.restitution = {0.0, unknown, unknown, unknown};
}

}  // namespace

/// Σ weight value(place) / spacing over a direction's stencil.
template <typename Function>
double ModalSensitivities::slope_of(const Direction& d, double spacing, Function value_at) const {
  double sum = 0.0;
  for (std::size_t j = 0; j < d.stencil.weights.size(); ++j)
    if (d.stencil.weights[j] != 0.0) sum += d.stencil.weights[j] * value_at(j);
  return sum / spacing;
}

ModalSensitivities::ModalSensitivities(const Rig& rig, const Solver& solver,
                                       const SimulationOptions& options, const ModalMotion& motion)
    : rig_(rig),
      options_(options),
      motion_(motion),
      beam_(motion.beam()),
      rule_(motion.rule()) {
  for (const RigParameter parameter : options.sensitivities) {
    Direction& d = directions_.emplace_back();
    d.parameter = parameter;
    d.size = size_of(rig, parameter);
    d.spacing = parameter_step * d.size;
    d.stencil = stencil_for(rig, parameter, d.spacing);
    d.start_speed = slope_of(d, d.spacing, [&](std::size_t j) {
      const Rig there = rig_at(rig, parameter, d.stencil.offsets[j] * d.spacing);
      return touch_velocity(there) / there.contact.position;
    });
    find_contacts(rig, d);
    find_slope(rig, solver, options.history, d);
    make_unknown(d.result);
  }
}

void ModalSensitivities::find_contacts(const Rig& rig, Direction& d) const {
  if (!ContactForce(rig_at(rig, d.parameter, d.spacing)).differs(ContactForce(rig))) return;
  for (const double offset : d.stencil.offsets)
    d.contacts.emplace_back(rig_at(rig, d.parameter, offset * d.spacing));
  Rig copy = rig;
  const DampingForm form = d.contacts.front().form();
  const bool strength_apart =
      form == DampingForm::proportional || form == DampingForm::implicit;  // of the stiffness
  if (d.contacts.front().differs_by_strength(d.contacts.back()))
    d.law_change = LawChange::by_strength;
  else if (strength_apart && &d.parameter(copy) == &copy.contact.stiffness_factor)
    d.law_change = LawChange::by_factor;
}

/// Of the modes, where the parameter changes the bar.
void ModalSensitivities::find_slope(const Rig& rig, const Solver& solver,
                                    const HistoryRequest& history, Direction& d) const {
  const Rig other = rig_at(rig, d.parameter, d.spacing);
  if (other.beam == rig.beam && other.hinge == rig.hinge && other.gravity == rig.gravity &&
      other.gravity_direction == rig.gravity_direction &&
      other.contact.position == rig.contact.position)
    return;
  const std::unique_ptr<SmallMotionBeam> here = make_small_motion_beam(rig, solver);
  const BarChange change = change_of_bar(rig, solver, history, d);
  const double position = rig.contact.position;
  d.slope = beam_.slope(change.motion, change.damping, row_of(*here, 0.0, position), change.struck);
  const auto spot = [&](double asked, const Eigen::VectorXd& row_change) -> Eigen::VectorXd {
    return d.slope.shapes.transpose() * row_of(*here, asked, position) +
           beam_.shapes().transpose() * row_change;
  };
  d.velocity_row = spot(history.velocity_position, change.velocity);
  d.displacement_row = spot(history.displacement_position, change.displacement);
  const auto step_along = [](double size, const Eigen::VectorXd& slope) {
    const double largest = slope.cwiseAbs().maxCoeff();
    return largest > 0.0 ? mode_step * size / largest : std::numeric_limits<double>::infinity();
  };
  const auto largest_of = [](const Eigen::VectorXd& values) {
    return values.cwiseAbs().maxCoeff();
  };
  // a weightless rigid bar without a damper has no rate: then the parameter's own size has to do
  const double rate = std::max(beam_.fastest(), d.size * largest_of(d.slope.damping));
  d.bar_spacing = std::min({step_along(largest_of(beam_.omega()), d.slope.omega),
                            step_along(rate, d.slope.damping),
                            step_along(largest_of(beam_.struck()), d.slope.struck),
                            step_along(largest_of(beam_.rigid()), d.slope.rigid)});
  if (!std::isfinite(d.bar_spacing)) {
    d.slope = {};
    return;
  }
  for (const double offset : d.stencil.offsets)
    d.bars.push_back(beam_.moved(d.slope, offset * d.bar_spacing));
}

/// Of small motion, damping and the rows of struck point and lasers.
ModalSensitivities::BarChange ModalSensitivities::change_of_bar(const Rig& rig,
                                                                const Solver& solver,
                                                                const HistoryRequest& history,
                                                                const Direction& d) const {
  BarChange change;
  for (std::size_t j = 0; j < d.stencil.weights.size(); ++j) {
    const double weight = d.stencil.weights[j] / d.spacing;
    if (weight == 0.0) continue;
    const Rig there = rig_at(rig, d.parameter, d.stencil.offsets[j] * d.spacing);
    const std::unique_ptr<SmallMotionBeam> beam = make_small_motion_beam(there, solver);
    const double position = there.contact.position;
    change.add(weight, beam->small_motion(), ViscousDamping::of(there));
    add(weight, row_of(*beam, 0.0, position), change.struck);
    add(weight, row_of(*beam, history.velocity_position, position), change.velocity);
    add(weight, row_of(*beam, history.displacement_position, position), change.displacement);
  }
  return change;
}

void ModalSensitivities::BarChange::add(double weight, const SmallMotion& other,
                                        const ViscousDamping& resisting) {
  models::add(weight, other.mass, motion.mass);
  models::add(weight, other.stiffness, motion.stiffness);
  models::add(weight, other.gravity, motion.gravity);
  models::add(weight, other.hinge, motion.hinge);
  models::add(weight, other.rigid, motion.rigid);
  motion.spring += weight * other.spring;
  damping.mass += weight * resisting.mass;
  damping.stiffness += weight * resisting.stiffness;
  damping.hinge += weight * resisting.hinge;
}

const ModalStep& ModalSensitivities::slope_of_step(Direction& d, double h) const {
  const auto found = d.steps.find(h);
  if (found != d.steps.end()) return found->second;
  std::vector<ModalStep> steps;
  std::vector<double> weights;
  for (std::size_t j = 0; j < d.bars.size(); ++j) {
    if (d.stencil.weights[j] == 0.0) continue;
    steps.emplace_back(d.bars[j], rule_, h);
    weights.push_back(d.stencil.weights[j] / d.bar_spacing);
  }
  return d.steps.emplace(h, ModalStep::sum(steps, weights)).first->second;
}

/// Slopes of what the history shows before touch.
void ModalSensitivities::begin_history(const Rig& rig, const HistoryRequest& wanted,
                                       Direction& d) const {
  if (!(wanted.interval > 0.0)) return;
  History& sum = d.result.history;
  if (d.start_speed == 0.0 && d.bars.empty()) {  // what comes before touch does not change
    const long before = samples_before_touch(wanted);
    sum.start = -static_cast<double>(before) * wanted.interval;
    sum.interval = wanted.interval;
    for (const auto values :
         {&History::force, &History::penetration, &History::velocity, &History::displacement})
      (sum.*values).resize(static_cast<std::size_t>(before) + 1, 0.0);
    return;
  }
  for (std::size_t j = 0; j < d.stencil.weights.size(); ++j) {
    const Rig there = rig_at(rig, d.parameter, d.stencil.offsets[j] * d.spacing);
    const double speed = touch_velocity(there);
    const auto speed_at = [&](double x) {
      return x > 0.0 ? speed * x / there.contact.position : speed;
    };
    History lead;
    models::begin_history(there, wanted, speed, speed_at(wanted.velocity_position),
                          speed_at(wanted.displacement_position), lead);
    sum.start = lead.start;
    sum.interval = lead.interval;
    for (const auto values :
         {&History::force, &History::penetration, &History::velocity, &History::displacement}) {
      (sum.*values).resize((lead.*values).size(), 0.0);
      for (std::size_t k = 0; k < (lead.*values).size(); ++k)
        (sum.*values)[k] += d.stencil.weights[j] / d.spacing * (lead.*values)[k];
    }
  }
}

void ModalSensitivities::begin() {
  const double rate = touch_velocity(rig_) / rig_.contact.position;
  for (Direction& d : directions_) {
    d.state.a = Eigen::VectorXd::Zero(beam_.modes());
    d.state.rate = beam_.rigid() * d.start_speed;
    if (!d.bars.empty()) d.state.rate += d.slope.rigid * rate;
    d.end = d.state;
    begin_history(rig_, options_.history, d);
  }
}

void ModalSensitivities::touch(const ContactForce& contact, double speed, bool first) {
  contact_ = &contact;
  const bool grazing = contact.law_speed() > speed * (1.0 + 1e-12);
  for (Direction& d : directions_) {
    const double slope = struck(d, d.state, motion_.state()).rate;
    if (first) d.first_speed = slope;
    if (contact.speed_is_stated())
      d.speed = 0.0;
    else if (contact.keeps_first_speed())
      d.speed = d.first_speed;
    else
      d.speed = grazing ? grazing_fraction * d.first_speed : slope;
    for (ContactForce& there : d.contacts) there.begin_episode(contact.law_speed());
    if (d.law_change == LawChange::by_strength)
      d.strength = slope_of(d, d.spacing, [&](std::size_t j) { return d.contacts[j].strength(); });
  }
}

ModalSensitivities::Struck ModalSensitivities::struck(const Direction& d, const ModalState& slope,
                                                      const ModalState& state) const {
  Struck s{beam_.struck().dot(slope.a), beam_.struck().dot(slope.rate)};
  if (d.bars.empty()) return s;
  s.depth += d.slope.struck.dot(state.a);
  s.rate += d.slope.struck.dot(state.rate);
  return s;
}

/// Of the pressing force, penetration and rate held.
double ModalSensitivities::law_slope(const Direction& d, double depth, double rate,
                                     const ContactForce::Response& law) const {
  const auto own = [&] {
    if (d.contacts.empty()) return 0.0;
    if (d.law_change == LawChange::by_strength) return law.to_strength * d.strength;
    if (d.law_change == LawChange::by_factor) return law.force / rig_.contact.stiffness_factor;
    return slope_of(d, d.spacing,
                    [&](std::size_t j) { return d.contacts[j].pressed(depth, rate).force; });
  };
  return own() + contact_->to_speed(law) * d.speed;
}

/// Of the function whose zero ends the phase, where the struck point's motion has these slopes.
double ModalSensitivities::switch_slope(Direction& d, const ContactForce::Switch& there,
                                        double depth, double rate, const Struck& slope) const {
  const double own = d.contacts.empty() ? 0.0 : slope_of(d, d.spacing, [&](std::size_t j) {
    return d.contacts[j].switching(depth, rate).value;
  });
  return own + there.to_depth * slope.depth + there.to_rate * slope.rate + there.to_speed * d.speed;
}

void ModalSensitivities::solve(const NodeVector& force, const NodeVector& displacement,
                               const NodeVector& velocity) {
  const int s = rule_.nodes();
  const BarMotion::Response& response = motion_.modal_step().response().of_force;
  force_ = force;
  force_series_ = rule_.to_series() * force;
  for (Direction& d : directions_)
    for (ContactForce& there : d.contacts) there.set_phase(contact_->phase());
  laws_.clear();
  if (contact_->phase() != ContactForce::Phase::free)
    for (int i = 0; i < s; ++i)
      laws_.push_back({displacement[i], velocity[i], contact_->elastic(displacement[i]),
                       contact_->pressed(displacement[i], velocity[i])});
  if (contact_->presses()) {
    NodeMatrix jacobian = NodeMatrix::Identity(s, s);
    for (int i = 0; i < s; ++i) {
      const ContactForce::Response& law = laws_[static_cast<std::size_t>(i)].law;
      jacobian.row(i) -= law.to_depth * response.displacement_of_force.row(i) +
                         law.to_rate * response.velocity_of_force.row(i);
    }
    inverse_ = jacobian.inverse();
  }
  for (Direction& d : directions_) solve(d);
}

/// Struck point and force at the nodes; then what the contact dissipates there.
void ModalSensitivities::solve(Direction& d) {
  const int s = rule_.nodes();
  d.force.setZero(s);
  d.force_series.setZero(s);
  d.dissipation.setZero(s);
  if (laws_.empty()) return;
  const ModalStep& step = motion_.modal_step();
  const ModalState& state = motion_.state();
  const ModalStep::Response& r = step.response();
  NodeVector depth = r.displacement_of_a * d.state.a + r.displacement_of_rate * d.state.rate;
  NodeVector rate = r.velocity_of_a * d.state.a + r.velocity_of_rate * d.state.rate;
  if (!d.bars.empty()) {
    const ModalStep::Response& slope = slope_of_step(d, step.h()).response();
    depth += slope.displacement_of_a * state.a + slope.displacement_of_rate * state.rate +
             slope.of_force.displacement_of_force * force_;
    rate += slope.velocity_of_a * state.a + slope.velocity_of_rate * state.rate +
            slope.of_force.velocity_of_force * force_;
  }
  if (contact_->presses()) {
    NodeVector drive(s);
    for (int i = 0; i < s; ++i) {
      const NodeLaw& there = laws_[static_cast<std::size_t>(i)];
      drive[i] = there.law.to_depth * depth[i] + there.law.to_rate * rate[i] +
                 law_slope(d, there.displacement, there.velocity, there.law);
    }
    d.force = inverse_ * drive;
    depth += r.of_force.displacement_of_force * d.force;
    rate += r.of_force.velocity_of_force * d.force;
  }
  d.force_series = rule_.to_series() * d.force;
  for (int i = 0; i < s; ++i)
    d.dissipation[i] = dissipation_slope(d, laws_[static_cast<std::size_t>(i)], depth[i], rate[i]);
}

double ModalSensitivities::dissipation_slope(Direction& d, const NodeLaw& there, double depth,
                                             double rate) const {
  const auto& [displacement, velocity, elastic, law] = there;
  double own = 0.0;
  if (!d.contacts.empty())
    own = slope_of(d, d.spacing, [&](std::size_t j) {
      return d.contacts[j].dissipation(there.displacement, there.velocity);
    });
  if (contact_->phase() == ContactForce::Phase::slack)
    return own - law.stiffness * velocity * depth - elastic * rate;
  // of (f − f_0) δ̇
  return own + (law.to_depth - law.stiffness) * velocity * depth +
         (law.force - elastic + law.to_rate * velocity) * rate +
         contact_->to_speed(law) * velocity * d.speed;
}

double ModalSensitivities::integral(const NodeVector& at_nodes, double part) const {
  const double h = motion_.step();
  if (part >= 1.0) return h * rule_.weights().dot(at_nodes);
  const NodeVector series = rule_.to_series() * at_nodes;
  return part * h * rule_.restricted(series, part)[0];
}

void ModalSensitivities::look(double part, Place& place) const {
  place.part = part;
  place.series = rule_.restricted(force_series_, part);
  place.force = place.series.sum();
  place.state = motion_.state();
  if (part >= 1.0) {
    motion_.modal_step().advance(motion_.state(), force_, place.state);
  } else if (part > 0.0) {
    advance(beam_, part * motion_.step(), place.series, motion_.state(), place.state);
  }
  accelerate(place);
}

void ModalSensitivities::accelerate(Place& place) const {
  place.acceleration = -beam_.omega().cwiseAbs2().cwiseProduct(place.state.a) -
                       beam_.damping().cwiseProduct(place.state.rate) -
                       beam_.struck() * place.force;
}

/// The state's slope there, at the same time from the step's beginning.
void ModalSensitivities::state_at(const Place& place, Direction& d, ModalState& to) {
  to = d.state;
  if (!(place.part > 0.0)) return;
  const bool whole = place.part >= 1.0;
  const double h = place.part * motion_.step();
  if (whole)
    motion_.modal_step().advance(d.state, d.force, to);
  else
    advance(beam_, h, rule_.restricted(d.force_series, place.part), d.state, to);
  if (d.bars.empty()) return;
  there_ = to;
  if (whole) {
    slope_of_step(d, motion_.step()).advance(motion_.state(), force_, there_);
    to.a += there_.a;
    to.rate += there_.rate;
    return;
  }
  for (std::size_t j = 0; j < d.bars.size(); ++j) {
    const double weight = d.stencil.weights[j] / d.bar_spacing;
    if (weight == 0.0) continue;
    advance(d.bars[j], h, place.series, motion_.state(), there_);
    to.a += weight * there_.a;
    to.rate += weight * there_.rate;
  }
}

void ModalSensitivities::peak(double part) {
  look(part, place_);
  const double depth = beam_.struck().dot(place_.state.a);
  const double rate = beam_.struck().dot(place_.state.rate);
  const ContactForce::Response law = contact_->pressed(depth, rate);
  for (Direction& d : directions_) {
    state_at(place_, d, d.end);
    const Struck s = struck(d, d.end, place_.state);
    d.result.peak_force =
        law.to_depth * s.depth + law.to_rate * s.rate + law_slope(d, depth, rate, law);
  }
}

void ModalSensitivities::deepest(double part, double dissipated) {
  look(part, place_);
  dissipated_at_deepest_ = dissipated;
  const double acceleration = beam_.struck().dot(place_.acceleration);
  for (Direction& d : directions_) {
    state_at(place_, d, d.end);
    const Struck s = struck(d, d.end, place_.state);
    const double shift = -s.rate / acceleration;
    d.result.max_penetration = s.depth;
    d.compression = d.impulse + integral(d.force, part) + place_.force * shift;
    d.dissipated_at_deepest = d.dissipated + integral(d.dissipation, part);
  }
}

/// What the sensors of the undisturbed run see at a place, as far as the slopes need it.
ModalSensitivities::Seen ModalSensitivities::see(const Place& place) const {
  Seen seen;
  seen.rate = beam_.struck().dot(place.state.rate);
  seen.displacement_rate = motion_.displacement_row().dot(place.state.rate);
  seen.velocity_rate = motion_.velocity_row().dot(place.acceleration);
  if (!contact_->presses()) return seen;
  seen.depth = beam_.struck().dot(place.state.a);
  seen.acceleration = beam_.struck().dot(place.acceleration);
  seen.law = contact_->pressed(seen.depth, seen.rate);
  return seen;
}

/// One sample: the state's slopes are in d.end.
void ModalSensitivities::show(const Place& place, const Seen& seen, Direction& d) const {
  const Struck s = struck(d, d.end, place.state);
  const double moved_depth = s.depth - d.time * seen.rate;
  History& history = d.result.history;
  double force = 0.0;
  if (contact_->presses())
    force = seen.law.to_depth * moved_depth +
            seen.law.to_rate * (s.rate - d.time * seen.acceleration) +
            law_slope(d, seen.depth, seen.rate, seen.law);
  double displacement = motion_.displacement_row().dot(d.end.a) - d.time * seen.displacement_rate;
  double velocity = motion_.velocity_row().dot(d.end.rate) - d.time * seen.velocity_rate;
  if (!d.bars.empty()) {
    displacement += d.displacement_row.dot(place.state.a);
    velocity += d.velocity_row.dot(place.state.rate);
  }
  history.force.push_back(force);
  history.penetration.push_back(moved_depth);
  history.velocity.push_back(velocity);
  history.displacement.push_back(displacement);
}

void ModalSensitivities::sample(double first, double spacing, std::size_t count) {
  const double interval = options_.history.interval;
  const bool single = interval <= ModalStep::longest(beam_);
  if (single && !sampling_) sampling_.emplace(beam_, rule_, interval);
  look(first, place_);
  for (Direction& d : directions_) state_at(place_, d, d.end);
  for (std::size_t k = 0; k < count; ++k) {
    const double part = first + static_cast<double>(k) * spacing;
    if (k > 0 && single) step_sample(part - spacing, spacing);
    if (k > 0 && !single) {
      look(part, place_);
      for (Direction& d : directions_) state_at(place_, d, d.end);
    }
    const Seen seen = see(place_);
    for (Direction& d : directions_) show(place_, seen, d);
  }
}

/// From sample to sample, all slopes with the state.
void ModalSensitivities::step_sample(double from, double spacing) {
  const bool pressed = contact_->presses();
  NodeMatrix values;  // of the step's Legendre polynomials at the sample's own nodes
  if (pressed) values = legendre_at(from, spacing);
  const auto step = [&](const ModalStep& by, const ModalState& state, const NodeVector& series,
                        ModalState& to) {
    if (pressed)
      by.advance(state, values * series, to);
    else
      by.coast(state, to);
  };
  for (Direction& d : directions_) {
    step(*sampling_, d.end, d.force_series, scratch_);
    if (!d.bars.empty()) {
      step(slope_of_step(d, sampling_->h()), place_.state, force_series_, there_);
      scratch_.a += there_.a;
      scratch_.rate += there_.rate;
    }
    std::swap(d.end, scratch_);
  }
  step(*sampling_, place_.state, force_series_, scratch_);
  std::swap(place_.state, scratch_);
  place_.force = 0.0;
  if (pressed) {
    NodeVector legendre(rule_.nodes());
    shifted_legendre(from + spacing, legendre);
    place_.force = legendre.dot(force_series_);
  }
  accelerate(place_);
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

void ModalSensitivities::take(double part, End end) {
  look(part, place_);
  const double rate = beam_.struck().dot(place_.state.rate);
  const double acceleration = beam_.struck().dot(place_.acceleration);
  const double depth = beam_.struck().dot(place_.state.a);
  const double power = contact_->dissipation(depth, rate);
  ContactForce::Switch change;
  if (end == End::change) change = contact_->switching(depth, rate);
  for (Direction& d : directions_) {
    state_at(place_, d, d.end);
    const Struck s = struck(d, d.end, place_.state);
    double shift = 0.0;  // slope of the step's length
    if (end == End::gap) shift = -s.depth / rate;
    if (end == End::change)
      shift = -switch_slope(d, change, depth, rate, s) /
              (change.to_depth * rate + change.to_rate * acceleration);
    if (end == End::time) shift = -d.time;
    d.end.a += shift * place_.state.rate;
    d.end.rate += shift * place_.acceleration;
    d.impulse += integral(d.force, part) + shift * place_.force;
    d.dissipated += integral(d.dissipation, part) + shift * power;
    d.time += shift;
    std::swap(d.state, d.end);
  }
}

void ModalSensitivities::separate(const Simulation& result) {
  const Episode& e = result.episodes.front();
  const Restitution& r = result.restitution;
  const double compression = e.impulse / (1.0 + r.kinetic);
  const double stored = contact_->stored(e.max_penetration);
  const double work_in = stored + dissipated_at_deepest_;
  const double work_out = stored - (e.dissipated - dissipated_at_deepest_);
  for (Direction& d : directions_) {
    Sensitivity& to = d.result;
    to.duration = d.time;
    to.impulse = d.impulse;
    to.separation_velocity = -struck(d, d.state, motion_.state()).rate;
    to.restitution.kinematic =
        (to.separation_velocity - r.kinematic * d.first_speed) / e.approach_velocity;
    to.restitution.kinetic = (d.impulse - (1.0 + r.kinetic) * d.compression) / compression;
    double stored_slope = contact_->elastic(e.max_penetration) * to.max_penetration;
    if (!d.contacts.empty())
      stored_slope += slope_of(
          d, d.spacing, [&](std::size_t j) { return d.contacts[j].stored(e.max_penetration); });
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
