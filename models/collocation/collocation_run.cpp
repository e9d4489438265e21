// SPDX-License-Identifier: BSD-3-Clause
#include "models/collocation/collocation_run.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "models/beams/bar_element.hpp"
#include "models/history_recorder.hpp"
#include "models/run_limits.hpp"

namespace impactrig::models {
namespace {

// Of the accuracy asked for, what the force's series may leave out of a step's impulse. Where the
// bar answers that force exactly, what is left out changes sign too often to move it: the first
// contact then errs by 0.02 of the accuracy asked for in nine scenes out of ten and by less than
// all of it in the worst of 139 at eight accuracies.
constexpr double step_share = 0.1, step_share_of_modes = 1.0;
// Of the step that would just be good enough, the next one.
constexpr double step_safety = 0.8;
// How well the way of free flight is resolved where a touch is looked for, of the penetration.
constexpr double motion_resolution = 1e-3;
// The same far from the stop, of the gap.
constexpr double gap_share = 0.1;
constexpr int most_iterations = 12;

/// What of the bar the contact first has to stop: in how long a time, and with which energy. A
/// short bar as a whole; of a long one, what moves with the struck point in that time. A point
/// force meets an infinite beam's impedance 2 √2 m' (EI / m')^¼ √ω [Cremer2005, 5.2].
struct Loading {
  double time;    ///< [s]
  double energy;  ///< [J]
};

Loading loading(const Rig& rig, const Solver& solver, const ContactForce& contact, double depth,
                double approach, double kinetic) {
  const double whole = depth / approach;
  double time = whole;
  if (solver.model != BeamModel::rigid) {
    const std::vector<BarElement> pieces = bar_pieces(rig.beam);
    const BarElement& piece = pieces[element_at(pieces, rig.contact.position)];
    const double line_mass = piece.line_density;
    const double wave = std::pow(piece.bending_stiffness / line_mass, 0.25);
    const double stiffness = contact.elastic(depth) / depth;
    const double mass = 2.0 * std::numbers::sqrt2 * line_mass * wave;  // times √time
    time = std::min(time, std::pow(mass / stiffness, 2.0 / 3.0));
  }
  // strong damping presses with full force earlier
  return {time / (1.0 + contact.damping_factor()), kinetic * std::pow(time / whole, 2)};
}

}  // namespace

CollocationRun::CollocationRun(const Rig& rig, const Solver& solver,
                               const SimulationOptions& options, BarMotion& bar)
    : rig_(rig),
      solver_(solver),
      options_(options),
      bar_(bar),
      contact_(rig),
      rule_(bar.rule()),
      elastic_reach_(std::sqrt(2.0 * bar.elastic_compliance())),
      log_(rig, solver.accuracy, result_) {
  result_.solver = solver;
}

/// Extrapolates the last step's force, as far as its low terms tell.
void CollocationRun::predict_force(double h) {
  const int s = rule_.nodes();
  tried_.force.setZero(s);
  if (last_series_.size() == 0 || contact_.phase() != Phase::pressed) return;
  const int terms = std::min(std::max(4, s - 2), 6);
  NodeVector legendre(terms);
  for (int i = 0; i < s; ++i) {
    shifted_legendre(1.0 + rule_.points()[i] * h / last_h_, legendre);
    tried_.force[i] = last_series_.head(terms).dot(legendre);
  }
}

double CollocationRun::newton_tolerance() const {
  return std::min(1e-4, 1e-2 * solver_.accuracy) * force_scale_;
}

/// Newton's method for the change of the force at the nodes that brings it to the contact law, when
/// the struck point moves like this without the change; false when it does not converge. It ends
/// when what the law's curvature leaves of the last change is below the tolerance: with df/dδ = k,
/// about k Δδ² / δ and k μ Δδ Δδ̇.
bool CollocationRun::solve_force(const NodeVector& displacement, const NodeVector& velocity,
                                 NodeVector& change) {
  const int s = rule_.nodes();
  const BarMotion::Response& response = bar_.response();
  const double tolerance = newton_tolerance();
  NodeVector residual(s), depth = displacement, rate = velocity;
  NodeMatrix jacobian(s, s);
  change.setZero(s);
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    NodeVector stiffness(s);
    for (int i = 0; i < s; ++i) {
      const ContactForce::Response law = contact_.pressed(depth[i], rate[i]);
      stiffness[i] = law.to_depth;
      residual[i] = tried_.force[i] + change[i] - law.force;
      jacobian.row(i) = -law.to_depth * response.displacement_of_force.row(i) -
                        law.to_rate * response.velocity_of_force.row(i);
      jacobian(i, i) += 1.0;
    }
    evaluations_ += s;
    const NodeVector step = jacobian.partialPivLu().solve(residual);
    change -= step;
    const NodeVector deeper = response.displacement_of_force * step;
    const NodeVector faster = response.velocity_of_force * step;
    double left = 0.0;
    for (int i = 0; i < s; ++i) {
      const double curvature = std::abs(deeper[i] / depth[i]) + std::abs(contact_.mu() * faster[i]);
      left = std::max(left, std::abs(stiffness[i] * deeper[i]) * curvature);
    }
    if (!std::isfinite(left)) return false;
    if (left <= tolerance) return true;
    depth -= deeper;
    rate -= faster;
  }
  return false;
}

