// SPDX-License-Identifier: BSD-3-Clause
#include "models/stop/stopped_motion.hpp"

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>
#include <utility>

#include "models/stop/stopped_slope.hpp"

namespace impactrig::models {
namespace {

// Phase between two looks at the sensor's force, and what it may rise between them: at the nodes of
// a collocation rule they may be twice as far apart.
constexpr double look_phase = 0.5;
constexpr double rise_between = 1.3;
// Of the largest force so far, what is told of forces from the second touch on.
constexpr double rival_part = 0.5;

}  // namespace

StoppedMotion::StoppedMotion(BarMotion& bar, const Stop& stop)
    : bar_(bar),
      rule_(bar.rule()),
      head_(stop),
      compliance_(1.0 / stop.stiffness) {
  displacement_ = velocity_ = power_ = force_series_ = NodeVector::Zero(rule_.nodes());
}

void StoppedMotion::start(double angle, double rate) {
  bar_.start(angle, rate);
  state_ = end_ = {};
  in_contact_ = false;
}

void StoppedMotion::set_scales(const Scales& scales) {
  Scales of_bar = scales;
  of_bar.magnification = std::max(1.0, head_.magnification(scales.contact_time));
  bar_.set_scales(of_bar);
  energy_scale_ = scales.energy;
  force_scale_ = std::min({std::sqrt(2.0 * scales.energy / compliance_), scales.force,
                           scales.impulse * head_.mode().omega});
  contact_damps_ = scales.damping > 0.0;
}

/// A damped contact lets the head's ringing die, on the sensor's spring and on its own; nodes too
/// few to see it would keep it, or swing it up.
double StoppedMotion::longest_step() const {
  constexpr double phase_of_node = 1.5;
  double longest = bar_.longest_step();
  if (responds_always_) longest = std::min(longest, HeadStep::longest_phase / head_.fastest());
  if (!in_contact_ || !contact_damps_) return longest;
  const double ringing =
      std::max(head_.fastest(),
               std::hypot(head_.mode().omega, std::sqrt(contact_stiffness_ / head_.mass())));
  return std::min(longest, phase_of_node * rule_.nodes() / ringing);
}

BeamEnergy StoppedMotion::energy() const {
  BeamEnergy energy = bar_.energy();
  energy.stop = head_.energy(state_);
  return energy;
}

void StoppedMotion::expect_contact(int stop, double displacement) {
  if (!in_contact_) ++contacts_;
  in_contact_ = touched_ = true;
  bar_.expect_contact(stop, stop == 0 ? displacement + state_.displacement : displacement);
}

void StoppedMotion::expect_flight() {
  in_contact_ = false;
  bar_.expect_flight();
}

void StoppedMotion::begin_step(int level) {
  bar_.begin_step(level);
  prepare();
}

void StoppedMotion::begin_part(double part) {
  bar_.begin_part(part);
  prepare();
}

void StoppedMotion::prepare() {
  const double h = bar_.step();
  const auto found =
      std::ranges::find_if(steps_, [&](const HeadStep& step) { return step.h() == h; });
  if (found != steps_.end()) {
    step_ = &*found;
  } else {
    steps_[next_step_] = HeadStep(head_, rule_, h);
    step_ = &steps_[next_step_];
    next_step_ = (next_step_ + 1) % kept_steps;
  }
  if (!step_->responds()) return;
  const Response& bar = bar_.response(0, 0);
  response_.displacement_of_force = bar.displacement_of_force - step_->displacement_of_force();
  response_.velocity_of_force = bar.velocity_of_force - step_->velocity_of_force();
  response_.set_most();
}

bool StoppedMotion::improve(std::span<StopStep> stops) {
  if (in_contact_ && !step_->responds()) return false;
  if (!bar_.improve(stops)) return false;
  const NodeVector& force = stops[0].force;
  step_->coast(state_, displacement_, velocity_);
  if (!force.isZero(0.0)) {
    displacement_.noalias() += step_->displacement_of_force() * force;
    velocity_.noalias() += step_->velocity_of_force() * force;
  }
  stops[0].displacement -= displacement_;
  stops[0].velocity -= velocity_;
  return true;
}

void StoppedMotion::finish(std::span<const StopStep> stops) {
  bar_.finish(stops);
  const NodeVector& force = stops[0].force;
  forced_ = !force.isZero(0.0);
  force_series_ = stops[0].force_series;
  if (!forced_) {
    end_ = step_->coasted(state_);
    return;
  }
  end_ = step_->advanced(state_, force);
  step_->coast(state_, displacement_, velocity_);
  displacement_.noalias() += step_->displacement_of_force() * force;
  velocity_.noalias() += step_->velocity_of_force() * force;
  for (int i = 0; i < rule_.nodes(); ++i)
    power_[i] = head_.damping_power({displacement_[i], velocity_[i]});
}

/// Of a free head what it has less; under a force by the powers at the nodes.
double StoppedMotion::damped(double part) const {
  double taken = 0.0;
  if (head_.damped() && !forced_) {
    const State after = part < 1.0 ? head_at(part) : end_;
    taken = head_.energy(state_) - head_.energy(after);
  } else if (head_.damped()) {
    const NodeVector series = rule_.restricted(rule_.to_series() * power_, part);
    taken = part * step() * series[0];
  }
  return bar_.damped(part) + taken;
}

/// Also of the sensor's force: what the contact's leaves out swings the head the more, the more of
/// a swing a step is, up to one a node.
double StoppedMotion::error() const {
  if (!forced_) return bar_.error();
  const double phase = head_.fastest() * step();
  const int s = rule_.nodes();
  const double swung = std::min(phase, 1.0 * s) * std::min(1.0, phase / s);
  const double force = swung * truncation(force_series_) / force_scale_;
  const double loss = truncation(rule_.to_series() * power_) * step() / energy_scale_;
  return std::max({bar_.error(), force, head_.damped() ? loss : 0.0});
}

/// Within the solved step.
StopHead::State StoppedMotion::head_at(double part) const {
  if (part == 0.0) return state_;
  if (!forced_) return head_.coasted(state_, part * step());
  const HeadStep jump(head_, rule_, part * step(), false);
  return jump.advanced(state_, force_between(0.0, part));
}

PointMotion StoppedMotion::struck_at(int stop, double part, double* acceleration) {
  const PointMotion bar = bar_.struck_at(stop, part, acceleration);
  if (stop > 0) return bar;
  const State head = head_at(part);
  if (acceleration) *acceleration -= head_.acceleration(head, forced_ ? force_at(part) : 0.0);
  return seen(bar, head);
}

/// From sample to sample by steps of their own, under the force as the step has it.
void StoppedMotion::sample(double first, double spacing, std::span<Sample> samples) {
  bar_.sample(first, spacing, samples);
  State head = step_ && first > 0.0 ? head_at(first) : state_;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    if (k > 0) {
      if (sampling_.h() != spacing * step())
        sampling_ = HeadStep(head_, rule_, spacing * step(), false);
      const double here = first + static_cast<double>(k) * spacing;
      head = forced_ ? sampling_.advanced(head, force_between(here - spacing, here))
                     : sampling_.coasted(head);
    }
    samples[k].struck = seen(samples[k].struck, head);
    samples[k].sensor_force = head_.sensor_force(head);
  }
}

