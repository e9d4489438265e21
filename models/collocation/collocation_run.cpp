// SPDX-License-Identifier: BSD-3-Clause
#include "models/collocation/collocation_run.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "models/beams/bending_modes.hpp"
#include "models/history_recorder.hpp"
#include "models/run_limits.hpp"

namespace impactrig::models {
namespace {

// Of a contact's depth, how far a flight may have led beyond a stop: rounding alone does.
constexpr double through = 1e-3;

}  // namespace

CollocationRun::CollocationRun(const Rig& rig, const Solver& solver,
                               const SimulationOptions& options, BarMotion& bar)
    : rig_(rig),
      solver_(solver),
      options_(options),
      bar_(bar),
      rule_(bar.rule()),
      steps_(static_cast<std::size_t>(rig.stops())),
      together_(steps_.size()),
      log_(rig, solver.accuracy, result_) {
  result_.solver = solver;
  points_.reserve(steps_.size());
  for (int stop = 0; stop < rig.stops(); ++stop) {
    points_.emplace_back(rig, stop, bar, steps_[points_.size()], log_);
    const double compliance = stop == 0
                                  ? bar.elastic_compliance()
                                  : models::elastic_compliance(rig.beam, points_.back().position());
    elastic_reach_.push_back(std::sqrt(2.0 * compliance));
    gaps_.push_back(points_.back().gap());
  }
}

void CollocationRun::propose() {
  level_ = std::max(level_, bar_.ladder().level_below(bar_.longest_step()));
  bar_.begin_step(level_);
  for (ContactPoint& point : points_) point.predict_force();
}

bool CollocationRun::solve() {
  if (!solve_step()) return false;
  for (StopStep& step : steps_) step.force_series = rule_.to_series() * step.force;
  bar_.finish(steps_);
  for (ContactPoint& point : points_) point.complete();
  return true;
}

StopStep& CollocationRun::solution(long evaluations) {
  points_.front().evaluated(evaluations);
  return steps_.front();
}

void CollocationRun::take_attempt() {
  ++result_.cost.steps;
  const double h = bar_.step();
  for (ContactPoint& point : points_) point.observe(t_, tried_.part);
  const auto struck_at = [&](ContactPoint& point, double place) {
    return point.struck_at(place / h);
  };
  sample_history(
      tried_.part * h,
      [&](double first, double spacing) {
        bar_.sample(first / h, spacing / h, samples_);
        if (followed_) followed_->sample(first / h, spacing / h, samples_.size());
      },
      struck_at, [&](double place) { return points_.front().impulse_until(place / h); });
  for (ContactPoint& point : points_) point.add_to_totals(tried_.part);
  damped_ += bar_.damped(tried_.part);
  bar_.observe(tried_.part);
  if (followed_) follow_step();
  if (!result_.episodes.empty() && result_.episodes.front().open)
    resolved_ = resolved_ && bar_.resolves_vibration();
  if (bar_.asks_for_contact()) bar_.see_contact(points_.front().slope_at(tried_.part));
  bar_.take(tried_.part);
  if (!bar_.parts_exact() && free()) grow_scales();
  for (ContactPoint& point : points_)
    point.keep_series(tried_.part, point.event() != ContactPoint::Event::none);
  t_ += tried_.part * h;
}

/// Its end moves with the first event there.
void CollocationRun::follow_step() {
  using Following = RunSensitivities::End;
  using Event = ContactPoint::Event;
  const auto ended = std::ranges::find_if(
      points_, [](const ContactPoint& point) { return point.event() != Event::none; });
  if (tried_.end == End::run)
    followed_->take(tried_.part, Following::time, 0);
  else if (tried_.end == End::hinge)
    followed_->take(tried_.part, Following::hinge, 0);
  else if (ended == points_.end())
    followed_->take(tried_.part, Following::step, 0);
  else
    followed_->take(tried_.part, ended->event() == Event::gap ? Following::gap : Following::change,
                    ended->number());
}

/// The samples that fall into a time from here on: looked at by `look(first, spacing)` before the
/// first stop and by `struck_at(point, place)` before others, with the first's impulse up to a
/// place [s].
void CollocationRun::sample_history(
    double time, const std::function<void(double, double)>& look,
    const std::function<PointMotion(ContactPoint&, double)>& struck_at,
    const std::function<double(double)>& impulse_until) {
  History& history = result_.history;
  if (!(history.interval > 0.0)) return;
  const double next =
      history.start + history.interval * static_cast<double>(history.force.size()) - t_;
  // a sample on the very end belongs to the step, whichever way it is rounded
  const double reach = time + 1e-9 * history.interval;
  if (next > reach) return;
  const double first = std::max(0.0, next);
  samples_.resize(static_cast<std::size_t>((reach - next) / history.interval) + 1);
  look(first, history.interval);
  for (const BarMotion::Sample& sample : samples_) {
    history.force.push_back(points_.front().shown_force(sample.struck));
    history.penetration.push_back(sample.struck.displacement);
    history.velocity.push_back(sample.velocity);
    history.displacement.push_back(sample.displacement - laser_rest_);
    if (options_.history.spot_slopes) {
      history.velocity_slope.push_back(sample.velocity_slope);
      history.displacement_slope.push_back(sample.displacement_slope - slope_rest_);
    }
    if (rig_.stop) history.sensor_force.push_back(sample.sensor_force);
  }
  for (std::size_t i = 0; i < history.further.size(); ++i)
    for (std::size_t k = 0; k < samples_.size(); ++k) {
      const PointMotion p =
          struck_at(points_[i + 1], first + static_cast<double>(k) * history.interval);
      history.further[i].force.push_back(points_[i + 1].shown_force(p));
      history.further[i].penetration.push_back(p.displacement);
    }
  const std::size_t begun = history.force.size() - samples_.size();
  for (std::size_t k = 0; k < samples_.size(); ++k)
    if (impulses_.wants() || k + 1 == samples_.size())
      impulses_.see(begun + k, impulse_until(first + static_cast<double>(k) * history.interval),
                    history);
}

void CollocationRun::reject(int level) {
  ++result_.cost.rejected;
  level_ = level;
  rejected_ = true;
}

void CollocationRun::judge(bool solved) {
  weigh(solved);
  find_events();
  if (!begun_rightly())
    reject(level_);
  else if (tried_.error <= 1.0)
    take_or_land();
  else
    take_shorter();
  done_ = done_ || out_of_time();
}

void CollocationRun::take_shorter() {
  if (level_ >= StepLadder::levels - 1) {
    stop_without_headway();
    return;
  }
  refused_.refuse(level_);
  reject(level_after_rejection(level_));
}

void CollocationRun::take_or_land() {
  int next = refused_.after(level_, next_level());
  if (rejected_) next = std::max(next, level_);
  rejected_ = false;
  if (const double left = t_end_ - t_; tried_.part * bar_.step() >= left) {
    tried_.part = left / bar_.step();
    tried_.end = End::run;
    for (ContactPoint& point : points_) point.forget_event();
  }
  const bool at_once = points_.size() > 1 && tried_.end == End::event && tried_.part < coincidence;
  stalled_ = at_once ? stalled_ + 1 : 0;
  if (stalled_ > most_stalled * rig_.stops()) {
    take_shorter();
    return;
  }
  if (at_once) {
    // as good as due when the step began, with what happened then at another stop
    ++result_.cost.rejected;
    next = level_;
    leave_events(next);
    level_ = next;
    return;
  }
  if (ends_far_beyond_contact()) {
    reject(level_until_event());
    return;
  }
  if (tried_.end != End::step && !bar_.parts_exact() && !land_on_event()) {
    reject(level_ + 2);
    return;
  }
  take_attempt();
  if (tried_.end == End::run) result_.termination = "the duration asked for was reached";
  if (tried_.end == End::hinge) change_hinge();
  leave_events(next);
  level_ = next;
  if (done_) return;
  done_ = ends_early() || tried_.end == End::run;
  while (!done_ && leap()) done_ = ends_early() || tried_.end == End::run;
}

bool CollocationRun::free() const {
  return std::ranges::all_of(
      points_, [](const ContactPoint& point) { return point.phase() == Phase::free; });
}

/// Flight without a look at the stops while no gap can close; false where that is not longer than a
/// step.
bool CollocationRun::leap() {
  if (!free() || result_.episodes.empty()) return false;
  const double left = t_end_ - t_;
  const double time = std::min(bar_.clear_time(gaps_, left), left);
  if (!(time > bar_.step())) return false;
  ++result_.cost.steps;
  sample_history(
      time, [&](double first, double spacing) { bar_.sample_flight(first, spacing, samples_); },
      [](ContactPoint& point, double place) { return point.struck_in_flight(place); },
      [this](double) { return points_.front().totals().impulse; });
  bar_.fly(time);
  t_ += time;
  for (ContactPoint& point : points_) {
    point.drop_series();
    if (point.struck().displacement > through * point.depth())
      throw std::runtime_error(fmt::format(
          "a flight has led through a stop, {:g} s after first touch; ask for the full equations "
          "(--exact)",
          t_));
  }
  if (time >= left) {
    tried_.end = End::run;
    result_.termination = "the duration asked for was reached";
  }
  return true;
}

void CollocationRun::begin() {
  started_ = std::chrono::steady_clock::now();
  looks_ = {};
  time_limit_.reset();
  // steps of the full equations are long, and so may be what goes before them
  if (!bar_.parts_exact()) time_limit_.emplace(solver_.time_limit);
  if (follows_swing(rig_, options_)) {
    bar_.start(-*rig_.start.release_angle, 0.0);
    if (followed_) followed_->start();
    approach_ = touch_velocity(rig_);
    const double rate = approach_ / rig_.contact.position;
    energy_scale_ = 0.5 * rig_.beam.hinge_inertia() * rate * rate;
    set_scales();
    t_end_ = std::numeric_limits<double>::infinity();
    longest_ = bar_.ladder().longest;
    level_ = bar_.ladder().level_below(1e-3 * *rig_.start.release_angle / rate);
    return;
  }
  bar_.start(0.0, touch_velocity(rig_) / rig_.contact.position);
  if (followed_) followed_->start();
  touch(points_.front());
  double first = points_.front().first_step();
  for (ContactPoint& point : points_) {
    const PointMotion p = point.struck();
    if (point.phase() != Phase::free || p.displacement < 0.0 || p.velocity < 0.0) continue;
    touch(point);
    first = std::min(first, point.first_step());
  }
  level_ = bar_.ladder().level_below(share_of_contact() * first);
}

void CollocationRun::complete() {
  begin();
  while (!done_) {
    propose();
    judge(solve());
  }
}

Simulation CollocationRun::conclude() {
  for (const ContactPoint& point : points_) {
    log_.conclude(point.number(), t_, point.totals(), point.contact(), point.struck().displacement);
    result_.cost.evaluations += point.evaluations();
  }
  log_.conclude(t_, damped_, bar_.energy(), bar_.rigid_part());
  if (!bar_.began_steady()) warn_of_start(result_);
  if (free() && !result_.episodes.empty() && bar_.sensor_may_rise())
    result_.warnings.push_back(
        fmt::format("the run ended {:.4g} s after first touch, before the sensor carried most; "
                    "state a longer solver.duration to see that.",
                    t_));
  result_.cost.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count();
  return std::move(result_);
}

}  // namespace impactrig::models