/// Bar and contact law in turn, until neither moves the other.
bool CollocationRun::solve_step() {
  const BarMotion::Response& response = bar_.response();
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    if (!bar_.improve(tried_.force, tried_.displacement, tried_.velocity)) return false;
    if (contact_.phase() == Phase::pressed) {
      NodeVector change;
      if (!solve_force(tried_.displacement, tried_.velocity, change)) return false;
      tried_.force += change;
      tried_.displacement += response.displacement_of_force * change;
      tried_.velocity += response.velocity_of_force * change;
      bar_.press(change);
    }
    if (bar_.settled()) return true;
  }
  return false;
}

/// What the force and its dissipation leave out over the step, as impulse and energy, against the
/// tolerance.
double CollocationRun::force_error() const {
  if (contact_.phase() == Phase::free) return 0.0;
  const double share = bar_.parts_exact() ? step_share_of_modes : step_share;
  const double tolerance = std::max(solver_.accuracy, 1e-13) * share;
  const double impulse = truncation(tried_.force_series) * bar_.step();
  const double loss = truncation(tried_.dissipation_series) * bar_.step();
  return std::max(impulse / impulse_scale_, loss / energy_scale_) / tolerance;
}

/// What the force's derivatives leave out, by which the parameters' own size would change the
/// impulse. They are less smooth than the force where it begins and ends.
double CollocationRun::derivative_error() const {
  double worst = 0.0;
  for (int i = 0; i < followed_->count(); ++i)
    worst = std::max(worst, truncation(followed_->force_series(i)) * followed_->size(i));
  return worst * bar_.step() / impulse_scale_ / std::max(solver_.accuracy, 1e-13);
}

double CollocationRun::motion_error() const {
  const int s = rule_.nodes();
  const NodeVector& series = tried_.displacement_series;
  const double gap =
      std::min(std::abs(bar_.struck().displacement), tried_.displacement.cwiseAbs().minCoeff());
  return series.segment<2>(s - 2).norm() / (motion_resolution * depth_ + gap_share * gap);
}

void CollocationRun::propose() {
  bar_.begin_step(level_);
  predict_force(bar_.step());
}

bool CollocationRun::solve() {
  const int s = rule_.nodes();
  if (!solve_step()) return false;
  tried_.force_series = rule_.to_series() * tried_.force;
  bar_.finish(tried_.force, tried_.force_series);
  tried_.at_end = bar_.struck_at_end();
  tried_.dissipation.setZero(s);
  if (contact_.phase() != Phase::free)
    for (int i = 0; i < s; ++i)
      tried_.dissipation[i] = contact_.dissipation(tried_.displacement[i], tried_.velocity[i]);
  tried_.dissipation_series = rule_.to_series() * tried_.dissipation;
  tried_.displacement_series = rule_.to_series() * tried_.displacement;
  return true;
}

