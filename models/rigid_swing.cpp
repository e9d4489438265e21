// SPDX-License-Identifier: BSD-3-Clause
#include "models/rigid_swing.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "models/integration/dop853.hpp"
#include "models/integration/gauss.hpp"

namespace impactrig::models {
namespace {

// A damped swing is integrated in steps of this part of the time in which it would turn by a
// radian: the error of a step is 1e-15 of the way.
constexpr double step_part = 0.05;
constexpr int most_swing_steps = 100'000;
constexpr int places = 180;  // where a potential is looked at

}  // namespace

RigidSwing::RigidSwing(const Rig& rig)
    : inertia_(rig.beam.hinge_inertia()),
      along_(rig.beam.first_moment() * rig.gravity_along()),
      across_(rig.beam.first_moment() * rig.gravity_across()),
      spring_(rig.hinge.spring),
      viscous_(rig.hinge.viscous + rig.beam.damping.mass * inertia_),
      friction_(rig.hinge.friction) {}

double RigidSwing::potential(double angle) const {
  const double half = std::sin(0.5 * angle);
  return 2.0 * along_ * half * half - across_ * std::sin(angle) + 0.5 * spring_ * angle * angle;
}

double RigidSwing::acceleration(double angle, double rate) const {
  return (across_ * std::cos(angle) - along_ * std::sin(angle) - spring_ * angle -
          viscous_ * rate) /
         inertia_;
}

double RigidSwing::available(double angle) const {
  double lowest = potential(angle);
  for (int i = -places; i <= places; ++i)
    lowest = std::min(lowest, potential(std::numbers::pi * i / places));
  return potential(angle) - lowest;
}

/// Of the energy set free by a release at an angle, what is left with `to_go` to touch, before any
/// damping [J].
double RigidSwing::left(double angle, double to_go) const {
  return potential(-angle) - potential(-to_go) - friction_ * (angle - to_go);
}

std::optional<double> RigidSwing::rate_after_release(double angle) const {
  if (!(acceleration(-angle, 0.0) > friction_ / inertia_)) return std::nullopt;
  for (int i = 0; i < places; ++i)  // over a hill on the way
    if (!(left(angle, angle * i / places) > 0.0)) return std::nullopt;
  if (viscous_ == 0.0) return std::sqrt(2.0 * left(angle, 0.0) / inertia_);
  const auto arrival = integrate(angle);
  return arrival ? std::optional(arrival->rate) : std::nullopt;
}

std::optional<RigidSwing::Arrival> RigidSwing::arrive(double angle) const {
  const auto rate = rate_after_release(angle);
  if (!rate) return std::nullopt;
  auto arrival = integrate(angle);
  if (arrival) arrival->rate = *rate;
  return arrival;
}

/// None where the bar turns back, or creeps.
std::optional<RigidSwing::Arrival> RigidSwing::integrate(double angle) const {
  const Dop853::RightHandSide f = [this](double, const Eigen::VectorXd& y,
                                         Eigen::Ref<Eigen::VectorXd> slope) {
    slope[0] = y[1];
    slope[1] = acceleration(y[0], y[1]) - friction_ / inertia_;
  };
  const Eigen::VectorXd weights = Eigen::VectorXd::Ones(2);
  const double fastest =
      std::sqrt((std::hypot(along_, across_) + spring_) / inertia_) + viscous_ / inertia_;
  Dop853 swing(2);
  swing.start(0.0, Eigen::Vector2d(-angle, 0.0), f);
  double time = 0.0;
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
      return Arrival{swing.attempted()[1], time + h};
    }
    swing.accept();
    time += h;
    const bool creeps = swing.state()[1] < 1e-6 * fastest * angle;
    if (creeps && -swing.state()[0] < 1e-6 * angle) return std::nullopt;
  }
  return std::nullopt;
}

RigidSwing::State RigidSwing::near_touch(double time, double rate) const {
  const double decay = 0.5 * viscous_ / inertia_;
  const double square = (along_ + spring_) / inertia_ - decay * decay;
  const double omega = std::sqrt(std::abs(square));
  // angle and rate after touching at a unit rate
  const auto unit = [&](double t) -> State {
    double sine = t, cosine = 1.0;  // of ω t, the sine by ω
    if (square > 0.0) {
      sine = std::sin(omega * t) / omega;
      cosine = std::cos(omega * t);
    } else if (square < 0.0) {
      sine = std::sinh(omega * t) / omega;
      cosine = std::cosh(omega * t);
    }
    const double growth = std::exp(-decay * t);
    return {.angle = growth * sine, .rate = growth * (cosine - decay * sine)};
  };
  const State by_rate = unit(time);
  State state{.angle = rate * by_rate.angle, .rate = rate * by_rate.rate};
  if (across_ == friction_) return state;
  // Duhamel's integral of a constant moment
  const double pull = (across_ - friction_) / inertia_;
  const GaussRule& rule = gauss_legendre(12);
  const int panels = 1 + static_cast<int>((omega + decay) * std::abs(time));
  for (int p = 0; p < panels; ++p)
    for (std::size_t g = 0; g < rule.points.size(); ++g)
      state.angle +=
          pull * rule.weights[g] * time / panels * unit(time * (p + rule.points[g]) / panels).angle;
  state.rate += pull * by_rate.angle;
  return state;
}

bool RigidSwing::pulled_back(double angle, double rate) const {
  if (!(across_ > 0.0)) return false;
  double highest = 0.0;
  for (int i = 0; i <= places; ++i)
    highest = std::max(highest, potential(-std::numbers::pi * i / places));
  return 0.5 * inertia_ * rate * rate + potential(angle) <= highest;
}

double RigidSwing::shortest_return() const {
  const double stiffness = std::hypot(along_, across_) + spring_;
  if (!(stiffness > 0.0)) return std::numeric_limits<double>::infinity();
  return std::numbers::pi * std::sqrt(inertia_ / stiffness);
}

}  // namespace impactrig::models
