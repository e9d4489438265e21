// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>

#include "tests/models/reference/impact_run.hpp"

namespace impactrig::models {
namespace {

/// Where the cubic through f0, f1 with slopes s0, s1 (times the step) has its maximum inside (0,
/// 1); negative without one.
double maximum_of_cubic(double f0, double s0, double f1, double s1) {
  const double a = 3.0 * (s0 + s1 - 2.0 * (f1 - f0));  // slope: a θ² + b θ + s0
  const double b = 2.0 * (3.0 * (f1 - f0) - 2.0 * s0 - s1);
  const double root = std::sqrt(b * b - 4.0 * a * s0);  // NaN: monotonous
  const double q = -0.5 * (b + std::copysign(root, b));
  for (const double theta : {q / a, s0 / q})
    if (theta > 0.0 && theta < 1.0 && 2.0 * a * theta + b < 0.0) return theta;
  return -1.0;
}

}  // namespace

void ImpactRun::observe_deepest(double theta) {
  stepper_.dense(theta, f_, scratch_);
  log_.deepest(0, gap_event(scratch_), totals(scratch_), contact_);
}

/// Where the force peaks between two places of the attempted step, found on the dense output; the
/// force itself from a step that ends there, which has the full order.
double ImpactRun::peak_in_attempt(double from, double to, double& force) {
  const auto negative_force = [&](double theta) {
    stepper_.dense(theta, f_, scratch_);
    const PointMotion p = struck(scratch_);
    return -contact_.force(p.displacement, p.velocity);
  };
  const double theta = boost::math::tools::brent_find_minima(negative_force, from, to, 40).first;
  if (-negative_force(theta) <= log_.episode(0).peak_force) return theta;
  probe_.start(stepper_.time(), stepper_.state(), f_);
  probe_.attempt(theta * stepper_.step(), weights_, f_);
  const PointMotion p = struck(probe_.attempted());
  force = contact_.force(p.displacement, p.velocity);
  return theta;
}

/// Peak force and deepest penetration within the attempted step, where a derivative changes sign.
void ImpactRun::observe_extrema() {
  if (contact_.phase() == Phase::free) return;
  const Vector& y0 = stepper_.state();
  const Vector& y1 = stepper_.attempted();
  const PointMotion p0 = struck(y0);
  const PointMotion p1 = struck(y1);
  if (p0.velocity > 0.0 && p1.velocity <= 0.0) {
    double low = 0.0;
    double high = 1.0;
    for (int i = 0; i < 60 && high - low > 1e-16; ++i) {
      const double middle = 0.5 * (low + high);
      stepper_.dense(middle, f_, scratch_);
      (struck(scratch_).velocity > 0.0 ? low : high) = middle;
    }
    observe_deepest(low);
  } else {
    log_.deepest(0, p1.displacement, totals(y1), contact_);
  }
  const auto force_rate = [&](const PointMotion& p, double turn) {
    if (!contact_.presses()) return 0.0;
    const ContactForce::Response law = contact_.pressed(p.displacement, p.velocity);
    return law.to_depth * p.velocity + law.to_rate * turn;
  };
  const double rate0 = force_rate(p0, acceleration(y0, stepper_.slope()));
  const double rate1 = force_rate(p1, acceleration(y1, stepper_.attempted_slope()));
  double theta = 1.0;
  double force = contact_.force(p1.displacement, p1.velocity);
  const double h = stepper_.step();
  const double top =
      maximum_of_cubic(contact_.force(p0.displacement, p0.velocity), h * rate0, force, h * rate1);
  if (rate0 > 0.0 && rate1 < 0.0)
    theta = peak_in_attempt(0.0, 1.0, force);
  else if (top > 0.0)
    theta = peak_in_attempt(std::max(0.0, top - 0.25), std::min(1.0, top + 0.25), force);
  log_.peak(0, force, stepper_.time() + theta * stepper_.step() - time_of_touch_);
}

void ImpactRun::sample_history() {
  History& history = result_.history;
  if (!(history.interval > 0.0)) return;
  const double from = stepper_.time() - time_of_touch_;
  const double h = stepper_.step();
  for (;;) {
    const double t = history.start + history.interval * static_cast<double>(history.force.size());
    if (t > from + h) return;
    stepper_.dense((t - from) / h, f_, history_rows_, scratch_);
    const auto q = scratch_.head(n_);
    const auto v = scratch_.segment(n_, n_);
    const PointMotion p = beam_->struck_point(q, v);
    // at a phase's end rounding may put the sample just beyond it, where the law would pull
    history.force.push_back(std::max(contact_.force(p.displacement, p.velocity), 0.0));
    history.penetration.push_back(p.displacement);
    history.velocity.push_back(beam_->point(velocity_place_, q, v).velocity);
    history.displacement.push_back(beam_->point(displacement_place_, q, v).displacement -
                                   laser_rest_);
  }
}

void ImpactRun::observe_attempt() {
  observe_extrema();
  if (!result_.episodes.empty()) sample_history();
}

}  // namespace impactrig::models