CollocationRun::Attempt& CollocationRun::solution(long evaluations) {
  evaluations_ += evaluations;
  return tried_;
}

/// The error of the step tried.
void CollocationRun::weigh(bool solved) {
  tried_.event = Event::none;
  tried_.part = 1.0;
  if (!solved) {
    tried_.error = std::numeric_limits<double>::infinity();
    return;
  }
  tried_.error = std::max(force_error(), bar_.error() / (solver_.accuracy * step_share));
  if (contact_.phase() != Phase::pressed) tried_.error = std::max(tried_.error, motion_error());
  if (followed_ && tried_.error <= 1.0) {
    followed_->solve(tried_.force, tried_.displacement, tried_.velocity);
    tried_.error = std::max(tried_.error, derivative_error());
  }
}

void CollocationRun::solve_attempt() {
  predict_force(bar_.step());
  weigh(solve());
}

/// Impulse and dissipation of the part taken. Where the step is cut, the law at the exact motion
/// knows more than the force's series.
void CollocationRun::add_to_totals() {
  const double part = tried_.part;
  if (part >= 1.0 || contact_.phase() == Phase::free) {
    totals_.impulse += integral(tried_.force, part);
    totals_.dissipated += integral(tried_.dissipation, part);
    return;
  }
  for (int i = 0; i < rule_.nodes(); ++i) {
    const PointMotion p = bar_.struck_at(part * rule_.points()[i]);
    const double weight = part * bar_.step() * rule_.weights()[i];
    totals_.impulse += weight * contact_.force(p.displacement, p.velocity);
    totals_.dissipated += weight * contact_.dissipation(p.displacement, p.velocity);
  }
  evaluations_ += rule_.nodes();
}

void CollocationRun::take_attempt() {
  ++result_.cost.steps;
  observe_attempt();
  const double h = bar_.step();
  sample_history(tried_.part * h, [&](double first, double spacing) {
    bar_.sample(first / h, spacing / h, samples_);
    if (followed_) followed_->sample(first / h, spacing / h, samples_.size());
  });
  add_to_totals();
  totals_.damped += bar_.damped(tried_.part);
  if (followed_) {
    using End = ModalSensitivities::End;
    const End end = tried_.event == Event::gap    ? End::gap
                    : tried_.event == Event::pull ? End::pull
                    : tried_.event == Event::end  ? End::time
                                                  : End::step;
    followed_->take(tried_.part, end);
  }
  bar_.take(tried_.part);
  if (tried_.event == Event::none && contact_.phase() == Phase::pressed)
    last_series_ = tried_.force_series;
  else
    last_series_.resize(0);
  last_h_ = h;
  t_ += tried_.part * h;
}

void CollocationRun::set_scales() {
  const Loading first = loading(rig_, solver_, contact_, depth_, approach_, energy_scale_);
  bar_.set_scales(first.energy, first.time);
}

void CollocationRun::first_touch() {
  time_of_touch_ = t_;
  totals_ = {};  // a damped swing before is not the impact's
  const BeamEnergy energy = bar_.energy();
  approach_ = bar_.struck().velocity;
  energy_scale_ = energy.kinetic;
  depth_ = penetration_storing(contact_, energy_scale_);
  set_scales();
  log_.begin(energy);
  impulse_scale_ = 2.0 * energy_scale_ / approach_;
  force_scale_ = contact_.elastic(depth_);
  longest_ = std::min(100.0 * depth_ / approach_, bar_.ladder().longest);
  // A first step so short that the corner of the contact law at touch does not matter.
  first_ = std::min(0.1, 3.0 * std::sqrt(solver_.accuracy)) * depth_ / approach_;
  t_end_ = time_of_touch_ + solver_.duration.value_or(longest_default_run);
  if (!(options_.history.interval > 0.0)) return;
  samples_.resize(1);
  bar_.sample(0.0, 0.0, samples_);
  laser_rest_ = samples_[0].displacement;
  const auto speed_at = [&](double x) {
    return x > 0.0 ? approach_ * x / rig_.contact.position : approach_;
  };
  begin_history(rig_, options_.history, approach_, speed_at(options_.history.velocity_position),
                speed_at(options_.history.displacement_position), result_.history);
  if (rig_.stop) result_.history.sensor_force.resize(result_.history.force.size(), 0.0);
}

