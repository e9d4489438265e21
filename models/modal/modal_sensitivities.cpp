// SPDX-License-Identifier: BSD-3-Clause
#include "models/modal/modal_sensitivities.hpp"

#include <cmath>
#include <memory>
#include <utility>

#include "models/lanes/product_lanes.hpp"

namespace impactrig::models {
namespace {

// A swing takes hundreds of the bar's vibrations, whose phases as it arrives change as many times
// as much as their frequencies.
constexpr double closer_for_phases = 1e-3;

/// How a bar that was let go begins, against where the load holds its modes.
ModalState arrived(const Rig& rig, const ModalBeam& modes) {
  const Arrival arrival = arrive(rig, modes);
  return {modes.rigid() * arrival.angle + arrival.bending.a - ModalLoad(modes).held(),
          modes.rigid() * arrival.rate + arrival.bending.rate};
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
    : RunSensitivities(rig, options, motion, stopped),
      motion_(motion),
      with_head_(with_head(rig, motion.beam())),
      modes_(with_head_ ? *with_head_ : motion.beam()),
      load_(modes_),
      longest_sample_(ModalStep::longest(modes_)),
      velocity_row_(widened(motion.velocity_row(), modes_.modes())),
      displacement_row_(widened(motion.displacement_row(), modes_.modes())),
      parts_(static_cast<std::size_t>(rig.stops())) {
  for (int stop = 0; stop < rig.stops(); ++stop)
    held_at_.push_back(modes_.struck(stop).dot(load_.held()));
  if (rig.stop) sensor_row_ = ParameterEffect::SensorRow::of(*rig.stop);
  state_.a = state_.rate = Eigen::VectorXd::Zero(modes_.modes());
  for (const RigParameter parameter : options.sensitivities) {
    auto effect = std::make_unique<ParameterEffect>(rig, solver, options.history, parameter,
                                                    motion.beam(), modes_, rule_);
    double held = 0.0;
    if (effect->moves_modes())
      held = effect->displacement_row().dot(load_.held()) + displacement_row_.dot(effect->held());
    of_.push_back({*effect, held, {}, {}});
    add(std::move(effect));
  }
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

void ModalSensitivities::start() {
  const double rate = touch_velocity(rig_) / rig_.contact.position;
  for (Modes& m : of_) {
    if (motion_.arrival()) {
      const ParameterStencil by = m.effect.by().closer(closer_for_phases);
      m.state.a = m.state.rate = Eigen::VectorXd::Zero(modes_.modes());
      for (std::size_t place = 0; place < ParameterStencil::places; ++place) {
        if (!by.counts(place)) continue;
        const ModalState there =
            m.effect.moves_modes()
                ? arrived(by.rig_at(place), modes_.moved(m.effect.modes(), by.offset(place)))
                : arrived(by.rig_at(place), modes_);
        m.state.a += by.weight(place) * there.a;
        m.state.rate += by.weight(place) * there.rate;
      }
      m.end = m.state;
      continue;
    }
    m.state.a = Eigen::VectorXd::Zero(modes_.modes());
    m.state.rate = modes_.rigid() * m.effect.start_rate();
    if (m.effect.moves_modes()) {
      m.state.a -= m.effect.held();
      m.state.rate += m.effect.modes().rigid * rate;
    }
    m.end = m.state;
  }
}

/// Displacements are shown from where their spot is at touch.
void ModalSensitivities::begin_more(int i) {
  const Modes& m = of_[static_cast<std::size_t>(i)];
  double& rest = direction(i).rest;
  rest = displacement_row_.dot(m.state.a);
  if (m.effect.moves_modes())
    rest += m.effect.displacement_row().dot(state_.a) + m.displacement_held;
}

PointMotion ModalSensitivities::struck(const Modes& m, std::size_t stop, const ModalState& slope,
                                       const ModalState& state) const {
  const auto number = static_cast<int>(stop);
  const Eigen::VectorXd& row = modes_.struck(number);
  PointMotion s{dot(row, slope.a), dot(row, slope.rate)};
  if (!m.effect.moves_modes()) return s;
  s.displacement += dot(m.effect.struck(number), state.a) + m.effect.held_at(number);
  s.velocity += dot(m.effect.struck(number), state.rate);
  return s;
}

PointMotion ModalSensitivities::struck(int i, std::size_t stop) const {
  const Modes& m = of_[static_cast<std::size_t>(i)];
  return struck(m, stop, m.state, state_);
}

PointMotion ModalSensitivities::struck_at_place(int i, std::size_t stop) const {
  const Modes& m = of_[static_cast<std::size_t>(i)];
  return struck(m, stop, m.end, here_);
}

/// Of the points before the stops that touch, without what the forces' slopes do.
void ModalSensitivities::find_free_slopes(int i) {
  const Modes& m = of_[static_cast<std::size_t>(i)];
  const ModalStep* change = m.effect.moves_modes() ? &m.effect.step(motion_.step()) : nullptr;
  NodeVector depth, rate;
  for (std::size_t p = 0; p < stops_.size(); ++p) {
    Pressed& stop = stops_[p];
    if (stop.laws.empty()) continue;
    const auto number = static_cast<int>(p);
    step().coast(number, m.state, stop.depth, stop.rate);
    stop.depth.array() -= m.effect.law(number).gap();
    if (!change) continue;
    change->coast(number, state_, depth, rate);
    stop.depth += depth;
    stop.rate += rate;
    add_load(m, number, stop);
    for (std::size_t q = 0; q < stops_.size(); ++q) {
      if (force_[q].isZero(0.0)) continue;
      const BarMotion::Response& response = change->response(number, static_cast<int>(q));
      stop.depth += response.displacement_of_force * force_[q];
      stop.rate += response.velocity_of_force * force_[q];
    }
  }
}

/// What the load's slopes do to the point before a stop at the nodes.
void ModalSensitivities::add_load(const Modes& m, int number, Pressed& stop) const {
  const double of_pendulum = modes_.struck(number)[0], its_slope = m.effect.struck(number)[0];
  for (int i = 0; i < rule_.nodes(); ++i) {
    const double time = rule_.points()[i] * motion_.step();
    const ModalLoad::Fall fall = load_.fall(time), slope = m.effect.fall(time);
    stop.depth[i] += m.effect.held_at(number) + of_pendulum * slope.a + its_slope * fall.a;
    stop.rate[i] += of_pendulum * slope.rate + its_slope * fall.rate;
  }
}

bool ModalSensitivities::solve(int i) {
  const int s = rule_.nodes();
  Direction& d = direction(i);
  find_free_slopes(i);
  drive_laws(d);
  if (drive_.size() > 0) answer_.noalias() = inverse_ * drive_;
  Pressed& first = stops_[0];
  for (std::size_t q = 0; q < stops_.size(); ++q) {
    d.force[q].setZero(s);
    if (!stops_[q].presses()) continue;
    d.force[q] = answer_.segment(stops_[q].first_row, s);
    if (first.laws.empty()) continue;
    const BarMotion::Response& answer = response(0, static_cast<int>(q));
    first.depth += answer.displacement_of_force * d.force[q];
    first.rate += answer.velocity_of_force * d.force[q];
  }
  return true;
}

void ModalSensitivities::go_to_place() {
  here_ = state_;
  if (place_.part >= 1.0)
    step().advance(state_, force_, here_);
  else if (place_.part > 0.0)
    advance(modes_, place_.part * motion_.step(), place_.series, state_, here_);
  load_.fall(place_.part * motion_.step()).add_to(here_);
  accelerate();
}

void ModalSensitivities::accelerate() {
  acceleration_ =
      -modes_.omega().cwiseAbs2().cwiseProduct(here_.a) - modes_.damping().cwiseProduct(here_.rate);
  acceleration_[0] += load_.pull();
  for (std::size_t k = 0; k < stops_.size(); ++k)
    acceleration_ -= modes_.struck(static_cast<int>(k)) * place_.force[k];
  velocity_rate_ = dot(velocity_row_, acceleration_);
  displacement_rate_ = dot(displacement_row_, here_.rate);
}

RunSensitivities::Passing ModalSensitivities::passing(std::size_t stop) const {
  const Eigen::VectorXd& row = modes_.struck(static_cast<int>(stop));
  return {dot(row, here_.a) + held_at_[stop], dot(row, here_.rate), dot(row, acceleration_)};
}

/// The state's slope at the place, at the same time from the step's beginning.
void ModalSensitivities::follow_to_place(int i) {
  Modes& m = of_[static_cast<std::size_t>(i)];
  const Direction& d = direction(i);
  m.end = m.state;
  if (!(place_.part > 0.0)) return;
  const bool whole = place_.part >= 1.0;
  const double h = place_.part * motion_.step();
  if (whole) {
    step().advance(m.state, d.force, m.end);
  } else {
    for (std::size_t k = 0; k < stops_.size(); ++k)
      parts_[k] = rule_.restricted(d.series[k], place_.part);
    advance(modes_, h, parts_, m.state, m.end);
  }
  if (!m.effect.moves_modes()) return;
  m.effect.fall(h).add_to(m.end);
  if (!whole) {
    m.effect.add_advance(h, place_.series, state_, m.end);
    return;
  }
  there_ = m.end;
  m.effect.step(motion_.step()).advance(state_, force_, there_);
  m.end.a += there_.a;
  m.end.rate += there_.rate;
}

void ModalSensitivities::move_on(int i, double shift) {
  Modes& m = of_[static_cast<std::size_t>(i)];
  m.end.a += shift * here_.rate;
  m.end.rate += shift * acceleration_;
  std::swap(m.state, m.end);
}

/// Of what the sensor of a stop that gives way carries at the place, whose time is held.
double ModalSensitivities::sensor_slope(const Modes& m) const {
  const Eigen::Index head = modes_.modes() - 1;
  const ParameterEffect::SensorRow& change = m.effect.sensor_row();
  return sensor_row_.of_a * m.end.a[head] + sensor_row_.of_rate * m.end.rate[head] +
         change.of_a * here_.a[head] + change.of_rate * here_.rate[head];
}

RunSensitivities::Spots ModalSensitivities::spots(int i) const {
  const Modes& m = of_[static_cast<std::size_t>(i)];
  Spots spots{.velocity = dot(velocity_row_, m.end.rate),
              .displacement = dot(displacement_row_, m.end.a),
              .velocity_rate = velocity_rate_,
              .displacement_rate = displacement_rate_};
  if (m.effect.moves_modes()) {
    spots.velocity += dot(m.effect.velocity_row(), here_.rate);
    spots.displacement += dot(m.effect.displacement_row(), here_.a) + m.displacement_held;
  }
  if (!stopped_) return spots;
  const Eigen::Index head = modes_.modes() - 1;
  spots.sensor_force = sensor_slope(m);
  spots.sensor_force_rate =
      sensor_row_.of_a * here_.rate[head] + sensor_row_.of_rate * acceleration_[head];
  return spots;
}

void ModalSensitivities::go_to_sample(double part, double spacing, bool first) {
  const double interval = options_.history.interval;
  const bool single = interval <= longest_sample_;
  if (!single || first) return RunSensitivities::go_to_sample(part, spacing, first);
  if (!sampling_) sampling_.emplace(modes_, rule_, interval);
  step_sample(part - spacing, spacing);
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
  for (int i = 0; i < count(); ++i) {
    Modes& m = of_[static_cast<std::size_t>(i)];
    scratch_ = m.end;
    go(*sampling_, m.end, direction(i).series, scratch_);
    if (m.effect.moves_modes()) {
      there_ = scratch_;
      go(m.effect.step(sampling_->h()), here_, series_, there_);
      scratch_.a += there_.a;
      scratch_.rate += there_.rate;
      m.effect.fall(sampling_->h()).add_to(scratch_);
    }
    std::swap(m.end, scratch_);
  }
  scratch_ = here_;
  go(*sampling_, here_, series_, scratch_);
  load_.fall(sampling_->h()).add_to(scratch_);
  std::swap(here_, scratch_);
  NodeVector legendre(rule_.nodes());
  shifted_legendre(from + spacing, legendre);
  for (std::size_t k = 0; k < stops_.size(); ++k)
    place_.force[k] = stops_[k].presses() ? legendre.dot(series_[k]) : 0.0;
  accelerate();
  see_points();
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

}  // namespace impactrig::models
