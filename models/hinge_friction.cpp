// SPDX-License-Identifier: BSD-3-Clause
#include "models/hinge_friction.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace impactrig::models {
namespace {

// A moment that exceeds the friction's by less is rounding.
constexpr double excess = 1e-8;
// A slide lasts at least for this part of a step, whatever rounding says.
constexpr double shortest_part = 1e-9;
// One that is over in this part of a step shows that the moment at the step's beginning, known less
// well than those at the nodes, did not exceed the friction's that way, if it is not more than so
// many times that.
constexpr double fleeting_part = 1e-3;
constexpr double doubtful = 2.0;

/// Where a Legendre series falls through zero between two places.
double root(const NodeVector& series, double positive, double negative) {
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (positive + negative);
    (legendre_sum(series, middle) > 0.0 ? positive : negative) = middle;
  }
  return negative;
}

struct Crossing {
  double above, below;  ///< places of a step
};

/// Where a smooth function falls below zero first, looked at at many places of a step and at the
/// lowest between three of them: a bar that vibrates comes to rest for an instant.
template <typename Function>
std::optional<Crossing> first_below_zero(const Function& function) {
  constexpr int places = 48;
  const auto place = [](double i) { return i / places; };
  double before = function(0.0), here = function(place(1.0));
  if (here < 0.0) return Crossing{0.0, place(1.0)};
  for (int i = 1; i < places; ++i) {
    const double next = function(place(i + 1));
    if (here < before && here <= next) {
      const double lowest = place(i + 0.5 * (before - next) / (before - 2.0 * here + next));
      if (function(lowest) < 0.0) return Crossing{place(i - 1), lowest};
    }
    if (next < 0.0) return Crossing{place(i), place(i + 1)};
    before = here;
    here = next;
  }
  return std::nullopt;
}

}  // namespace

void HingeFriction::start(double rate) {
  state_ = rate > 0.0 ? State::closes : rate < 0.0 ? State::opens : State::sticks;
  fleeting_ = State::sticks;
}

void HingeFriction::follow(const Change& change) {
  fleeting_ = change.part < fleeting_part ? state_ : State::sticks;
  state_ = change.to;
}

HingeFriction::Change HingeFriction::change(const Collocation& rule,
                                            const NodeVector& at_nodes) const {
  const NodeVector series = rule.to_series() * at_nodes;
  // how far the state is from its end, at a value of what is looked at with this sign
  const auto left = [&](double value) {
    return sticks() ? (1.0 + excess) * torque_ - std::abs(value)
                    : (state_ == State::closes ? value : -value);
  };
  const auto after = [&](double value) {
    if (!sticks()) return State::sticks;
    return value > 0.0 ? State::opens : State::closes;  // the bar would need to be held closed
  };
  const double first = legendre_sum(series, 0.0);
  const bool again = sticks() && fleeting_ == after(first);
  const bool doubted = again && std::abs(first) < doubtful * torque_;
  if (sticks() && !doubted && left(first) < 0.0) return {0.0, after(first)};
  const std::optional<Crossing> crossing =
      first_below_zero([&](double place) { return left(legendre_sum(series, place)); });
  if (!crossing) return {};
  const double value = legendre_sum(series, crossing->below);
  NodeVector margin = -std::copysign(1.0, value) * series;
  if (sticks()) margin[0] += (1.0 + excess) * torque_;
  const double soonest = doubted ? rule.points()[0] : shortest_part;
  return {std::max(root(margin, crossing->above, crossing->below), soonest), after(value)};
}

double HingeFriction::lateness(const Collocation& rule, const NodeVector& at_nodes) const {
  const NodeVector series = rule.to_series() * at_nodes;
  const double value = legendre_sum(series, 1.0);
  const double rate = rule.rates().row(rule.nodes() + 1).dot(series);
  if (rate == 0.0) return 0.0;
  return (sticks() ? value - std::copysign((1.0 + excess) * torque_, value) : value) / rate;
}

double HingeFriction::shift(const Collocation& rule, const NodeVector& at_nodes, double slope,
                            double torque_slope) const {
  const NodeVector series = rule.to_series() * at_nodes;
  const double rate = rule.rates().row(rule.nodes() + 1).dot(series);
  if (rate == 0.0) return 0.0;
  if (!sticks()) return -slope / rate;
  return (std::copysign((1.0 + excess) * torque_slope, legendre_sum(series, 1.0)) - slope) / rate;
}

}  // namespace impactrig::models