void CollocationRun::touch() {
  const bool first = result_.episodes.empty();
  if (first) first_touch();
  bar_.expect_contact();
  const double speed = bar_.struck().velocity;
  log_.touch(t_ - time_of_touch_, speed, totals_, contact_);
  if (!followed_) return;
  if (first) followed_->begin();
  followed_->touch(contact_, speed, first);
}

int CollocationRun::level_after_rejection(int level) const {
  const double order = rule_.nodes() + 1.0;
  const double factor = std::isfinite(tried_.error)
                            ? std::max(0.1, step_safety * std::pow(tried_.error, -1.0 / order))
                            : 0.25;
  const int by_error = std::max(level + 1, bar_.ladder().level_below(factor * bar_.step()));
  if (tried_.event != Event::gap || contact_.phase() != Phase::pressed) return by_error;
  // hardly beyond the contact's end, where the law does not go on smoothly, or all of that way
  const int until_end = bar_.ladder().level_below(tried_.part * bar_.step()) - 1;
  return until_end > level ? until_end : by_error;
}

int CollocationRun::next_level() const {
  const double order = rule_.nodes() + 1.0;
  const double growth =
      std::clamp(step_safety * std::pow(std::max(tried_.error, 1e-12), -1.0 / order), 0.2, 6.0);
  return bar_.ladder().level_below(std::min(growth * bar_.step(), longest_));
}

/// What a step's event changes; true where it calls for the first step of a phase.
bool CollocationRun::leave_event() {
  switch (tried_.event) {
    case Event::none:
      return false;
    case Event::gap:
      if (contact_.phase() == Phase::free) {
        touch();
        return true;
      }
      log_.separate(t_ - time_of_touch_, bar_.struck().velocity, totals_, contact_);
      if (followed_ && result_.episodes.size() == 1) followed_->separate(result_);
      return false;
    case Event::pull:
      contact_.set_phase(contact_.phase() == Phase::pressed ? Phase::slack : Phase::pressed);
      return true;
    case Event::end:
      result_.termination = "the duration asked for was reached";
      return false;
  }
  return false;
}

void CollocationRun::reject(int level) {
  ++result_.cost.rejected;
  level_ = level;
  rejected_ = true;
}

void CollocationRun::judge(bool solved) {
  weigh(solved);
  find_event();
  if (tried_.error <= 1.0)
    take_or_land();
  else
    take_shorter();
  done_ = done_ || out_of_time();
}

void CollocationRun::take_shorter() {
  if (level_ >= StepLadder::levels - 1)
    throw std::runtime_error(
        fmt::format("the integration stopped {:g} s after first touch: steps of {:g} s make no "
                    "headway; ask for less accuracy",
                    t_ - time_of_touch_, bar_.step()));
  reject(level_after_rejection(level_));
}

void CollocationRun::take_or_land() {
  int next = next_level();
  if (rejected_) next = std::max(next, level_);
  rejected_ = false;
  if (const double left = t_end_ - t_; tried_.part * bar_.step() >= left) {
    tried_.part = left / bar_.step();
    tried_.event = Event::end;
  }
  if (tried_.event != Event::none && !bar_.parts_exact() && !land_on_event()) {
    reject(level_ + 2);
    return;
  }
  take_attempt();
  level_ = leave_event() ? bar_.ladder().level_below(first_) : next;
  done_ = ends_early() || tried_.event == Event::end;
  if (!done_ && leap()) done_ = ends_early() || tried_.event == Event::end;
}

