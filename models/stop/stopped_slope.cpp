// SPDX-License-Identifier: BSD-3-Clause
#include "models/stop/stopped_slope.hpp"

#include <utility>

namespace impactrig::models {
namespace {

void add(double weight, const StopHead::State& change, StopHead::State& to) {
  to.displacement += weight * change.displacement;
  to.velocity += weight * change.velocity;
}

/// A step too long for the head to answer a force over has none.
StopHead::State moved(const HeadStep& step, const StopHead::State& from, const NodeVector& force) {
  return step.responds() ? step.advanced(from, force) : step.coasted(from);
}

/// At the nodes.
MotionSlope::Nodes moved_inside(const HeadStep& step, const StopHead::State& from,
                                const NodeVector& force) {
  MotionSlope::Nodes nodes;
  step.coast(from, nodes.displacement, nodes.velocity);
  if (!step.responds()) return nodes;
  nodes.displacement += step.displacement_of_force() * force;
  nodes.velocity += step.velocity_of_force() * force;
  return nodes;
}

}  // namespace

StoppedSlope::StoppedSlope(const StoppedMotion& motion, std::unique_ptr<MotionSlope> bar,
                           const RigEffect& effect, const Solver& solver)
    : motion_(motion),
      bar_(std::move(bar)) {
  const ParameterStencil by = stencil_of_motion(effect, solver);
  force_ = run_force_ = NodeVector::Zero(motion.rule().nodes());
  if (by.rig().stop == by.rig_beside().stop) return;
  by.for_each_place([&](std::size_t place) {
    changed_.push_back({by.weight(place), StopHead(*by.rig_at(place).stop), {}});
  });
}

void StoppedSlope::start(std::span<const Start> starts) {
  bar_->start(starts);
  state_ = at_place_ = {};
}

void StoppedSlope::begin_step(std::span<const NodeVector> forces) {
  bar_->begin_step(forces);
  run_force_ = forces[0];
  force_.setZero();
  by_head_.displacement.setZero(run_force_.size());
  by_head_.velocity.setZero(run_force_.size());
  for (Changed& changed : changed_) {
    if (changed.step.h() != motion_.step())
      changed.step = HeadStep(changed.head, motion_.rule(), motion_.step());
    const Nodes nodes = moved_inside(changed.step, motion_.head(), run_force_);
    by_head_.displacement += changed.weight * nodes.displacement;
    by_head_.velocity += changed.weight * nodes.velocity;
  }
}

MotionSlope::Change StoppedSlope::improve(std::span<const NodeVector> forces,
                                          std::span<Nodes> points) {
  const Change change = bar_->improve(forces, points);
  force_ = forces[0];
  const Nodes head = moved_inside(motion_.head_step(), state_, force_);
  points[0].displacement -= head.displacement + by_head_.displacement;
  points[0].velocity -= head.velocity + by_head_.velocity;
  return change;
}

double StoppedSlope::press(std::span<const NodeVector> changes) {
  force_ += changes[0];
  return bar_->press(changes);
}

/// The head to a place of the solved step.
void StoppedSlope::go(double part) {
  at_place_ = state_;
  if (part <= 0.0) return;
  if (part >= 1.0) {
    at_place_ = moved(motion_.head_step(), state_, force_);
    for (const Changed& changed : changed_)
      add(changed.weight, moved(changed.step, motion_.head(), run_force_), at_place_);
    return;
  }
  const Collocation& rule = motion_.rule();
  const double h = part * motion_.step();
  const auto until = [&](const NodeVector& force) {
    return rule.values_between(rule.to_series() * force, 0.0, part);
  };
  at_place_ = moved(HeadStep(motion_.free_head(), rule, h, false), state_, until(force_));
  if (changed_.empty()) return;
  const NodeVector run_force = until(run_force_);
  for (const Changed& changed : changed_)
    add(changed.weight, moved(HeadStep(changed.head, rule, h, false), motion_.head(), run_force),
        at_place_);
}

void StoppedSlope::look(double part) {
  bar_->look(part);
  part_ = part;
  go(part);
}

MotionSlope::Spots StoppedSlope::spots() const {
  Spots spots = bar_->spots();
  const StoppedMotion::Head run = motion_.head_within(part_);
  const StopHead& head = motion_.free_head();
  spots.sensor_force = head.sensor_force(at_place_);
  for (const Changed& changed : changed_)
    spots.sensor_force += changed.weight * changed.head.sensor_force(run.state);
  spots.sensor_force_rate = head.sensor_rate(run.state, run.force);
  return spots;
}

void StoppedSlope::take(double shift) {
  bar_->take(shift);
  go(1.0);
  const StoppedMotion::Head run = motion_.head_within(1.0);
  add(shift, {run.state.velocity, motion_.free_head().acceleration(run.state, run.force)},
      at_place_);
  state_ = at_place_;
}

}  // namespace impactrig::models
