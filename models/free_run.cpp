// SPDX-License-Identifier: BSD-3-Clause
#include "models/free_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "models/contact_log.hpp"
#include "models/history_recorder.hpp"
#include "models/rigid_swing.hpp"

namespace impactrig::models {
namespace {

// Of the accuracy asked for, what a step may spend.
constexpr double step_share = 0.1;
constexpr int most_iterations = 12;
// Room for those within one step, where they are not many.
constexpr std::size_t samples_of_step = 1024;
// In the first step the bar turns by about this [rad].
constexpr double first_turn = 1e-4;

}  // namespace

MotionSlope::Start free_start(const Rig& rig) {
  const double angle = -rig.start.release_angle.value_or(0.0);
  if (rig.hinge.rotation) return {angle, rig.hinge.rotation->rate_at(0.0)};
  return {angle, rig.start.release_angle ? 0.0 : rig.start.velocity / rig.contact.position};
}

FreeRun::FreeRun(const Rig& rig, const Solver& solver, const SimulationOptions& options,
                 BarMotion& bar)
    : rig_(rig),
      solver_(solver),
      options_(options),
      bar_(bar),
      t_end_(*solver.duration) {
  no_stop_.force = no_stop_.force_series = NodeVector::Zero(bar.rule().nodes());
  result_.solver = solver;
}

void FreeRun::start() {
  const auto [angle, rate] = free_start(rig_);
  const std::optional<HingeRotation>& rotation = rig_.hinge.rotation;
  bar_.start(angle, rate);
  const double inertia = rig_.beam.hinge_inertia();
  const double full = rotation ? rotation->rate : rate;
  energy_scale_ = std::max(0.5 * inertia * full * full, RigidSwing(rig_).available(angle));
  const double fastest = std::sqrt(2.0 * energy_scale_ / inertia);  // [rad/s]
  // the tip's way in a radian is the bar's length: an error of speed counts by the way it makes
  bar_.set_scales({.energy = energy_scale_, .contact_time = 1.0 / fastest});
  first_ = first_turn / fastest;
  const BeamEnergy energy = bar_.energy();
  energy_at_start_ = energy.kinetic + energy.elastic + energy.spring + energy.gravitational;
  // of a bar that begins stretched as it turns, a little more than the straight one's
  result_.energy.initial = std::max(energy_scale_, rotation ? 0.0 : energy.kinetic);
  result_.energy.elastic_at_start = energy.elastic;
  result_.energy.gravitational = -energy.gravitational;
  result_.history.interval = options_.history.interval;
  const bool sampled = options_.history.interval > 0.0;
  const std::size_t samples = sampled ? expected_samples(result_.history, t_end_) : 0;
  make_room(samples);
  if (followed_) followed_->start(samples);
}

void FreeRun::make_room(std::size_t samples) {
  History& history = result_.history;
  history.velocity.reserve(samples);
  history.displacement.reserve(samples);
  samples_.reserve(std::min(samples, samples_of_step));
  if (!rig_.hinge.rotation) return;
  history.deflection.reserve(samples);
  history.extension.reserve(samples);
}

/// Newton's method to rest.
bool FreeRun::solve() {
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    result_.cost.evaluations += bar_.rule().nodes();
    if (!bar_.improve({&no_stop_, 1})) return false;
    if (!bar_.settled()) continue;
    bar_.finish({&no_stop_, 1});
    error_ = bar_.error() / (solver_.accuracy * step_share);
    return error_ <= 1.0;
  }
  return false;
}

bool FreeRun::try_step(int level) {
  error_ = std::numeric_limits<double>::infinity();
  bar_.begin_step(level);
  return solve();
}

/// The step tried again, as long as is left of the run or until friction in the hinge changes.
bool FreeRun::land(double hinge_change) {
  const double left = (t_end_ - t_) / bar_.step();
  hinge_changes_ = hinge_change <= std::min(left, 1.0);
  const double part = std::min(left, hinge_change);
  if (part >= 1.0) return true;
  error_ = std::numeric_limits<double>::infinity();
  bar_.begin_part(part);
  return solve();
}

void FreeRun::change_hinge() {
  bar_.change_hinge();
  if (followed_) followed_->change_hinge();
}