/// Flight without a look at the stop while the gap cannot close; false where that is not longer
/// than a step.
bool CollocationRun::leap() {
  if (contact_.phase() != Phase::free || result_.episodes.empty()) return false;
  const double left = t_end_ - t_;
  const double time = std::min(bar_.clear_time(), left);
  if (!(time > bar_.step())) return false;
  ++result_.cost.steps;
  sample_history(
      time, [&](double first, double spacing) { bar_.sample_flight(first, spacing, samples_); });
  bar_.fly(time);
  last_series_.resize(0);
  t_ += time;
  if (time >= left) tried_.event = Event::end;
  return true;
}

/// Whether the time allowed is over. Throws when no contact is over by then.
bool CollocationRun::out_of_time() {
  if (!time_limit_.over(result_.cost.steps + result_.cost.rejected)) return false;
  const bool any = !result_.episodes.empty() && !result_.episodes.front().open;
  const std::string reached = fmt::format(
      "{:g} s of processor time, solver.time_limit, took the simulation to {:g} s {}",
      solver_.time_limit, t_ - time_of_touch_,
      result_.episodes.empty() ? "of the swing before first touch" : "after first touch");
  const std::string remedy =
      "State a shorter solver.duration, fewer elements or modes (an element much shorter than the "
      "others vibrates fast), a larger solver.accuracy, or a longer solver.time_limit.";
  if (!any)
    throw std::runtime_error(
        fmt::format("{}, before the first contact was over. {}", reached, remedy));
  result_.termination = reached;
  result_.warnings.push_back(
      fmt::format("{}; what comes later is not in the result. {}", reached, remedy));
  return true;
}

/// Whether nothing more can happen at the stop. Throws when a released bar does not reach it.
bool CollocationRun::ends_early() {
  if (result_.episodes.empty()) {
    const RigidPart rigid = bar_.rigid_part();
    if (rigid.rate < -0.1 * approach_ / rig_.contact.position)
      throw std::runtime_error(fmt::format(
          "the bar turned back {:g} rad before it touched the stop: released, it bends, and what "
          "that takes is missing; release it from further away",
          -rigid.angle));
    return false;
  }
  if (solver_.duration) return false;
  if (contact_.phase() == Phase::free &&
      left_for_good(rig_, elastic_reach_, bar_.rigid_part(), bar_.energy())) {
    result_.termination = "the bar has left the stop for good";
    return true;
  }
  if (tried_.event == Event::end) {
    result_.termination = fmt::format(
        "{:g} s after first touch the bar was still within reach of the stop", longest_default_run);
    result_.warnings.push_back(
        result_.termination +
        "; later contacts are not in the result. State solver.duration to go on.");
  }
  return false;
}

void CollocationRun::begin() {
  started_ = std::chrono::steady_clock::now();
  time_limit_ = TimeLimit(solver_.time_limit);
  if (rig_.start.release_angle && (!allows(options_, Simplification::swing_to_touch) || spring_bends_bar(rig_))) {
    bar_.start(-*rig_.start.release_angle, 0.0);
    approach_ = touch_velocity(rig_);
    const double rate = approach_ / rig_.contact.position;
    energy_scale_ = 0.5 * rig_.beam.hinge_inertia() * rate * rate;
    depth_ = penetration_storing(contact_, energy_scale_);
    set_scales();
    t_end_ = std::numeric_limits<double>::infinity();
    longest_ = bar_.ladder().longest;
    first_ = 1e-3 * *rig_.start.release_angle / rate;
  } else {
    bar_.start(0.0, touch_velocity(rig_) / rig_.contact.position);
    touch();
  }
  level_ = bar_.ladder().level_below(first_);
}

void CollocationRun::complete() {
  begin();
  while (!done_) {
    propose();
    judge(solve());
  }
}

Simulation CollocationRun::conclude() {
  log_.conclude(t_ - time_of_touch_, totals_, contact_, bar_.struck().displacement, bar_.energy(),
                bar_.rigid_part());
  result_.cost.evaluations = evaluations_;
  result_.cost.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count();
  return std::move(result_);
}

}  // namespace impactrig::models
