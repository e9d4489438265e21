// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>

#include "models/beams/ancf.hpp"
#include "models/beams/floating_frame.hpp"
#include "models/impact_run.hpp"

namespace impactrig::models {
namespace {

// A touch slower than this part of the first approach speed is taken as that fast in μ = d / v⁻:
// the law divides by v⁻, and a grazing touch followed by a push of the vibrating bar would
// otherwise be damped without bound.
constexpr double grazing_fraction = 0.01;
constexpr double longest_default_run = 0.1;  // [s]
constexpr long most_steps = 20'000'000;
constexpr std::size_t most_episodes = 100'000;
// The controller's tolerance for a step, as a part of the accuracy asked for over the run; the test
// of the accuracy holds it to that.
constexpr double step_share = 0.25;
// Phase per step of the bar's fastest vibration up to which the method damps it, 5.9, less what the
// frequency may be underestimated. The error estimate alone lets steps dance around that limit and
// feed the vibration: after 1e5 steps the energy had doubled.
constexpr double longest_phase = 5.6;

std::unique_ptr<BeamDynamics> make_beam(const Rig& rig, const Solver& solver) {
  switch (solver.model) {
    case BeamModel::rigid:
      return std::make_unique<FloatingFrameBeam>(rig, Basis::cantilever, 0, 0);
    case BeamModel::hybrid:
      return std::make_unique<FloatingFrameBeam>(rig, solver.basis, solver.modes,
                                                 solver.axial_modes);
    case BeamModel::ancf:
      return std::make_unique<AncfBeam>(rig, solver.elements);
  }
  throw std::logic_error("make_beam: beam model out of range");
}

}  // namespace

ImpactRun::ImpactRun(const Rig& rig, const Solver& solver, const SimulationOptions& options)
    : rig_(rig),
      solver_(solver),
      options_(options),
      beam_(make_beam(rig, solver)),
      n_(beam_->size()),
      contact_(rig),
      stepper_(2 * n_ + 2),
      probe_(2 * n_ + 2),
      weights_(2 * n_ + 2),
      scratch_(2 * n_ + 2),
      elastic_reach_(std::sqrt(2.0 * elastic_compliance(rig.beam, rig.contact.position))) {
  f_ = [this](double, const Vector& y, Eigen::Ref<Vector> slope) {
    const PointMotion p = struck(y);
    const double force = contact_.force(p.displacement, p.velocity);
    slope.head(n_) = y.segment(n_, n_);
    beam_->acceleration(y.head(n_), y.segment(n_, n_), force, slope.segment(n_, n_));
    slope[2 * n_] = force;
    slope[2 * n_ + 1] = contact_.dissipation(p.displacement, p.velocity);
  };
  result_.solver = solver;
}

double ImpactRun::total_energy(const Vector& y) const {
  const BeamEnergy e = beam_->energy(y.head(n_), y.segment(n_, n_));
  return e.kinetic + e.elastic + e.gravitational;
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
  weights_[2 * n_ + 1] = 1.0 / kinetic / tolerance;
  // The first step begins in the corner of the contact law, where the error estimate sees too
  // little: 1e-3 costs 3e-10 of the peak force, and less with the square of the step.
  longest_step_ = longest_phase / fastest_vibration(depth);
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

/// A release from rest, with the flexible bar, up to first touch.
void ImpactRun::swing_to_touch() {
  const double angle = *rig_.start.release_angle;
  Vector y = Vector::Zero(2 * n_ + 2);
  beam_->set_rigid_motion(-angle, 0.0, y.head(n_), y.segment(n_, n_));
  const double drop =
      rig_.beam.mass() * rig_.gravity * 0.5 * rig_.beam.length * (1.0 - std::cos(angle));
  set_scales(drop, rig_.contact.position * std::sqrt(2.0 * drop / rig_.beam.hinge_inertia()));
  t_end_ = std::numeric_limits<double>::infinity();
  stepper_.start(0.0, y, f_);
}

void ImpactRun::first_touch() {
  time_of_touch_ = stepper_.time();
  const Vector& y = stepper_.state();
  approach_ = struck(y).velocity;
  const BeamEnergy energy = beam_->energy(y.head(n_), y.segment(n_, n_));
  energy_at_touch_ = energy.kinetic + energy.elastic + energy.gravitational;
  result_.energy.initial = energy.kinetic;
  result_.energy.gravitational = -energy.gravitational;
  set_scales(energy.kinetic, approach_);
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
  const long before = static_cast<long>(std::ceil(wanted.lead / wanted.interval));
  History& history = result_.history;
  history.interval = wanted.interval;
  history.start = -static_cast<double>(before) * wanted.interval;
  const double omega = std::sqrt(1.5 * rig_.gravity / rig_.beam.length);
  for (long k = -before; k <= 0; ++k) {
    const double t = static_cast<double>(k) * wanted.interval;
    const double way = omega > 0.0 ? std::sin(omega * t) / omega : t;
    history.force.push_back(0.0);
    history.penetration.push_back(approach_ * way);
    history.velocity.push_back(at_velocity.velocity * std::cos(omega * t));
    history.displacement.push_back(at_laser.velocity * way);
  }
}

void ImpactRun::touch() {
  const Vector& y = stepper_.state();
  const double speed = struck(y).velocity;
  if (result_.episodes.empty()) first_touch();
  Episode episode;
  episode.start = stepper_.time() - time_of_touch_;
  episode.approach_velocity = speed;
  episode.open = true;
  result_.episodes.push_back(episode);
  if (speed < grazing_fraction * approach_) ++grazing_;
  contact_.begin_episode(std::max(speed, grazing_fraction * approach_));
  contact_.set_phase(Phase::pressed);
  episode_impulse_ = deepest_impulse_ = y[2 * n_];
  episode_dissipated_ = deepest_dissipated_ = y[2 * n_ + 1];
}

void ImpactRun::separate() {
  const Vector& y = stepper_.state();
  Episode& episode = result_.episodes.back();
  episode.end = stepper_.time() - time_of_touch_;
  episode.separation_velocity = -struck(y).velocity;
  episode.impulse = y[2 * n_] - episode_impulse_;
  episode.dissipated = y[2 * n_ + 1] - episode_dissipated_;
  episode.open = false;
  contact_.set_phase(Phase::free);
  if (result_.episodes.size() > 1) return;
  const double compression = deepest_impulse_ - episode_impulse_;
  const double stored = contact_.stored(episode.max_penetration);
  const double work_in = stored + deepest_dissipated_ - episode_dissipated_;
  const double work_out = stored - (y[2 * n_ + 1] - deepest_dissipated_);
  result_.restitution.kinematic = episode.separation_velocity / episode.approach_velocity;
  result_.restitution.kinetic = (episode.impulse - compression) / compression;
  result_.restitution.energetic = std::sqrt(std::max(work_out, 0.0) / work_in);
}

/// True when the rigid part of the motion has carried the struck point further than its vibration
/// can bring it back.
bool ImpactRun::left_for_good() const {
  if (contact_.phase() != Phase::free) return false;
  const Vector& y = stepper_.state();
  const auto q = y.head(n_);
  const auto v = y.segment(n_, n_);
  const RigidPart rigid = beam_->rigid_part(q, v);
  if (!(rigid.rate < 0.0)) return false;
  const BeamEnergy energy = beam_->energy(q, v);
  const double rotation = 0.5 * rig_.beam.hinge_inertia() * rigid.rate * rigid.rate;
  const double vibration = std::max(energy.kinetic - rotation, 0.0) + energy.elastic;
  return -rigid.angle * rig_.contact.position > elastic_reach_ * std::sqrt(vibration);
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
        contact_.set_phase(contact_.phase() == Phase::pressed ? Phase::slack : Phase::pressed);
      } else if (contact_.phase() == Phase::free) {
        touch();
      } else {
        separate();
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
    if (until_gone && !result_.episodes.empty() && left_for_good()) {
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
    if (result_.episodes.size() > most_episodes)
      throw std::runtime_error(
          fmt::format("more than {} contacts; state a shorter solver.duration", most_episodes));
  }
}

void ImpactRun::conclude() {
  const Vector& y = stepper_.state();
  const double now = stepper_.time() - time_of_touch_;
  if (!result_.episodes.empty() && result_.episodes.back().open) {
    Episode& episode = result_.episodes.back();
    episode.end = now;
    episode.separation_velocity = std::numeric_limits<double>::quiet_NaN();
    episode.impulse = y[2 * n_] - episode_impulse_;
    episode.dissipated = y[2 * n_ + 1] - episode_dissipated_;
    result_.energy.contact_stored = contact_.stored(struck(y).displacement);
    result_.warnings.push_back(
        "the run ended in contact; state a longer solver.duration to see the separation.");
  }
  result_.duration = now;
  result_.impulse = y[2 * n_];
  for (const Episode& episode : result_.episodes) {
    result_.max_penetration = std::max(result_.max_penetration, episode.max_penetration);
    if (episode.peak_force <= result_.peak_force) continue;
    result_.peak_force = episode.peak_force;
    result_.peak_time = episode.peak_time;
  }
  const BeamEnergy end = beam_->energy(y.head(n_), y.segment(n_, n_));
  const double rate = beam_->rigid_part(y.head(n_), y.segment(n_, n_)).rate;
  EnergyAudit& audit = result_.energy;
  audit.kinetic = end.kinetic;
  audit.elastic = end.elastic;
  audit.gravitational += end.gravitational;
  audit.dissipated = y[2 * n_ + 1];
  audit.rigid_rotation = 0.5 * rig_.beam.hinge_inertia() * rate * rate;
  audit.vibration = audit.kinetic + audit.elastic - audit.rigid_rotation;
  audit.imbalance = (total_energy(y) + audit.contact_stored + audit.dissipated - energy_at_touch_) /
                    audit.initial;
  result_.restitution.law = rig_.contact.restitution;
  if (result_.episodes.empty() || result_.episodes.front().open) {
    const double unknown = std::numeric_limits<double>::quiet_NaN();
    result_.restitution = {rig_.contact.restitution, unknown, unknown, unknown};
  }
  if (const double bound = 10.0 * solver_.accuracy + 1e-10; !(std::abs(audit.imbalance) <= bound))
    result_.warnings.push_back(
        fmt::format("the energy does not balance: {:.2g} of the initial energy is missing or too "
                    "much; the forces may be as far off. Ask for more solver.accuracy.",
                    audit.imbalance));
  if (grazing_ > 0)
    result_.warnings.push_back(
        fmt::format("{} contact(s) began slower than {:g} % of the first approach speed; their "
                    "damping was taken at that speed, since "
                    "the law divides by it. Forces after {:g} s depend on this choice.",
                    grazing_, 100.0 * grazing_fraction,
                    result_.episodes.size() > 1 ? result_.episodes[1].start : 0.0));
  if (result_.max_penetration > contact_.limit_penetration())
    throw std::runtime_error(
        fmt::format("the penetration of {:g} m is beyond the range of the elastic law, {:g} m; the "
                    "contact is too soft or the impact too "
                    "hard for it",
                    result_.max_penetration, contact_.limit_penetration()));
}

Simulation ImpactRun::simulate() {
  const auto started = std::chrono::steady_clock::now();
  if (rig_.start.release_angle && options_.exact) {
    swing_to_touch();
  } else {
    const double speed = touch_velocity(rig_);
    if (rig_.start.release_angle) {
      result_.skipped.push_back(
          fmt::format("the swing from {:.4g} rad to first touch: the rigid bar's energy gives "
                      "{:.6g} m/s at the struck point; "
                      "a swing this slow hardly bends the bar",
                      *rig_.start.release_angle, speed));
    }
    Vector y = Vector::Zero(2 * n_ + 2);
    beam_->set_rigid_motion(0.0, speed / rig_.contact.position, y.head(n_), y.segment(n_, n_));
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

Simulation simulate(const Rig& rig, const Solver& solver, const SimulationOptions& options) {
  validate(rig, solver);
  return ImpactRun(rig, solver, options).simulate();
}

}  // namespace impactrig::models
