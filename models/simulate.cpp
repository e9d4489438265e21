// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/math/tools/minima.hpp>
#include <boost/math/tools/toms748_solve.hpp>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>

#include "models/beams/ancf.hpp"
#include "models/beams/floating_frame.hpp"
#include "models/contact/contact_force.hpp"
#include "models/integration/dop853.hpp"
#include "models/simulation.hpp"

namespace impactrig::models {
namespace {

using Phase = ContactForce::Phase;
using Vector = Eigen::VectorXd;

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

/// The polynomial of degree five through position, velocity and acceleration at both ends of a
/// step, over θ in [0, 1].
class Quintic {
 public:
  Quintic(const PointMotion& p0, double a0, const PointMotion& p1, double a1, double h)
      : c_{p0.displacement, h * p0.velocity, 0.5 * h * h * a0, 0.0, 0.0, 0.0} {
    const double way = p1.displacement - c_[0] - c_[1] - c_[2];
    const double speed = h * p1.velocity - c_[1] - 2.0 * c_[2];
    const double bend = h * h * a1 - 2.0 * c_[2];
    c_[3] = 10.0 * way - 4.0 * speed + 0.5 * bend;
    c_[4] = -15.0 * way + 7.0 * speed - bend;
    c_[5] = 6.0 * way - 3.0 * speed + 0.5 * bend;
  }

  double value(double t) const {
    return c_[0] + t * (c_[1] + t * (c_[2] + t * (c_[3] + t * (c_[4] + t * c_[5]))));
  }

  double slope(double t) const {
    return c_[1] + t * (2.0 * c_[2] + t * (3.0 * c_[3] + t * (4.0 * c_[4] + t * 5.0 * c_[5])));
  }

 private:
  std::array<double, 6> c_;
};

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

/// One run: the state is y = [q (n), v (n), impulse, dissipated energy].
class Run {
 public:
  Run(const Rig& rig, const Solver& solver, const SimulationOptions& options);
  Simulation simulate();

 private:
  PointMotion struck(const Vector& y) const {
    return beam_->struck_point(y.head(n_), y.segment(n_, n_));
  }

  double gap_event(const Vector& y) const { return struck(y).displacement; }

  double pull_event(const Vector& y) const { return contact_.pull(struck(y).velocity); }

  /// Of the struck point, in a state of the given slope.
  double acceleration(const Vector& y, const Vector& slope) const {
    return beam_->struck_acceleration(y.head(n_), y.segment(n_, n_), slope.segment(n_, n_));
  }

  double total_energy(const Vector& y) const;

  void set_scales(double kinetic, double approach);
  double fastest_vibration(double depth);
  void swing_to_touch();
  void first_touch();
  void integrate();
  bool event_in_attempt(double& theta, bool& at_pull);
  double excursion_in_attempt(double sign);
  double root_of_event(bool pull, double theta_low, double theta_high);
  double land_on(double theta, bool pull);
  void touch();
  void separate();
  void observe_attempt();
  void observe_extrema();
  double peak_in_attempt(double from, double to, double& force);
  void observe_deepest(double theta);
  void sample_history();
  bool left_for_good() const;
  void conclude();

