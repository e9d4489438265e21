// SPDX-License-Identifier: BSD-3-Clause
#include "models/stop/stop_head.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "models/integration/gauss.hpp"

namespace impactrig::models {
namespace {

constexpr int most_terms = Collocation::block_size * Collocation::blocks;

/// How many terms the Legendre series of e^{λt} over a step of phase |λ| h needs, as the spherical
/// Bessel functions of half the phase decay.
int terms_for(double phase) {
  const double z = 0.5 * phase;
  return static_cast<int>(z + 14.0 + 6.0 * std::cbrt(z));
}

}  // namespace

StopHead::StopHead(const Stop& stop)
    : mass_(stop.mass),
      stiffness_(stop.stiffness),
      viscous_(stop.viscous),
      decay_(0.5 * stop.viscous / stop.mass),
      square_(stop.stiffness / stop.mass - decay_ * decay_),
      root_(std::sqrt(std::abs(square_))),
      fastest_(square_ >= 0.0 ? std::sqrt(stop.stiffness / stop.mass) : decay_ + root_) {}

StopHead::Mode StopHead::mode() const {
  return {std::sqrt(stiffness_ / mass_), viscous_ / mass_, -1.0 / std::sqrt(mass_)};
}

StopHead::Impulse StopHead::impulse(double t) const {
  const double angle = root_ * t;
  if (square_ >= 0.0) {
    const double shrunk = std::exp(-decay_ * t);
    const double sine = angle < 1e-8 ? t : std::sin(angle) / root_;
    return {shrunk * sine, shrunk * (std::cos(angle) - decay_ * sine)};
  }
  // the slower root as ω² / the faster one, which does not cancel
  const double slow = stiffness_ / mass_ / fastest_;
  const double shrunk = std::exp(-slow * t);
  const double apart = -0.5 * std::expm1(-2.0 * angle) / root_;
  return {shrunk * apart, shrunk * (std::exp(-2.0 * angle) - slow * apart)};
}

double StopHead::magnification(double t) const {
  const double omega = std::sqrt(stiffness_ / mass_);
  return 1.0 / (2.0 / (omega * t) + 2.0 * decay_ / omega);
}

StopHead::State StopHead::coasted(const State& from, double t) const {
  const Impulse unit = impulse(t);
  const double still = unit.velocity + 2.0 * decay_ * unit.displacement;  // x of x₀ = 1
  return {
      still * from.displacement + unit.displacement * from.velocity,
      -stiffness_ / mass_ * unit.displacement * from.displacement + unit.velocity * from.velocity};
}

double StopHead::energy(const State& state) const {
  return 0.5 * (mass_ * state.velocity * state.velocity +
                stiffness_ * state.displacement * state.displacement);
}

/// k x + c ẋ obeys the head's own equation, so that it moves on as x does: what it is and its rate
/// tell its next maximum, and those that follow are lower.
double StopHead::largest_free_force(const State& state) const {
  const State force{sensor_force(state), sensor_rate(state, 0.0)};
  const double square = stiffness_ / mass_;
  double time = 0.0;
  if (square_ > 0.0 && root_ > 1e-6 * fastest_) {
    const double turned =
        std::atan2(root_ * force.velocity, decay_ * force.velocity + square * force.displacement);
    time = (turned >= 0.0 ? turned : turned + 2.0 * std::numbers::pi) / root_;
  } else if (force.velocity > 0.0) {
    // Ṡ / S = ω² F / Ḟ there, and that is ρ coth ρt − γ
    const double slope = square * force.displacement / force.velocity + decay_;
    if (!(slope > root_)) return std::max(force.displacement, 0.0);  // it rises to none
    const double part = root_ / slope;
    time = part > 1e-6 ? std::atanh(part) / root_ : 1.0 / slope;
  }
  return std::max(force.displacement, coasted(force, time).displacement);
}

HeadStep::Transition HeadStep::transition(const StopHead& head, double t) {
  const StopHead::State of_place = head.coasted({1.0, 0.0}, t);
  const StopHead::State of_speed = head.coasted({0.0, 1.0}, t);
  return {of_place.displacement, of_speed.displacement, of_place.velocity, of_speed.velocity};
}

HeadStep::HeadStep(const StopHead& head, const Collocation& rule, double h, bool inside)
    : h_(h),
      responds_(head.fastest() * h <= longest_phase),
      end_(transition(head, h)) {
  if (inside) {
    nodes_.resize(rule.nodes(), 4);
    for (int i = 0; i < rule.nodes(); ++i) {
      const Transition t = transition(head, h * rule.points()[i]);
      nodes_.row(i) << t.xx, t.xv, t.vx, t.vv;
    }
  }
  if (responds_) respond(head, rule, inside);
}

void HeadStep::respond(const StopHead& head, const Collocation& rule, bool inside) {
  const int s = rule.nodes();
  const int terms = std::min(std::max(terms_for(head.fastest() * h_), s), most_terms);
  const int blocks = (terms + Collocation::block_size - 1) / Collocation::block_size;
  std::array<double, most_terms> displacement{}, velocity{}, legendre{};  // series of S h/m, Ṡ h/m
  const GaussRule& gauss = gauss_legendre(terms + 1);
  for (std::size_t q = 0; q < gauss.points.size(); ++q) {
    const StopHead::Impulse unit = head.impulse(h_ * gauss.points[q]);
    const double share = gauss.weights[q] * h_ / head.mass();
    shifted_legendre(gauss.points[q], Eigen::Map<Eigen::VectorXd>(legendre.data(), terms));
    for (std::size_t n = 0; n < static_cast<std::size_t>(terms); ++n) {
      const double weight = (2.0 * static_cast<double>(n) + 1.0) * share * legendre[n];
      displacement[n] += weight * unit.displacement;
      velocity[n] += weight * unit.velocity;
    }
  }
  // ∫₀¹ S(h(1 − σ)) P_p(σ) dσ = (−1)^p ∫₀¹ S(hτ) P_p(τ) dτ
  NodeVector end_displacement(s), end_velocity(s);
  for (int p = 0; p < s; ++p) {
    const auto n = static_cast<std::size_t>(p);
    const double over = (p % 2 == 0 ? 1.0 : -1.0) / (2.0 * p + 1.0);
    end_displacement[p] = over * displacement[n];
    end_velocity[p] = over * velocity[n];
  }
  end_displacement_ = rule.to_series().transpose() * end_displacement;
  end_velocity_ = rule.to_series().transpose() * end_velocity;
  if (!inside) return;
  displacement_of_force_.setZero(s, s);
  velocity_of_force_.setZero(s, s);
  Eigen::Map<Eigen::VectorXd> at_nodes(displacement_of_force_.data(), s * s);
  Eigen::Map<Eigen::VectorXd> rate_at_nodes(velocity_of_force_.data(), s * s);
  for (int b = 0; b < blocks; ++b) {
    const Eigen::MatrixXd& convolutions = rule.convolutions(b);
    const int from = b * Collocation::block_size;
    using Block = Eigen::Map<const Eigen::Matrix<double, Collocation::block_size, 1>>;
    at_nodes.noalias() += convolutions * Block(displacement.data() + from);
    rate_at_nodes.noalias() += convolutions * Block(velocity.data() + from);
  }
}

void HeadStep::coast(const StopHead::State& from, NodeVector& displacement,
                     NodeVector& velocity) const {
  displacement = from.displacement * nodes_.col(0) + from.velocity * nodes_.col(1);
  velocity = from.displacement * nodes_.col(2) + from.velocity * nodes_.col(3);
}

StopHead::State HeadStep::coasted(const StopHead::State& from) const {
  return end_(from);
}

StopHead::State HeadStep::advanced(const StopHead::State& from, const NodeVector& force) const {
  StopHead::State to = end_(from);
  to.displacement += end_displacement_.dot(force);
  to.velocity += end_velocity_.dot(force);
  return to;
}

}  // namespace impactrig::models