void StoppedMotion::take(double part) {
  state_ = part < 1.0 ? head_at(part) : end_;
  if (touched_) time_ += part * step();
  bar_.take(part);
}

/// Of the head at a place of the solved step.
StoppedMotion::Look StoppedMotion::look_at(double place, const State& head) const {
  const double force = forced_ ? force_at(place) : 0.0;
  return {place, head, head_.sensor_force(head), head_.sensor_rate(head, force)};
}

/// The head further on in the solved step.
StoppedMotion::Look StoppedMotion::look_from(const Look& look, double place) const {
  const double h = (place - look.place) * step();
  if (!forced_) return look_at(place, head_.coasted(look.head, h));
  const HeadStep way(head_, rule_, h, false);
  return look_at(place, way.advanced(look.head, force_between(look.place, place)));
}

double StoppedMotion::least_of_interest() const {
  if (contacts_ < 2) return sensor_.peak_force;
  return std::max(sensor_.later_peak_force, rival_part * sensor_.peak_force);
}

void StoppedMotion::note(const Look& look) {
  if (look.force <= least_of_interest()) return;
  if (contacts_ > 1) sensor_.later_peak_force = look.force;
  if (look.force <= sensor_.peak_force) return;
  sensor_.peak_force = look.force;
  sensor_.peak_time = time_ + look.place * step();
  peak_part_ = look.place;
}

