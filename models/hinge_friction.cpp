// SPDX-License-Identifier: BSD-3-Clause
#include "models/hinge_friction.hpp"

#include <algorithm>
#include <cmath>

namespace impactrig::models {
namespace {

// A moment that exceeds the friction's by less is rounding.
constexpr double excess = 1e-8;
// A slide lasts at least for this part of a step, whatever rounding says.
constexpr double shortest_part = 1e-9;
// One that is over in this part of a step shows that the moment at the step's beginning, known less
// well than those at the nodes, did not exceed the friction's, if it is not more than so many times
// that.
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

}  // namespace

void HingeFriction::start(double rate) {
  state_ = rate > 0.0 ? State::closes : rate < 0.0 ? State::opens : State::sticks;
  fleeting_ = false;
}

void HingeFriction::follow(const Change& change) {
  fleeting_ = slides() && change.part < fleeting_part;
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
  const bool doubted = sticks() && fleeting_ && std::abs(first) < doubtful * torque_;
  if (sticks() && !doubted && left(first) < 0.0) return {0.0, after(first)};
  double before = 0.0;
  for (int i = 0; i < rule.nodes(); ++i) {
    const double here = rule.points()[i];
    const double value = at_nodes[i];
    if (left(value) < 0.0) {
      NodeVector margin = -std::copysign(1.0, value) * series;
      if (sticks()) margin[0] += (1.0 + excess) * torque_;
      const double soonest = doubted ? rule.points()[0] : shortest_part;
      return {std::max(root(margin, before, here), soonest), after(value)};
    }
    before = here;
  }
  return {};
}

}  // namespace impactrig::models