/// The samples that fall into a time from here on, looked at by `look(first, spacing)` [s].
template <typename Look>
void FreeRun::sample(double time, Look look) {
  History& history = result_.history;
  const double interval = options_.history.interval;
  if (!(interval > 0.0)) return;
  const double next = interval * static_cast<double>(history.velocity.size()) - t_;
  const double reach = time + 1e-9 * interval;
  if (next > reach) return;
  samples_.resize(static_cast<std::size_t>((reach - next) / interval) + 1);
  look(std::max(0.0, next), interval);
  for (const BarMotion::Sample& sample : samples_) {
    history.velocity.push_back(sample.velocity);
    history.displacement.push_back(sample.displacement);
    if (rig_.hinge.rotation) {
      history.deflection.push_back(sample.deflection);
      history.extension.push_back(sample.extension);
    }
    if (!options_.history.spot_slopes) continue;
    history.velocity_slope.push_back(sample.velocity_slope);
    history.displacement_slope.push_back(sample.displacement_slope);
    if (!rig_.hinge.rotation) continue;
    history.deflection_slope.push_back(sample.deflection_slope);
    history.extension_slope.push_back(sample.extension_slope);
  }
}

void FreeRun::conclude() {
  result_.duration = t_;
  result_.termination = "the duration asked for was reached";
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  result_.restitution = {unknown, unknown, unknown, unknown};
  close_audit(rig_, energy_at_start_, bar_.energy(), bar_.rigid_part(), result_.energy);
  if (!bar_.began_steady()) warn_of_start(result_);
}

Simulation FreeRun::fly() {
  const auto started = std::chrono::steady_clock::now();
  result_.cost.steps = 1;
  sample(t_end_,
         [&](double first, double spacing) { bar_.sample_flight(first, spacing, samples_); });
  bar_.fly(t_end_);
  t_ = t_end_;
  conclude();
  result_.cost.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  return std::move(result_);
}

/// Throws where the time allowed is over or no step is short enough.
void FreeRun::check_headway(const TimeLimit& limit, int level) {
  if (looks_.due() && limit.over())
    throw std::runtime_error(fmt::format(
        "{:.3g} s of processor time, what was left of solver.time_limit, took the simulation to "
        "{:g} s after the start. State a shorter solver.duration, fewer elements or modes, a "
        "larger solver.accuracy, or a longer solver.time_limit.",
        std::max(solver_.time_limit, 0.0), t_));
  if (level >= StepLadder::levels - 1)
    throw std::runtime_error(fmt::format(
        "the integration makes no headway {:g} s after the start; ask for less accuracy", t_));
}

void FreeRun::take_step() {
  ++result_.cost.steps;
  const double h = bar_.step();
  sample(h, [&](double first, double spacing) {
    bar_.sample(first / h, spacing / h, samples_);
    if (followed_) followed_->sample(first / h, spacing / h, samples_.size());
  });
  result_.energy.damped += bar_.damped(1.0);
  result_.energy.driven += bar_.driven();
  t_ += h;
  if (followed_) followed_->take(hinge_changes_);
  bar_.take(1.0);
  if (hinge_changes_) change_hinge();
}

Simulation FreeRun::simulate() {
  const auto started = std::chrono::steady_clock::now();
  const TimeLimit limit(solver_.time_limit);
  int level = bar_.ladder().level_below(first_);
  bool rejected = false;
  RefusedLevel refused;  // by its error
  while (t_ < t_end_) {
    check_headway(limit, level);
    if (!try_step(level)) {
      ++result_.cost.rejected;
      const double order = bar_.rule().nodes() + 1.0;
      const double factor =
          std::isfinite(error_) ? std::max(0.1, 0.9 * std::pow(error_, -1.0 / order)) : 0.25;
      refused.refuse(level);
      level = std::max(level + 1, bar_.ladder().level_below(factor * bar_.step()));
      rejected = true;
      continue;
    }
    const double order = bar_.rule().nodes() + 1.0;
    const double growth =
        std::clamp(0.9 * std::pow(std::max(error_, 1e-12), -1.0 / order), 0.2, 6.0);
    const int next = refused.after(level, bar_.ladder().level_below(growth * bar_.step()));
    const double hinge_change = bar_.hinge_change();
    if (hinge_change == 0.0) {
      change_hinge();
      ++result_.cost.rejected;
      continue;
    }
    const bool last = std::min(hinge_change, 1.0) * bar_.step() >= t_end_ - t_;
    if (!land(hinge_change) || (followed_ && !followed_->solve())) {
      ++result_.cost.rejected;
      level += 2;
      rejected = true;
      continue;
    }
    take_step();
    if (last) t_ = t_end_;
    level = rejected ? std::max(next, level) : next;
    rejected = false;
  }
  conclude();
  result_.cost.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  return std::move(result_);
}

}  // namespace impactrig::models
