// SPDX-License-Identifier: BSD-3-Clause
#include "models/modal/modal_flight.hpp"

#include <algorithm>
#include <boost/math/special_functions/ellint_1.hpp>
#include <boost/math/special_functions/jacobi_elliptic.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace impactrig::models {
namespace {

// How much further than the modes at their largest the vibration may be thought to reach.
constexpr double reach_margin = 1.05;
// How often watched_time() looks at most.
constexpr int most_looks = 1000;

/// Angle of the swing under a unit coordinate of the pendulum's mode [rad √kg⁻¹ m⁻¹].
double angle_of_mode(const ModalBeam& beam) {
  return beam.rigid()[0] / beam.rigid().squaredNorm();
}

PendulumSwing::State swing_of(const ModalBeam& beam, const ModalState& state) {
  const double scale = angle_of_mode(beam);
  return {scale * state.a[0], scale * state.rate[0]};
}

/// From where the pendulum would hang.
PendulumSwing::State about(const ModalFlight::Pendulum& pendulum, PendulumSwing::State swing) {
  swing.angle -= pendulum.rest;
  return swing;
}

/// How far the vibration can move a point [m].
double reach_of(const ModalBeam& beam, const ModalState& state, const Eigen::VectorXd& row) {
  const Eigen::Index n = beam.modes() - 1;
  const auto along = state.a.tail(n).array();
  const auto turned = state.rate.tail(n).array() / beam.omega().tail(n).array();
  return (row.tail(n).array().abs() * (along.square() + turned.square()).sqrt()).sum();
}

/// What all modes can do to a point together, whenever.
struct Vibration {
  double reach;         ///< of those that vibrate [m]
  double acceleration;  ///< [m/s²]
};

Vibration vibration_of(const ModalBeam& beam, const ModalLoad& load, const ModalState& state,
                       const Eigen::VectorXd& row) {
  const auto omega = beam.omega().array();
  const auto sizes = (omega * state.a.array()).square() + state.rate.array().square();
  return {reach_of(beam, state, row),
          (row.array().abs() * omega * sizes.sqrt()).sum() + std::abs(row[0] * load.pull())};
}

/// How far the load may bring a point nearer than swing and vibration do [m].
double held_before(const ModalLoad& load, const Eigen::VectorXd& row) {
  return load.acts() ? std::max(row.dot(load.held()), 0.0) : 0.0;
}

}  // namespace

PendulumSwing::PendulumSwing(double omega, const State& from) : omega_(omega), from_(from) {
  if (omega <= 0.0) return;
  const double high = std::sin(0.5 * from.angle);
  const double fast = 0.5 * from.rate / omega;
  modulus_ = std::hypot(high, fast);
  if (turns_over() || modulus_ == 0.0) return;
  quarter_ = boost::math::ellint_1(modulus_);
  const double rising =
      boost::math::ellint_1(modulus_, std::asin(std::clamp(high / modulus_, -1.0, 1.0)));
  phase_ = from.rate >= 0.0 ? rising : 2.0 * quarter_ - rising;
}

double PendulumSwing::widest() const {
  if (omega_ <= 0.0)
    return from_.rate == 0.0 ? std::abs(from_.angle) : std::numeric_limits<double>::infinity();
  return turns_over() ? std::numeric_limits<double>::infinity() : 2.0 * std::asin(modulus_);
}

PendulumSwing::State PendulumSwing::after(double time) const {
  if (omega_ <= 0.0) return {from_.angle + from_.rate * time, from_.rate};
  if (modulus_ == 0.0) return from_;
  const double period = 4.0 * quarter_;
  double cosine = 0.0, delta = 0.0;
  const double sine = boost::math::jacobi_elliptic(
      modulus_, std::fmod(phase_ + omega_ * time, period), &cosine, &delta);
  return {2.0 * std::asin(modulus_ * sine), 2.0 * modulus_ * omega_ * cosine};
}

PendulumSwing::State PendulumSwing::stepped(double omega, const State& from, double time) {
  const double square = omega * omega, rate = from.rate;
  const double sine = square * std::sin(from.angle), cosine = square * std::cos(from.angle);
  // derivatives of the angle, from the second on
  const double second = -sine, third = -cosine * rate;
  const double fourth = sine * rate * rate - cosine * second;
  const double fifth = cosine * rate * rate * rate + 3.0 * sine * rate * second - cosine * third;
  const double t = time;
  return {from.angle +
              t * (rate +
                   t / 2.0 * (second + t / 3.0 * (third + t / 4.0 * (fourth + t / 5.0 * fifth)))),
          rate + t * (second + t / 2.0 * (third + t / 3.0 * (fourth + t / 4.0 * fifth)))};
}