  const Rig& rig_;
  const Solver& solver_;
  const SimulationOptions& options_;
  std::unique_ptr<BeamDynamics> beam_;
  int n_;
  ContactForce contact_;
  Dop853 stepper_, probe_;
  Dop853::RightHandSide f_;
  Vector weights_, scratch_;
  double t_end_ = 0.0;
  double first_step_ = 0.0, longest_step_ = 0.0;
  double time_of_touch_ = 0.0;
  double energy_at_touch_ = 0.0;
  double elastic_reach_;  // √(2 C): how far √energy can move the struck point elastically [m/√J]
  double approach_ = 0.0;
  // at the deepest penetration of the episode: impulse and dissipated energy
  double deepest_impulse_ = 0.0, deepest_dissipated_ = 0.0;
  double episode_impulse_ = 0.0, episode_dissipated_ = 0.0;  // at its start
  double velocity_place_ = 0.0, displacement_place_ = 0.0, laser_rest_ = 0.0;
  std::vector<int> history_rows_;
  long grazing_ = 0;
  bool done_ = false;
  Simulation result_;
};

Run::Run(const Rig& rig, const Solver& solver, const SimulationOptions& options)
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

double Run::total_energy(const Vector& y) const {
  const BeamEnergy e = beam_->energy(y.head(n_), y.segment(n_, n_));
  return e.kinetic + e.elastic + e.gravitational;
}

/// The error of a step is measured against the whole kinetic energy: a velocity by the speed that
/// energy would give its coordinate, a position by the way done at that speed within an impact's
/// time.
void Run::set_scales(double kinetic, double approach) {
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
double Run::fastest_vibration(double depth) {
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
void Run::swing_to_touch() {
  const double angle = *rig_.start.release_angle;
  Vector y = Vector::Zero(2 * n_ + 2);
  beam_->set_rigid_motion(-angle, 0.0, y.head(n_), y.segment(n_, n_));
  const double drop =
      rig_.beam.mass() * rig_.gravity * 0.5 * rig_.beam.length * (1.0 - std::cos(angle));
  set_scales(drop, rig_.contact.position * std::sqrt(2.0 * drop / rig_.beam.hinge_inertia()));
  t_end_ = std::numeric_limits<double>::infinity();
  stepper_.start(0.0, y, f_);
}

void Run::first_touch() {
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

/// Looks for the first end of the phase within the attempted step: a crossing by the step's end, or
/// a gap that closes and opens again (or a contact that opens and closes) inside the step.
bool Run::event_in_attempt(double& theta, bool& at_pull) {
  const Phase phase = contact_.phase();
  // the event is sign * displacement rising through zero
  const double sign = phase == Phase::free ? 1.0 : -1.0;
  theta = 2.0;
  const PointMotion to = struck(stepper_.attempted());
  if (const double turn = excursion_in_attempt(sign); turn <= 1.0) {
    theta = root_of_event(false, 0.0, turn);
    at_pull = false;
  } else if (sign * to.displacement > 0.0) {
    theta = root_of_event(false, 0.0, 1.0);
    at_pull = false;
  }
  if (phase != Phase::free && contact_.mu() > 0.0) {
    const double turns = phase == Phase::pressed ? -1.0 : 1.0;
    if (turns * contact_.pull(to.velocity) > 0.0) {
      const double root = root_of_event(true, 0.0, 1.0);
      if (root < theta) {
        theta = root;
        at_pull = true;
      }
    }
  }
  return theta <= 1.0;
}

/// Where sign * displacement has a maximum above zero inside the attempted step; 2 without one. The
/// quintic through displacement, velocity and acceleration at both ends shows without evaluations
/// where the point turns; the dense output decides when that is near zero.
double Run::excursion_in_attempt(double sign) {
  const double h = stepper_.step();
  const PointMotion p0 = struck(stepper_.state());
  const PointMotion p1 = struck(stepper_.attempted());
  const Quintic way(p0, acceleration(stepper_.state(), stepper_.slope()), p1,
                    acceleration(stepper_.attempted(), stepper_.attempted_slope()), h);
  constexpr int parts = 8;
  double range = 0.0;
  for (int i = 0; i <= parts; ++i)
    range = std::max(range, std::abs(way.value(static_cast<double>(i) / parts) - p0.displacement));
  for (int i = 0; i < parts; ++i) {
    double low = static_cast<double>(i) / parts;
    double high = static_cast<double>(i + 1) / parts;
    if (!(sign * way.slope(low) > 0.0 && sign * way.slope(high) <= 0.0)) continue;
    if (std::max(sign * way.value(low), sign * way.value(high)) < -0.1 * range) continue;
    low = std::max(0.0, low - 0.5 / parts);
    high = std::min(1.0, high + 0.5 / parts);
    const auto outside = [&](double theta) {
      stepper_.dense(theta, f_, scratch_);
      return -sign * gap_event(scratch_);
    };
    const auto [turn, value] = boost::math::tools::brent_find_minima(outside, low, high, 20);
    if (value < 0.0) return turn;
  }
  return 2.0;
}

double Run::root_of_event(bool pull, double low, double high) {
  const auto value = [&](double theta) {
    stepper_.dense(theta, f_, scratch_);
    return pull ? pull_event(scratch_) : gap_event(scratch_);
  };
  double at_low = value(low);
  const double at_high = value(high);
  // A phase begins on its own event, where the value is a zero of rounding with either sign: start
  // a little later.
  for (double ahead = 1e-4; at_low * at_high >= 0.0 && ahead < 1.0; ahead *= 2.0) {
    low = ahead * high;
    at_low = value(low);
  }
  if (at_low * at_high >= 0.0) return 0.0;  // it never left the event
  std::uintmax_t most = 60;
  const auto [a, b] = boost::math::tools::toms748_solve(
      value, low, high, at_low, at_high, boost::math::tools::eps_tolerance<double>(48), most);
  return 0.5 * (a + b);
}

/// Steps onto the event: the root of the dense output, then one secant correction with full steps,
/// so that the state there has the order of the method. Returns the error of that step: it ends in
/// the corner of the contact law, which the longer step may have jumped over with a lucky estimate.
double Run::land_on(double theta, bool pull) {
  const double whole = stepper_.step();
  double h = theta * whole;
  double error = stepper_.attempt(h, weights_, f_);
  const PointMotion p = struck(stepper_.attempted());
  if (!pull && p.velocity != 0.0) {
    const double correction = -p.displacement / p.velocity;
    if (std::abs(correction) < 0.01 * h) {
      h += correction;
      error = stepper_.attempt(h, weights_, f_);
    }
  }
  return error;
}

void Run::touch() {
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

void Run::separate() {
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

void Run::observe_deepest(double theta) {
  stepper_.dense(theta, f_, scratch_);
  const double depth = gap_event(scratch_);
  Episode& episode = result_.episodes.back();
  if (depth <= episode.max_penetration) return;
  episode.max_penetration = depth;
  deepest_impulse_ = scratch_[2 * n_];
  deepest_dissipated_ = scratch_[2 * n_ + 1];
}

/// Where the force peaks between two places of the attempted step, found on the dense output; the
/// force itself from a step that ends there, which has the full order.
double Run::peak_in_attempt(double from, double to, double& force) {
  const auto negative_force = [&](double theta) {
    stepper_.dense(theta, f_, scratch_);
    const PointMotion p = struck(scratch_);
    return -contact_.force(p.displacement, p.velocity);
  };
  const double theta = boost::math::tools::brent_find_minima(negative_force, from, to, 40).first;
  if (-negative_force(theta) <= result_.episodes.back().peak_force) return theta;
  probe_.start(stepper_.time(), stepper_.state(), f_);
  probe_.attempt(theta * stepper_.step(), weights_, f_);
  const PointMotion p = struck(probe_.attempted());
  force = contact_.force(p.displacement, p.velocity);
  return theta;
}

/// Peak force and deepest penetration within the attempted step, where a derivative changes sign.
void Run::observe_extrema() {
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
  } else if (p1.displacement > result_.episodes.back().max_penetration) {
    Episode& episode = result_.episodes.back();
    episode.max_penetration = p1.displacement;
    deepest_impulse_ = y1[2 * n_];
    deepest_dissipated_ = y1[2 * n_ + 1];
  }
  const double rate0 =
      contact_.force_rate(p0.displacement, p0.velocity, acceleration(y0, stepper_.slope()));
  const double rate1 = contact_.force_rate(p1.displacement, p1.velocity,
                                           acceleration(y1, stepper_.attempted_slope()));
  double theta = 1.0;
  double force = contact_.force(p1.displacement, p1.velocity);
  const double h = stepper_.step();
  const double top =
      maximum_of_cubic(contact_.force(p0.displacement, p0.velocity), h * rate0, force, h * rate1);
  if (rate0 > 0.0 && rate1 < 0.0)
    theta = peak_in_attempt(0.0, 1.0, force);
  else if (top > 0.0)
    theta = peak_in_attempt(std::max(0.0, top - 0.25), std::min(1.0, top + 0.25), force);
  Episode& episode = result_.episodes.back();
  if (force > episode.peak_force) {
    episode.peak_force = force;
    episode.peak_time = stepper_.time() + theta * stepper_.step() - time_of_touch_;
  }
}

void Run::sample_history() {
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

void Run::observe_attempt() {
  observe_extrema();
  if (!result_.episodes.empty()) sample_history();
}

/// True when the rigid part of the motion has carried the struck point further than its vibration
/// can bring it back.
bool Run::left_for_good() const {
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

void Run::integrate() {
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

void Run::conclude() {
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

Simulation Run::simulate() {
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

}  // namespace

Simulation simulate(const Rig& rig, const Solver& solver, const SimulationOptions& options) {
  validate(rig, solver);
  return Run(rig, solver, options).simulate();
}

}  // namespace impactrig::models
