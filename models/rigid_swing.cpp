// SPDX-License-Identifier: BSD-3-Clause
#include "models/rigid_swing.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "models/integration/dop853.hpp"

namespace impactrig::models {
namespace {

// A damped swing is integrated in steps of this part of the time in which it would turn by a
// radian: the error of a step is 1e-15 of the way.
constexpr double step_part = 0.05;
constexpr int most_swing_steps = 100'000;

}  // namespace

RigidSwing::RigidSwing(const Rig& rig)
    : inertia_(rig.beam.hinge_inertia()),
      weight_(rig.beam.first_moment() * rig.gravity),
      spring_(rig.hinge.spring),
      viscous_(rig.hinge.viscous + rig.beam.damping.mass * inertia_) {}

double RigidSwing::potential(double angle) const {
  const double half = std::sin(0.5 * angle);
  return 2.0 * weight_ * half * half + 0.5 * spring_ * angle * angle;
}

double RigidSwing::acceleration(double angle, double rate) const {
  return -(weight_ * std::sin(angle) + spring_ * angle + viscous_ * rate) / inertia_;
}

std::optional<double> RigidSwing::rate_after_release(double angle) const {
  const double energy = potential(-angle);
  if (!(energy > 0.0 && acceleration(-angle, 0.0) > 0.0)) return std::nullopt;
  if (viscous_ == 0.0) return std::sqrt(2.0 * energy / inertia_);
  const Dop853::RightHandSide f = [&](double, const Eigen::VectorXd& y,
                                      Eigen::Ref<Eigen::VectorXd> slope) {
    slope[0] = y[1];
    slope[1] = acceleration(y[0], y[1]);
  };
  const Eigen::VectorXd weights = Eigen::VectorXd::Ones(2);
  const double fastest = std::sqrt((weight_ + spring_) / inertia_) + viscous_ / inertia_;
  Dop853 swing(2);
  swing.start(0.0, Eigen::Vector2d(-angle, 0.0), f);
  for (int step = 0; step < most_swing_steps; ++step) {
    double h = step_part / fastest;
    swing.attempt(h, weights, f);
    if (!(swing.attempted()[1] > 0.0)) return std::nullopt;  // it turned back
    if (swing.attempted()[0] >= 0.0) {
      // from the last step's beginning onto the touch, by Newton's method
      for (int i = 0; i < 20 && std::abs(swing.attempted()[0]) > 1e-16 * angle; ++i) {
        h -= swing.attempted()[0] / swing.attempted()[1];
        swing.attempt(h, weights, f);
      }
      return swing.attempted()[1];
    }
    swing.accept();
    const bool creeps = swing.state()[1] < 1e-6 * fastest * angle;
    if (creeps && -swing.state()[0] < 1e-6 * angle) return std::nullopt;
  }
  return std::nullopt;
}

RigidSwing::State RigidSwing::near_touch(double time, double rate) const {
  const double decay = 0.5 * viscous_ / inertia_;
  const double square = (weight_ + spring_) / inertia_ - decay * decay;
  const double omega = std::sqrt(std::abs(square));
  double sine = time, cosine = 1.0;  // of ω t, the sine by ω
  if (square > 0.0) {
    sine = std::sin(omega * time) / omega;
    cosine = std::cos(omega * time);
  } else if (square < 0.0) {
    sine = std::sinh(omega * time) / omega;
    cosine = std::cosh(omega * time);
  }
  const double growth = std::exp(-decay * time);
  return {.angle = rate * growth * sine, .rate = rate * growth * (cosine - decay * sine)};
}

double RigidSwing::shortest_return() const {
  const double stiffness = weight_ + spring_;
  if (!(stiffness > 0.0)) return std::numeric_limits<double>::infinity();
  return std::numbers::pi * std::sqrt(inertia_ / stiffness);
}

}  // namespace impactrig::models