double PendulumSwing::time_up_to(double angle) const {
  const double never = std::numeric_limits<double>::infinity();
  if (omega_ <= 0.0)
    return from_.rate > 0.0 && angle > from_.angle ? (angle - from_.angle) / from_.rate : never;
  const double sine = std::sin(0.5 * angle);
  if (modulus_ == 0.0 || std::abs(sine) > modulus_) return never;
  const double there = boost::math::ellint_1(modulus_, std::asin(sine / modulus_));
  if (there > phase_) return (there - phase_) / omega_;
  // as good as there, rounding may have it just beyond: that is no period away
  if (from_.rate >= 0.0 && from_.angle <= angle) return 0.0;
  return (there + 4.0 * quarter_ - phase_) / omega_;
}

ModalFlight::Pendulum::Pendulum(const ModalBeam& beam, const ModalLoad& load)
    : omega(beam.omega()[0]),
      rest(0.0) {
  if (!load.acts()) return;
  const double pull = angle_of_mode(beam) * load.pull(), square = omega * omega;
  omega = std::sqrt(std::hypot(square, pull));
  rest = std::atan2(pull, square);
}

ModalFlight::ModalFlight(const ModalBeam& beam, const ModalLoad& load, const ModalState& from)
    : beam_(beam),
      load_(load),
      from_(from),
      pendulum_(beam, load),
      swing_(pendulum_.omega, about(pendulum_, swing_of(beam, from))) {}

double ModalFlight::reach(const Eigen::VectorXd& row) const {
  return reach_of(beam_, from_, row);
}

bool ModalFlight::may_reach(const ModalBeam& beam, const ModalLoad& load, const ModalState& state,
                            std::span<const double> gaps) {
  const double angle = swing_of(beam, state).angle;
  for (std::size_t stop = 0; stop < gaps.size(); ++stop) {
    const Eigen::VectorXd& row = beam.struck(static_cast<int>(stop));
    const double arm = row[0] / angle_of_mode(beam);
    const double near = held_before(load, row) + reach_margin * reach_of(beam, state, row);
    if (arm * angle + near >= gaps[stop]) return true;
  }
  return false;
}

double ModalFlight::clear_time(std::span<const double> gaps) const {
  const bool weighs = pendulum_.omega > 0.0;
  if (weighs && !(swing_.widest() < 0.5 * std::numbers::pi)) return 0.0;
  double time = std::numeric_limits<double>::infinity();
  for (std::size_t stop = 0; stop < gaps.size() && time > 0.0; ++stop)
    time = std::min(time, clear_time_of(beam_.struck(static_cast<int>(stop)), gaps[stop]));
  return time;
}

/// Of one stop; a point before one on the far side has a negative arm, and the swing is looked at
/// from there.
double ModalFlight::clear_time_of(const Eigen::VectorXd& row, double gap) const {
  const double arm = row[0] / angle_of_mode(beam_);
  const double angle = (gap - held_before(load_, row) - reach_margin * reach(row)) / std::abs(arm);
  const PendulumSwing::State& here = swing_.start();
  const double rest = pendulum_.rest;
  if (arm >= 0.0) return here.angle < angle - rest ? swing_.time_up_to(angle - rest) : 0.0;
  const PendulumSwing mirrored(pendulum_.omega, {-here.angle, -here.rate});
  return -here.angle < angle + rest ? mirrored.time_up_to(angle + rest) : 0.0;
}

double ModalFlight::neglected(const Eigen::VectorXd& row, double time) const {
  const double unknown = std::numeric_limits<double>::infinity();
  const double vibration = reach(row);
  if (vibration == 0.0) return swing_.turns_over() ? unknown : 0.0;
  if (!(swing_.widest() < 0.5 * std::numbers::pi)) return unknown;
  const double turned = beam_.omega()[0] * time;
  return vibration * std::pow(swing_.widest(), 2) * (0.3 + 0.15 * turned);
}

