// SPDX-License-Identifier: BSD-3-Clause
#include "tests/models/reference/impact_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "models/beams/bending_modes.hpp"
#include "models/history_recorder.hpp"
#include "models/run_limits.hpp"

namespace impactrig::models {
namespace {

// The controller's tolerance for a step, as a part of the accuracy asked for over the run; the test
// of the accuracy holds it to that.
constexpr double step_share = 0.25;
// Phase per step of the bar's fastest vibration up to which the method damps it, 5.9, less what the
// frequency may be underestimated. The error estimate alone lets steps dance around that limit and
// feed the vibration: after 1e5 steps the energy had doubled.
constexpr double longest_phase = 5.6;
constexpr long most_steps = 20'000'000;

}  // namespace

ImpactRun::ImpactRun(const Rig& rig, const Solver& solver, const SimulationOptions& options,
                     BeamDynamics& beam)
    : rig_(rig),
      solver_(solver),
      options_(options),
      beam_(&beam),
      n_(beam_->size()),
      damped_(damped(rig)),
      contact_(rig),
      stepper_(2 * n_ + 3),
      probe_(2 * n_ + 3),
      weights_(2 * n_ + 3),
      scratch_(2 * n_ + 3),
      elastic_reach_(std::sqrt(2.0 * elastic_compliance(rig.beam, rig.contact.position))),
      log_(rig, solver.accuracy, result_) {
  f_ = [this](double, const Vector& y, Eigen::Ref<Vector> slope) {
    const PointMotion p = struck(y);
    const double force = contact_.force(p.displacement, p.velocity);
    slope.head(n_) = y.segment(n_, n_);
    beam_->acceleration(y.head(n_), y.segment(n_, n_), force, slope.segment(n_, n_));
    slope[2 * n_] = force;
    slope[2 * n_ + 1] = contact_.dissipation(p.displacement, p.velocity);
    slope[2 * n_ + 2] = damped_ ? beam_->damping_power(y.head(n_), y.segment(n_, n_)) : 0.0;
  };
  result_.solver = solver;
}

/// The error of a step is measured against the whole kinetic energy: a velocity by the speed that
/// energy would give its coordinate, a position by the way done at that speed within an impact's
/// time.
void ImpactRun::set_scales(double kinetic, double approach) {
  const double tolerance = std::max(step_share * solver_.accuracy, 2e-15);
  const double depth = penetration_storing(contact_, kinetic);
  const Vector speed = (2.0 * kinetic * beam_->inertia_diagonal().cwiseInverse()).cwiseSqrt();
  weights_.head(n_) = speed.cwiseInverse() * (approach / depth) / tolerance;
  weights_.segment(n_, n_) = speed.cwiseInverse() / tolerance;
  weights_[2 * n_] = approach / (2.0 * kinetic) / tolerance;
  weights_.tail(2).setConstant(1.0 / kinetic / tolerance);
  // The first step begins in the corner of the contact law, where the error estimate sees too
  // little: 1e-3 costs 3e-10 of the peak force, and less with the square of the step.
  // Every root of λ² + d λ + ω² is below the larger of the two; the method is stable to 5.9 in any
  // direction of the left half plane.
  longest_step_ = longest_phase / std::max(fastest_vibration(depth), fastest_decay());
  first_step_ = std::min(1e-3, 30.0 * std::sqrt(solver_.accuracy)) * depth / approach;
}

/// Highest angular frequency of the hanging bar held by the contact's spring at a depth, by power
/// iteration; from below, zero for a rigid bar without either.
double ImpactRun::fastest_vibration(double depth) {
  const double spring =
      (contact_.elastic(1.01 * depth) - contact_.elastic(0.99 * depth)) / (0.02 * depth);
  const Vector root_mass = beam_->inertia_diagonal().cwiseSqrt();
  const Vector rest = Vector::Zero(n_);
  Vector q(n_), forward(n_), back(n_);
  for (int i = 0; i < n_; ++i) q[i] = (1.0 + 0.3 * std::sin(7.0 * i)) / root_mass[i];
  double square = 0.0;
  for (int iteration = 0; iteration < 60; ++iteration) {
    q *= 1e-9 * rig_.beam.length / q.cwiseProduct(root_mass).norm() * root_mass.minCoeff();
    const double size = q.cwiseProduct(root_mass).norm();
    const double force = spring * beam_->struck_point(q, rest).displacement;
    beam_->acceleration(q, rest, force, forward);
    beam_->acceleration(-q, rest, -force, back);
    q = 0.5 * (back - forward);
    const double before = square;
    square = q.cwiseProduct(root_mass).norm() / size;
    if (!(square > 0.0) || std::abs(square - before) < 1e-4 * square) break;
  }
  return std::sqrt(square);
}

/// Highest rate at which damping alone would still a motion of the hanging bar [1/s], by power
/// iteration; zero without damping.
double ImpactRun::fastest_decay() {
  if (!damped_) return 0.0;
  const Vector root_mass = beam_->inertia_diagonal().cwiseSqrt();
  const Vector rest = Vector::Zero(n_);
  Vector v(n_), forward(n_), back(n_);
  for (int i = 0; i < n_; ++i) v[i] = (1.0 + 0.3 * std::sin(7.0 * i)) / root_mass[i];
  double decay = 0.0;
  for (int iteration = 0; iteration < 60; ++iteration) {
    v *= 1e-6 / v.cwiseProduct(root_mass).norm();
    beam_->acceleration(rest, v, 0.0, forward);
    beam_->acceleration(rest, -v, 0.0, back);
    v = 0.5 * (back - forward);
    const double before = decay;
    decay = 1e6 * v.cwiseProduct(root_mass).norm();
    if (!(decay > 0.0) || std::abs(decay - before) < 1e-4 * decay) break;
  }
  return decay;
}

/// A release from rest, with the flexible bar, up to first touch.
void ImpactRun::swing_to_touch() {
  const double angle = *rig_.start.release_angle;
  Vector y = Vector::Zero(2 * n_ + 3);
  beam_->set_steady_motion(-angle, 0.0, y.head(n_), y.segment(n_, n_));
  const double speed = touch_velocity(rig_);
  const double rate = speed / rig_.contact.position;
  set_scales(0.5 * rig_.beam.hinge_inertia() * rate * rate, speed);
  approach_ = speed;
  t_end_ = std::numeric_limits<double>::infinity();
  stepper_.start(0.0, y, f_);
}

void ImpactRun::first_touch() {
  time_of_touch_ = stepper_.time();
  const Vector& y = stepper_.state();
  damped_before_ = y[2 * n_ + 2];
  approach_ = struck(y).velocity;
  log_.begin(energy(y));
  set_scales(result_.energy.initial, approach_);
  t_end_ = time_of_touch_ + solver_.duration.value_or(longest_default_run);
  const HistoryRequest& wanted = options_.history;
  if (!(wanted.interval > 0.0)) return;
  velocity_place_ =
      wanted.velocity_position > 0.0 ? wanted.velocity_position : rig_.contact.position;
  displacement_place_ =
      wanted.displacement_position > 0.0 ? wanted.displacement_position : rig_.contact.position;
  for (const double x : {rig_.contact.position, velocity_place_, displacement_place_})
    for (const int row : beam_->coordinates_of(x)) {
      history_rows_.push_back(row);
      history_rows_.push_back(row + n_);
    }
  std::ranges::sort(history_rows_);
  history_rows_.erase(std::unique(history_rows_.begin(), history_rows_.end()), history_rows_.end());
  const PointMotion at_velocity = beam_->point(velocity_place_, y.head(n_), y.segment(n_, n_));
  const PointMotion at_laser = beam_->point(displacement_place_, y.head(n_), y.segment(n_, n_));
  laser_rest_ = at_laser.displacement;
  begin_history(rig_, wanted, approach_, at_velocity.velocity, at_laser.velocity, result_.history);
}

void ImpactRun::touch() {
  const Vector& y = stepper_.state();
  if (result_.episodes.empty()) first_touch();
  log_.touch(0, stepper_.time() - time_of_touch_, struck(y).velocity, totals(y), contact_);
}

void ImpactRun::integrate() {
  const bool until_gone = !solver_.duration;
  double h = first_step_;
  bool rejected = false;  // the last attempt: then the step does not grow
  while (!done_) {
    h = std::min(h, longest_step_);
    const double left = t_end_ - stepper_.time();
    const bool last = h >= left;
    if (last) h = left;
    if (result_.cost.steps + result_.cost.rejected > most_steps ||
        !(stepper_.time() + h > stepper_.time()))
      throw std::runtime_error(
          fmt::format("the integration stopped {:g} s after first touch: steps of {:g} s make no "
                      "headway; ask for less accuracy",
                      stepper_.time() - time_of_touch_, h));
    const double error = stepper_.attempt(h, weights_, f_);
    if (!(error <= 1.0)) {
      ++result_.cost.rejected;
      h = std::min(Dop853::suggest(h, error), 0.9 * h);
      rejected = true;
      continue;
    }
    const double next =
        rejected ? std::min(h, Dop853::suggest(h, error)) : Dop853::suggest(h, error);
    rejected = false;
    double theta = 2.0;
    bool at_pull = false;
    const bool event = event_in_attempt(theta, at_pull);
    if (event) {
      const double landing_error = land_on(theta, at_pull);
      if (!(landing_error <= 1.0)) {
        ++result_.cost.rejected;
        h = Dop853::suggest(stepper_.step(), landing_error);
        continue;
      }
    }
    ++result_.cost.steps;
    observe_attempt();
    stepper_.accept();
    if (event) {
      if (at_pull) {
        contact_.set_phase(contact_.switched());
      } else if (contact_.phase() == Phase::free) {
        touch();
      } else {
        const Vector& y = stepper_.state();
        log_.separate(0, stepper_.time() - time_of_touch_, struck(y).velocity, totals(y), contact_);
      }
      stepper_.start(stepper_.time(), stepper_.state(), f_);
      h = std::min(first_step_, next);
    } else {
      h = next;
      if (last) {
        done_ = true;
        result_.termination = "the duration asked for was reached";
      }
    }
    const Vector& y = stepper_.state();
    if (result_.episodes.empty() && rigid_part(y).rate < -0.1 * approach_ / rig_.contact.position)
      throw std::runtime_error(fmt::format(
          "the bar turned back {:g} rad before it touched the stop: released, it bends, "
          "and what that takes is missing; release it from further away",
          -rigid_part(y).angle));
    if (until_gone && !result_.episodes.empty() && contact_.phase() == Phase::free &&
        left_for_good(rig_, {&elastic_reach_, 1}, rigid_part(y), energy(y))) {
      done_ = true;
      result_.termination = "the bar has left the stop for good";
    } else if (done_ && until_gone) {
      result_.termination =
          fmt::format("{:g} s after first touch the bar was still within reach of the stop",
                      longest_default_run);
      result_.warnings.push_back(
          result_.termination +
          "; later contacts are not in the result. State solver.duration to go on.");
    }
  }
}

void ImpactRun::conclude() {
  const Vector& y = stepper_.state();
  const double t = stepper_.time() - time_of_touch_;
  log_.conclude(0, t, totals(y), contact_, struck(y).displacement);
  log_.conclude(t, lost_to_damping(y), energy(y), rigid_part(y));
}

Simulation ImpactRun::simulate() {
  const auto started = std::chrono::steady_clock::now();
  if (rig_.start.release_angle && (options_.exact || spring_bends_bar(rig_))) {
    swing_to_touch();
  } else {
    const double speed = touch_velocity(rig_);
    Vector y = Vector::Zero(2 * n_ + 3);
    beam_->set_steady_motion(0.0, speed / rig_.contact.position, y.head(n_), y.segment(n_, n_));
    stepper_.start(0.0, y, f_);
    touch();
    stepper_.start(0.0, y, f_);
  }
  integrate();
  conclude();
  result_.cost.evaluations = stepper_.evaluations() + probe_.evaluations();
  result_.cost.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  return std::move(result_);
}

}  // namespace impactrig::models
