// SPDX-License-Identifier: BSD-3-Clause
#include "models/modal/modal_run.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "models/history_recorder.hpp"
#include "models/run_limits.hpp"

namespace impactrig::models {
namespace {

// Of the accuracy asked for, what a step may spend on its impulse.
constexpr double step_share = 0.1;
// How well the motion of free flight is resolved where a touch is looked for, of the approach
// speed.
constexpr double motion_resolution = 1e-3;

int nodes_for(double accuracy) {
  return accuracy > 2e-4 ? 6 : accuracy > 2e-7 ? 8 : 12;
}

}  // namespace

ModalRun::ModalRun(const Rig& rig, const Solver& solver, const SimulationOptions& options,
                   const ModalBar& bar)
    : rig_(rig),
      solver_(solver),
      options_(options),
      bar_(bar),
      beam_(bar.modes()),
      contact_(rig),
      rule_(Collocation::of(nodes_for(solver.accuracy))),
      elastic_reach_(std::sqrt(2.0 * beam_.elastic_compliance())),
      log_(rig, solver.accuracy, result_) {
  const auto row = [&](double x) { return x > 0.0 ? beam_.point(x) : beam_.struck(); };
  if (options.history.interval > 0.0) {
    velocity_row_ = row(options.history.velocity_position);
    displacement_row_ = row(options.history.displacement_position);
  }
  result_.solver = solver;
}

/// Extrapolates the last step's force, as far as its low terms tell.
void ModalRun::predict_force(double h) {
  const int s = rule_.nodes();
  tried_.force.setZero(s);
  if (last_series_.size() == 0) return;
  const int terms = std::min(s, 4);
  NodeVector legendre(terms);
  for (int i = 0; i < s; ++i) {
    shifted_legendre(1.0 + rule_.points()[i] * h / last_h_, legendre);
    tried_.force[i] = last_series_.head(terms).dot(legendre);
  }
}

/// Newton's method on the force at the nodes; false when it does not converge.
bool ModalRun::solve_force(const NodeVector& displacement, const NodeVector& velocity) {
  const int s = rule_.nodes();
  const ModalStep::Response& response = tried_.step->response();
  const double close = std::min(3e-3, 0.03 * std::sqrt(solver_.accuracy)) * force_scale_;
  NodeVector residual(s);
  NodeMatrix jacobian(s, s);
  predict_force(tried_.step->h());
  for (int iteration = 0; iteration < 12; ++iteration) {
    const NodeVector depth = displacement + response.displacement_of_force * tried_.force;
    const NodeVector rate = velocity + response.velocity_of_force * tried_.force;
    for (int i = 0; i < s; ++i) {
      const ContactForce::Response law = contact_.pressed(depth[i], rate[i]);
      residual[i] = tried_.force[i] - law.force;
      jacobian.row(i) = -law.to_depth * response.displacement_of_force.row(i) -
                        law.to_rate * response.velocity_of_force.row(i);
      jacobian(i, i) += 1.0;
    }
    evaluations_ += s;
    const NodeVector change = jacobian.partialPivLu().solve(residual);
    tried_.force -= change;
    const double size = change.cwiseAbs().maxCoeff();

    if (!std::isfinite(size)) return false;
    if (size <= close) return true;
  }
  return false;
}

/// What a Legendre series of s terms leaves out, by its last pair: less where the pair before was
/// much larger, which a corner nearby does not let it be.
double ModalRun::truncation(const NodeVector& series) const {
  const int s = rule_.nodes();
  const double last = std::hypot(series[s - 1], series[s - 2]);
  const double before = std::hypot(series[s - 3], series[s - 4]);
  return before > 3.0 * last ? 3.0 * last * last / before : last;
}

/// What the force and its dissipation leave out over the step, as impulse and energy, against the
/// tolerance.
double ModalRun::force_error() const {
  const double tolerance = std::max(solver_.accuracy, 1e-13) * step_share;
  const double impulse = truncation(tried_.force_series) * tried_.step->h();
  const double loss = truncation(rule_.to_series() * tried_.dissipation) * tried_.step->h();
  return std::max(impulse / impulse_scale_, loss / result_.energy.initial) / tolerance;
}

double ModalRun::motion_error() const {
  const int s = rule_.nodes();
  const NodeVector series = rule_.to_series() * tried_.velocity;
  return std::hypot(series[s - 1], series[s - 2]) / (motion_resolution * approach_);
}

void ModalRun::attempt(int level) {
  const int s = rule_.nodes();
  tried_.level = level;
  tried_.step = &bar_.step(rule_, level);
  const ModalStep::Response& response = tried_.step->response();
  tried_.displacement.noalias() = response.displacement_of_a * state_.a;
  tried_.displacement.noalias() += response.displacement_of_rate * state_.rate;
  tried_.velocity.noalias() = response.velocity_of_a * state_.a;
  tried_.velocity.noalias() += response.velocity_of_rate * state_.rate;
  tried_.dissipation.setZero(s);
  tried_.event = Event::none;
  tried_.part = 1.0;
  if (contact_.phase() == Phase::pressed) {
    if (!solve_force(tried_.displacement, tried_.velocity)) {
      tried_.error = std::numeric_limits<double>::infinity();
      return;
    }
    tried_.displacement += response.displacement_of_force * tried_.force;
    tried_.velocity += response.velocity_of_force * tried_.force;
    tried_.force_series = rule_.to_series() * tried_.force;
    for (int i = 0; i < s; ++i)
      tried_.dissipation[i] = contact_.dissipation(tried_.displacement[i], tried_.velocity[i]);
    tried_.error = force_error();
  } else {
    tried_.force.setZero(s);
    tried_.force_series.setZero(s);
    if (contact_.phase() == Phase::slack)
      for (int i = 0; i < s; ++i)
        tried_.dissipation[i] = contact_.dissipation(tried_.displacement[i], tried_.velocity[i]);
    tried_.error = std::max(motion_error(), force_error());
  }
  if (contact_.phase() == Phase::pressed)
    tried_.step->advance(state_, tried_.force, tried_.end);
  else
    tried_.step->coast(state_, tried_.end);
  tried_.at_end = struck(tried_.end);
  find_event();
}

PointMotion ModalRun::motion_at(double part, double* acceleration) {
  const NodeVector series = rule_.restriction(part) * tried_.force_series;
  advance(beam_, part * tried_.step->h(), series, state_, scratch_);
  if (acceleration) {
    NodeVector legendre(rule_.nodes());
    shifted_legendre(part, legendre);
    const double force = legendre.dot(tried_.force_series);
    *acceleration = -beam_.struck().dot(beam_.omega().cwiseAbs2().cwiseProduct(scratch_.a)) -
                    beam_.struck().squaredNorm() * force;
  }
  return struck(scratch_);
}

/// Between two places of the step on either side of a closing or opening of the gap.
double ModalRun::root_of_gap(double low, double high) {
  const double h = tried_.step->h();
  double middle = 0.5 * (low + high);
  const double at_low = low > 0.0 ? motion_at(low).displacement : 0.0;
  const double sign =
      at_low != 0.0 ? (at_low < 0.0 ? 1.0 : -1.0) : (contact_.phase() == Phase::free ? 1.0 : -1.0);
  for (int i = 0; i < 60; ++i) {
    const PointMotion p = motion_at(middle);
    (sign * p.displacement > 0.0 ? high : low) = middle;
    double next = middle - p.displacement / (p.velocity * h);
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (std::abs(next - middle) < 1e-13) return next;
    middle = next;
  }
  return middle;
}

/// The first end of the phase within the step, looked for between the nodes and both ends.
void ModalRun::find_event() {
  const int s = rule_.nodes();
  const double h = tried_.step->h();
  const PointMotion start = struck(state_);
  const Phase phase = contact_.phase();
  // the event is sign * displacement rising through zero
  const double sign = phase == Phase::free ? 1.0 : -1.0;
  const auto pull = [&](double velocity) { return contact_.pull(velocity); };
  const double turns = phase == Phase::pressed ? -1.0 : 1.0;
  double before = 0.0;
  PointMotion p0 = start;
  for (int i = 0; i <= s; ++i) {
    const double here = i < s ? rule_.points()[i] : 1.0;
    const PointMotion p1 =
        i < s ? PointMotion{tried_.displacement[i], tried_.velocity[i]} : tried_.at_end;
    double gap = 2.0;
    if (sign * p1.displacement > 0.0) {
      gap = root_of_gap(before, here);
    } else if (sign * p0.velocity > 0.0 && sign * p1.velocity < 0.0) {
      // it turned on the way; by its mean deceleration, was that beyond the gap's zero, or nearly?
      const double turn = p0.velocity / (p0.velocity - p1.velocity);
      const double way = 0.5 * turn * (here - before) * h * p0.velocity;
      if (sign * p0.displacement + 2.0 * std::abs(way) > 0.0) {
        double place = before + turn * (here - before);
        double acceleration = 0.0;
        for (int k = 0; k < 3; ++k) {
          const PointMotion p = motion_at(place, &acceleration);
          if (acceleration == 0.0) break;
          place = std::clamp(place - p.velocity / (acceleration * h), before, here);
        }
        if (sign * motion_at(place).displacement > 0.0) gap = root_of_gap(before, place);
      }
    }
    double slack = 2.0;
    if (phase != Phase::free && contact_.mu() > 0.0 && turns * pull(p1.velocity) > 0.0) {
      double low = before, high = here;
      for (int k = 0; k < 60 && high - low > 1e-14; ++k) {
        const double middle = 0.5 * (low + high);
        (turns * pull(motion_at(middle).velocity) > 0.0 ? high : low) = middle;
      }
      slack = high;
    }
    if (gap <= 1.0 || slack <= 1.0) {
      tried_.event = gap <= slack ? Event::gap : Event::pull;
      tried_.part = std::min(gap, slack);
      return;
    }
    before = here;
    p0 = p1;
  }
}

void ModalRun::take_attempt() {
  ++result_.cost.steps;
  observe_attempt();
  sample_history();
  const double h = tried_.step->h();
  totals_.impulse += integral(tried_.force, tried_.part);
  totals_.dissipated += integral(tried_.dissipation, tried_.part);
  if (tried_.part < 1.0) {
    const NodeVector series = rule_.restriction(tried_.part) * tried_.force_series;
    advance(beam_, tried_.part * h, series, state_, scratch_);
    std::swap(state_, scratch_);
    last_series_.resize(0);
  } else {
    std::swap(state_, tried_.end);
    if (contact_.phase() == Phase::pressed)
      last_series_ = tried_.force_series;
    else
      last_series_.resize(0);
    last_h_ = h;
  }
  t_ += tried_.part * h;
}

void ModalRun::touch() {
  log_.touch(t_, struck(state_).velocity, totals_, contact_);
}

/// A bar that bends and turns draws its points towards the hinge; the energy of that motion is what
/// the small motion leaves out.
void ModalRun::observe_shortening() {
  neglected_ =
      std::max(neglected_, beam_.shortening_energy(state_.a, state_.rate) / result_.energy.initial);
}

void ModalRun::integrate() {
  const bool until_gone = !solver_.duration;
  const int s = rule_.nodes();
  const double depth = penetration_storing(contact_, result_.energy.initial);
  const double order = s + 1.0;
  longest_ = std::min(100.0 * depth / approach_, ModalStep::longest(beam_));
  // A first step so short that the corner of the contact law at touch does not matter.
  const double first = std::min(0.1, 3.0 * std::sqrt(solver_.accuracy)) * depth / approach_;
  int level = bar_.level_below(first);
  bool rejected = false;
  bool done = false;
  while (!done) {
    attempt(level);
    if (result_.cost.steps + result_.cost.rejected > most_steps)
      throw std::runtime_error("the integration makes no headway; ask for less accuracy");
    if (!(tried_.error <= 1.0) && tried_.level < ModalBar::most_levels - 1) {
      ++result_.cost.rejected;
      double factor = std::isfinite(tried_.error)
                          ? std::max(0.1, 0.9 * std::pow(tried_.error, -1.0 / order))
                          : 0.25;
      if (tried_.event == Event::gap && contact_.phase() == Phase::pressed)
        factor = std::max(factor, std::min(0.85 * tried_.part, 0.7));
      level = std::max(level + 1, bar_.level_below(factor * tried_.step->h()));
      rejected = true;
      continue;
    }
    const double h = tried_.step->h();
    const double growth =
        std::clamp(0.9 * std::pow(std::max(tried_.error, 1e-12), -1.0 / order), 0.2, 6.0);
    int next = bar_.level_below(std::min(growth * h, longest_));
    if (rejected) next = std::max(next, level);
    rejected = false;
    const double left = t_end_ - t_;
    if (tried_.part * h >= left) {
      tried_.part = left / h;
      tried_.event = Event::end;
    }
    take_attempt();
    switch (tried_.event) {
      case Event::none:
        level = next;
        break;
      case Event::gap:
        if (contact_.phase() == Phase::free) {
          touch();
          level = bar_.level_below(first);
        } else {
          log_.separate(t_, struck(state_).velocity, totals_, contact_);
          level = next;
        }
        break;
      case Event::pull:
        contact_.set_phase(contact_.phase() == Phase::pressed ? Phase::slack : Phase::pressed);
        level = bar_.level_below(first);
        break;
      case Event::end:
        done = true;
        result_.termination = "the duration asked for was reached";
        break;
    }
    observe_shortening();
    if (until_gone && contact_.phase() == Phase::free &&
        left_for_good(rig_, elastic_reach_, beam_.rigid_part(state_.a, state_.rate),
                      beam_.energy(state_.a, state_.rate))) {
      done = true;
      result_.termination = "the bar has left the stop for good";
    } else if (done && until_gone) {
      result_.termination =
          fmt::format("{:g} s after first touch the bar was still within reach of the stop",
                      longest_default_run);
      result_.warnings.push_back(
          result_.termination +
          "; later contacts are not in the result. State solver.duration to go on.");
    }
  }
}

Simulation ModalRun::simulate() {
  const auto started = std::chrono::steady_clock::now();
  const double speed = touch_velocity(rig_);
  state_.a = Eigen::VectorXd::Zero(beam_.modes());
  state_.rate = beam_.rigid() * (speed / rig_.contact.position);
  scratch_ = tried_.end = state_;
  approach_ = struck(state_).velocity;
  log_.begin({.kinetic = 0.5 * state_.rate.squaredNorm()});
  impulse_scale_ = 2.0 * result_.energy.initial / approach_;
  force_scale_ = contact_.elastic(penetration_storing(contact_, result_.energy.initial));
  t_end_ = solver_.duration.value_or(longest_default_run);
  if (options_.history.interval > 0.0)
    begin_history(rig_, options_.history, approach_, velocity_row_.dot(state_.rate),
                  displacement_row_.dot(state_.rate), result_.history);
  touch();
  integrate();
  log_.conclude(t_, totals_, contact_, struck(state_).displacement,
                beam_.energy(state_.a, state_.rate), beam_.rigid_part(state_.a, state_.rate));
  result_.cost.evaluations = evaluations_;
  result_.cost.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  return std::move(result_);
}

}  // namespace impactrig::models
