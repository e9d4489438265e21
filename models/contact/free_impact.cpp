// SPDX-License-Identifier: BSD-3-Clause
#include "models/contact/free_impact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace impactrig::models {
namespace {

/// Radius of the phase plane as a logarithm, and the time.
struct State {
  double log_radius = 0.0, time = 0.0;

  State operator+(const State& other) const {
    return {log_radius + other.log_radius, time + other.time};
  }

  State operator*(double factor) const { return {log_radius * factor, time * factor}; }
};

class PhasePlane {
 public:
  PhasePlane(const ContactForce& contact, double mass, double speed)
      : contact_(contact),
        root_mass_(std::sqrt(mass)),
        start_(std::log(root_mass_ * speed)) {}

  double start() const { return start_; }

  /// The angle came to rest on the way: the bodies creep and never part.
  bool held() const { return held_; }

  struct Place {
    double penetration, rate, elastic, force;
  };

  Place at(double angle, double log_radius) const {
    const double radius = std::exp(log_radius);
    const double z = radius * std::sin(angle);
    const double rate = radius * std::cos(angle) / root_mass_;
    const double depth = penetration_storing(contact_, 0.5 * z * z);
    return {depth, rate, contact_.elastic(depth), contact_.pressed(depth, rate).force};
  }

  /// d/dφ. With z = √(2U), p = √m δ̇ and dψ = f_0 / (z √m) dt: dz/dψ = p, dp/dψ = −z f / f_0.
  State slope(double angle, const State& state) const {
    const Place here = at(angle, state.log_radius);
    const double radius = std::exp(state.log_radius);
    const double sine = std::sin(angle), cosine = std::cos(angle);
    // q p = z (f / f_0 − 1)
    const double excess = here.force / here.elastic - 1.0;  // q cot φ
    const double turning = 1.0 + sine * sine * excess;
    if (!(turning > 0.0)) held_ = true;
    return {-sine * cosine * excess / turning, root_mass_ * radius * sine / here.elastic / turning};
  }

 private:
  const ContactForce& contact_;
  double root_mass_, start_;
  mutable bool held_ = false;
};

/// Angle from the end at which steps crowd, and its derivative: φ = π/2 · u⁶ (7 − 6u), flat at the
/// deepest point, where laws that only damp on the way in have a kink.
double angle_of(double u) {
  return 0.5 * std::numbers::pi * std::pow(u, 6) * (7.0 - 6.0 * u);
}

double slope_of(double u) {
  return 0.5 * std::numbers::pi * 42.0 * std::pow(u, 5) * (1.0 - u);
}

/// Half of the impact as a way of u: closing from 0 to the deepest point at 1, or opening from
/// there back to 0.
struct Half {
  bool closing;
  int steps;

  double width() const { return (closing ? 1.0 : -1.0) / steps; }

  double place(int i) const { return closing ? i * width() : 1.0 + i * width(); }

  double angle(double u) const { return closing ? angle_of(u) : std::numbers::pi - angle_of(u); }

  /// d/du.
  State slope(const PhasePlane& plane, double u, const State& state) const {
    const double turn = slope_of(u);
    if (!(turn > 0.0)) return State{};
    return plane.slope(angle(u), state) * (closing ? turn : -turn);
  }

  /// Runge and Kutta's of the fourth order.
  State step(const PhasePlane& plane, double u, double h, const State& s) const {
    const State k1 = slope(plane, u, s);
    const State k2 = slope(plane, u + 0.5 * h, s + k1 * (0.5 * h));
    const State k3 = slope(plane, u + 0.5 * h, s + k2 * (0.5 * h));
    const State k4 = slope(plane, u + h, s + k3 * h);
    return s + (k1 + (k2 + k3) * 2.0 + k4) * (h / 6.0);
  }
};

struct End {
  double angle;
  State state;
};

/// Where the force ends within a step from u, to rounding.
End end_of_force(const PhasePlane& plane, const Half& half, double u, const State& state) {
  const double h = half.width();
  double low = 0.0, high = 1.0;
  State there;
  for (int k = 0; k < 60; ++k) {
    const double part = 0.5 * (low + high);
    there = half.step(plane, u, part * h, state);
    const double force = plane.at(half.angle(u + part * h), there.log_radius).force;
    (force > 0.0 ? low : high) = part;
  }
  return {half.angle(u + high * h), there};
}

/// Takes a place of the phase plane into the result and tells the force there.
double look(const PhasePlane& plane, double angle, double log_radius, bool loop,
            FreeImpact& result) {
  const PhasePlane::Place here = plane.at(angle, log_radius);
  if (!std::isfinite(here.force + log_radius))
    throw std::runtime_error("free_impact: the law has no finite force on the way");
  result.peak_force = std::max(result.peak_force, here.force);
  result.lowest_force = std::min(result.lowest_force, here.force);
  result.max_penetration = std::max(result.max_penetration, here.penetration);
  if (loop) result.loop.push_back({here.penetration, here.force});
  return here.force;
}

/// The force ended before the gap opened.
void conclude(const PhasePlane& plane, const End& end, bool loop, FreeImpact& result) {
  result.lowest_force = 0.0;
  if (loop) result.loop.back() = {plane.at(end.angle, end.state.log_radius).penetration, 0.0};
  result.rebound_ratio = -std::cos(end.angle) * std::exp(end.state.log_radius - plane.start());
  result.duration = end.state.time;
}

}  // namespace

FreeImpact free_impact(const ContactForce& contact, double mass, double speed, int steps,
                       bool loop) {
  ContactForce law = contact;
  law.set_phase(ContactForce::Phase::pressed);
  const PhasePlane plane(law, mass, speed);
  State state{plane.start(), 0.0};
  FreeImpact result;
  look(plane, 0.0, state.log_radius, loop, result);
  for (const bool closing : {true, false}) {
    if (!closing && law.form() == DampingForm::closing) law.set_phase(ContactForce::Phase::opening);
    const Half half{closing, steps};
    for (int i = 0; i < steps; ++i) {
      const double u = half.place(i), h = half.width();
      const State next = half.step(plane, u, h, state);
      if (plane.held()) {
        result.duration = std::numeric_limits<double>::infinity();
        return result;
      }
      const bool last = !closing && i + 1 == steps;  // the force is zero there
      const double force =
          last ? 0.0 : look(plane, half.angle(u + h), next.log_radius, loop, result);
      if (!closing && force < 0.0 && !law.may_pull()) {
        conclude(plane, end_of_force(plane, half, u, state), loop, result);
        return result;
      }
      state = next;
    }
  }
  result.rebound_ratio = std::exp(state.log_radius - plane.start());
  result.duration = state.time;
  if (loop) result.loop.push_back({0.0, 0.0});
  return result;
}

}  // namespace impactrig::models