/// Keeps the force of the second look and, where its rate falls through zero on the way there, the
/// maximum between both; true where it does.
bool StoppedMotion::note_between(const Look& from, const Look& to) {
  note(to);
  if (!(from.rate > 0.0 && to.rate <= 0.0)) return false;
  if (rise_between * std::max(from.force, to.force) <= least_of_interest()) return true;
  std::uintmax_t most = 60;
  const auto rate = [&](double place) { return look_from(from, place).rate; };
  const auto close = [](double a, double b) { return b - a < 1e-9; };  // it is flat there
  const auto [a, b] = boost::math::tools::toms748_solve(rate, from.place, to.place, from.rate,
                                                        to.rate, close, most);
  note(look_from(from, 0.5 * (a + b)));
  return true;
}

bool StoppedMotion::sensor_may_rise() const {
  return head_.largest_free_force(state_) > (1.0 + 1e-12) * least_of_interest();
}

/// A free head rings lower and lower: its first maximum is its largest.
void StoppedMotion::observe_free(double part) {
  if (!sensor_may_rise()) return;
  const double spacing = look_phase / (head_.fastest() * step());
  Look before = look_at(0.0, state_);
  while (before.place < part) {
    const Look here = look_from(before, std::min(before.place + spacing, part));
    if (note_between(before, here)) return;
    before = here;
  }
}

/// Under a force the sensor is looked at at the nodes, or more often where the head vibrates
/// between these.
void StoppedMotion::observe_forced(double part) {
  const int s = rule_.nodes();
  const double phase = head_.fastest() * step();
  const bool closely = phase > look_phase * s;
  const int looks = closely ? static_cast<int>(std::ceil(phase / look_phase)) : s + 1;
  HeadStep stride;
  if (closely) stride = HeadStep(head_, rule_, step() / looks, false);
  Look before = look_at(0.0, state_);
  for (int i = 0; i < looks && before.place < part; ++i) {
    const double place = closely ? (i + 1.0) / looks : i < s ? rule_.points()[i] : 1.0;
    Look here;
    if (place > part)
      here = look_from(before, part);
    else if (closely)
      here = look_at(place, stride.advanced(before.head, force_between(before.place, place)));
    else
      here = look_at(place, i < s ? State{displacement_[i], velocity_[i]} : end_);
    note_between(before, here);
    before = here;
  }
}

/// The peak force in the sensor.
void StoppedMotion::observe(double part) {
  peak_part_.reset();
  if (!touched_) return;
  if (forced_)
    observe_forced(part);
  else
    observe_free(part);
}

std::unique_ptr<MotionSlope> StoppedMotion::follow(const RigEffect& effect, const Solver& solver,
                                                   const HistoryRequest& history) {
  std::unique_ptr<MotionSlope> bar = bar_.follow(effect, solver, history);
  if (!bar) return nullptr;
  return std::make_unique<StoppedSlope>(*this, std::move(bar), effect, solver);
}

SensorForce StoppedMotion::sensor(double contact_impulse) const {
  SensorForce sensor = sensor_;
  sensor.impulse = contact_impulse - head_.mass() * state_.velocity;
  return sensor;
}

}  // namespace impactrig::models
