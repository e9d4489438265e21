// SPDX-License-Identifier: BSD-3-Clause
// The forces of a step: Newton's method for the contact laws, in turn with the bar.
#include <algorithm>
#include <cmath>

#include "models/collocation/collocation_run.hpp"

namespace impactrig::models {
namespace {

constexpr int most_iterations = 12;

/// What the law's curvature leaves of a correction by these [N].
double left_of(const ContactForce::Response& law, double depth, double deeper, double faster) {
  return std::abs(deeper) *
             (std::abs(law.to_depth * deeper / depth) + std::abs(law.mixed * faster)) +
         std::abs(law.bend) * faster * faster;
}

}  // namespace

double CollocationRun::newton_tolerance(const ContactPoint& point) const {
  return std::min(1e-4, 1e-2 * solver_.accuracy) * point.force_scale();
}

/// Newton's method for the change of a stop's force at the nodes that brings it to the contact law,
/// when the point before it moves as the bar told without the change; false when it does not
/// converge. It ends when what the law's curvature leaves of the last change is below the
/// tolerance: with df/dδ = k, about k Δδ² / δ and ∂²f/∂δ∂δ̇ Δδ Δδ̇.
bool CollocationRun::solve_force(ContactPoint& point, StopStep& step) {
  const int s = rule_.nodes();
  const BarMotion::Response& response = bar_.response(point.number(), point.number());
  const double tolerance = newton_tolerance(point);
  NodeVector residual(s), depth = step.displacement, rate = step.velocity;
  NodeMatrix jacobian(s, s);
  std::array<ContactForce::Response, most_nodes> laws;
  NodeVector& change = step.change;
  step.to_depth.resize(s);
  step.to_rate.resize(s);
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    for (int i = 0; i < s; ++i) {
      depth[i] = point.resolved(depth[i]);
      const ContactForce::Response law = point.contact().pressed(depth[i], rate[i]);
      laws[i] = law;
      step.to_depth[i] = law.to_depth;
      step.to_rate[i] = law.to_rate;
      residual[i] = step.force[i] + change[i] - law.force;
      jacobian.row(i) = -law.to_depth * response.displacement_of_force.row(i) -
                        law.to_rate * response.velocity_of_force.row(i);
      jacobian(i, i) += 1.0;
    }
    point.evaluated(s);
    const NodeVector correction = jacobian.partialPivLu().solve(residual);
    change -= correction;
    const NodeVector deeper = response.displacement_of_force * correction;
    const NodeVector faster = response.velocity_of_force * correction;
    double left = 0.0;
    for (int i = 0; i < s; ++i) {
      left = std::max(left, left_of(laws[i], depth[i], deeper[i], faster[i]));
    }
    if (!std::isfinite(left)) return false;
    if (left <= tolerance) return true;
    depth -= deeper;
    rate -= faster;
  }
  return false;
}

/// Rows of Newton's equations for a pressed stop that moves like this.
void CollocationRun::linearise(ContactPoint& point) {
  const int s = rule_.nodes();
  StopStep& step = step_of(point);
  Together& own = together_[static_cast<std::size_t>(point.number())];
  const int first = point.number() * s;
  step.to_depth.resize(s);
  step.to_rate.resize(s);
  for (int i = 0; i < s; ++i) {
    own.depth[i] = point.resolved(own.depth[i]);
    const ContactForce::Response law = point.contact().pressed(own.depth[i], own.rate[i]);
    own.law[i] = law;
    step.to_depth[i] = law.to_depth;
    step.to_rate[i] = law.to_rate;
    equations_.residual[first + i] = step.force[i] + step.change[i] - law.force;
    for (const ContactPoint& other : points_) {
      if (!other.contact().presses()) continue;
      const BarMotion::Response& response = bar_.response(point.number(), other.number());
      equations_.jacobian.block(first + i, other.number() * s, 1, s) =
          -law.to_depth * response.displacement_of_force.row(i) -
          law.to_rate * response.velocity_of_force.row(i);
    }
    equations_.jacobian(first + i, first + i) += 1.0;
  }
  point.evaluated(s);
}

/// Takes the correction off, and tells what the law's curvature leaves of it as solve_force() has
/// it.
double CollocationRun::correct(ContactPoint& point) {
  const int s = rule_.nodes();
  Together& own = together_[static_cast<std::size_t>(point.number())];
  NodeVector deeper = NodeVector::Zero(s), faster = deeper;
  for (const ContactPoint& other : points_) {
    const BarMotion::Response& response = bar_.response(point.number(), other.number());
    const NodeVector correction = equations_.correction.segment(other.number() * s, s);
    deeper += response.displacement_of_force * correction;
    faster += response.velocity_of_force * correction;
  }
  double left = 0.0;
  for (int i = 0; i < s; ++i)
    left = std::max(left, left_of(own.law[i], own.depth[i], deeper[i], faster[i]));
  step_of(point).change -= equations_.correction.segment(point.number() * s, s);
  own.depth -= deeper;
  own.rate -= faster;
  return left;
}

/// The same for several stops that press at a time.
bool CollocationRun::solve_forces() {
  const int s = rule_.nodes();
  const Eigen::Index n = static_cast<Eigen::Index>(points_.size()) * s;
  for (const ContactPoint& point : points_) {
    Together& own = together_[static_cast<std::size_t>(point.number())];
    own.depth = step_of(point).displacement;
    own.rate = step_of(point).velocity;
  }
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    equations_.residual.setZero(n);
    equations_.jacobian.setIdentity(n, n);
    for (ContactPoint& point : points_) {
      if (!point.contact().presses()) continue;
      equations_.jacobian.middleRows(point.number() * s, s).setZero();
      linearise(point);
    }
    equations_.factor.compute(equations_.jacobian);
    equations_.correction = equations_.factor.solve(equations_.residual);
    bool close = true;
    for (ContactPoint& point : points_) {
      if (!point.contact().presses()) continue;
      const double left = correct(point);
      if (!std::isfinite(left)) return false;
      close = close && left <= newton_tolerance(point);
    }
    if (close) return true;
  }
  return false;
}

/// Brings the forces to the contact laws where they press; false when that fails.
bool CollocationRun::press() {
  const auto pressed = [](const ContactPoint& point) { return point.contact().presses(); };
  const auto count = std::ranges::count_if(points_, pressed);
  if (count == 0) return true;
  for (StopStep& step : steps_) step.change.setZero(rule_.nodes());
  if (count == 1) {
    ContactPoint& point = *std::ranges::find_if(points_, pressed);
    if (!solve_force(point, step_of(point))) return false;
  } else if (!solve_forces()) {
    return false;
  }
  for (const ContactPoint& point : points_) {
    if (!pressed(point)) continue;
    const NodeVector& change = step_of(point).change;
    step_of(point).force += change;
    for (const ContactPoint& other : points_) {
      const BarMotion::Response& response = bar_.response(other.number(), point.number());
      step_of(other).displacement += response.displacement_of_force * change;
      step_of(other).velocity += response.velocity_of_force * change;
    }
  }
  bar_.press(steps_);
  return true;
}

/// Bar and contact laws in turn, until neither moves the other.
bool CollocationRun::solve_step() {
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    if (!bar_.improve(steps_)) return false;
    for (ContactPoint& point : points_) point.see_nodes();
    if (!press()) return false;
    if (bar_.settled()) return true;
  }
  return false;
}

}  // namespace impactrig::models