double ModalFlight::watched_time(const ModalBeam& beam, const ModalLoad& load,
                                 const ModalState& from, std::span<const double> gaps, double least,
                                 double most) {
  static thread_local ModalState there;  // at every step: no allocation
  static thread_local std::vector<Vibration> vibrations;
  there = from;
  vibrations.clear();
  for (std::size_t stop = 0; stop < gaps.size(); ++stop)
    vibrations.push_back(vibration_of(beam, load, from, beam.struck(static_cast<int>(stop))));
  const double scale = angle_of_mode(beam);
  double time = 0.0;
  for (int look = 0; look < most_looks; ++look) {
    if (look > 0) load.advance_freely(beam, time, from, there);
    double clear = most - time;
    bool near = false;
    for (std::size_t stop = 0; stop < gaps.size(); ++stop) {
      const Eigen::VectorXd& row = beam.struck(static_cast<int>(stop));
      const Vibration& vibration = vibrations[stop];
      // how far the swing still has to carry it away until the vibration cannot bring it back
      const double arm = row[0] / scale;
      const PendulumSwing::State swing{scale * there.a[0], scale * there.rate[0]};
      const double within =
          arm * swing.angle + held_before(load, row) + reach_margin * vibration.reach - gaps[stop];
      near = near || within > 0.0;
      if (within > 0.0 && arm * swing.rate < 0.0)
        clear = std::min(clear, -1.02 * within / (arm * swing.rate));
      const double speed = row.dot(there.rate);
      double room = gaps[stop] - row.dot(there.a);
      if (load.acts()) room -= row.dot(load.held());
      if (look == 0) room = std::max(room, 0.0);  // it is free, whatever rounding says
      if (!(room >= 0.0)) return time;
      // speed t + ½ acceleration t² = room, in a form that does not cancel
      const double root = std::sqrt(speed * speed + 2.0 * vibration.acceleration * room);
      if (speed > 0.0)
        clear = std::min(clear, 2.0 * room / (speed + root));
      else if (vibration.acceleration > 0.0)
        clear = std::min(clear, (root - speed) / vibration.acceleration);
    }
    if (!near) return time;
    if (time + clear >= most) return most;
    clear *= 0.99;  // of what is rounded
    if (!(clear >= least)) return time;
    time += clear;
  }
  return time;
}

void ModalFlight::state_after(double time, ModalState& to) const {
  advance(beam_, time, NodeVector::Zero(1), from_, to);
  const PendulumSwing::State swing = swing_.after(time);
  const double scale = angle_of_mode(beam_);
  to.a[0] = (swing.angle + pendulum_.rest) / scale;
  to.rate[0] = swing.rate / scale;
}

void ModalFlight::swing_on(const ModalBeam& beam, const ModalLoad& load, const ModalState& from,
                           double time, ModalState& to) {
  const double scale = angle_of_mode(beam);
  const Pendulum pendulum(beam, load);
  const PendulumSwing::State swing =
      PendulumSwing::stepped(pendulum.omega, about(pendulum, swing_of(beam, from)), time);
  to.a[0] = (swing.angle + pendulum.rest) / scale;
  to.rate[0] = swing.rate / scale;
}

double ModalFlight::drop(const ModalBeam& beam, const ModalLoad& load, const ModalState& state) {
  const double scale = angle_of_mode(beam);
  const double angle = scale * state.a[0];
  const double sine = std::sin(0.5 * angle);
  return std::pow(beam.omega()[0] / scale, 2) * (0.5 * angle * angle - 2.0 * sine * sine) -
         load.pull() / scale * (angle - std::sin(angle));
}

PointMotion ModalFlight::on_circle(const ModalBeam& beam, const ModalLoad& load,
                                   const Eigen::VectorXd& row, const ModalState& state) {
  const double scale = angle_of_mode(beam);
  const double angle = scale * state.a[0], rate = scale * state.rate[0];
  const double sine = std::sin(angle), cosine = std::cos(angle);
  const Eigen::Index others = row.size() - 1;
  const double x = row.dot(beam.rigid());
  const double weighed = row[0] / scale - x;  // how the pendulum's mode bends
  const double held = load.acts() ? row.dot(load.held()) : 0.0;
  const double bent = weighed * sine + held * cosine + row.tail(others).dot(state.a.tail(others));
  const double bending =
      (weighed * cosine - held * sine) * rate + row.tail(others).dot(state.rate.tail(others));
  return {x * sine + bent * cosine, (x * rate + bending) * cosine - bent * rate * sine};
}

}  // namespace impactrig::models
