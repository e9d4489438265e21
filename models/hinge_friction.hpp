// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/collocation/collocation.hpp"

namespace impactrig::models {

/// Coulomb friction in the hinge: a moment T against its rotation, and up to T while it sticks. It
/// changes only where the hinge comes to rest or breaks loose, so that the motion between is smooth
/// and follows the law exactly. A hinge that comes to rest sticks; where more than T would be
/// needed to hold it, it breaks loose at once.
///
/// Rates and moments are those of the hinge's angle, closing > 0.
class HingeFriction {
 public:
  enum class State { sticks, closes, opens };

  /// Where in a step the state ends, and what follows.
  struct Change {
    double part = 2.0;  ///< of the step; 0: it cannot even begin so; above 1: it lasts
    State to = State::sticks;
  };

  explicit HingeFriction(double torque) : torque_(torque) {}

  bool acts() const { return torque_ > 0.0; }

  bool sticks() const { return acts() && state_ == State::sticks; }

  bool slides() const { return acts() && state_ != State::sticks; }

  /// On the bar while the hinge slides, of a T [N m].
  double moment(double torque) const { return state_ == State::closes ? -torque : torque; }

  double moment() const { return moment(torque_); }

  void start(double rate);
  void follow(const Change& change);

  /// By what happens at the nodes of a step, the last at its end: the rates where it slides
  /// [rad/s], the moments that hold it where it sticks [N m].
  Change change(const Collocation& rule, const NodeVector& at_nodes) const;

  /// How far behind a step's end the state would end, as a part of the step, by the same of a step
  /// that ends near there.
  double lateness(const Collocation& rule, const NodeVector& at_nodes) const;

  /// Of a solved step that ends with the state: where that ends, as a part of the step a unit, when
  /// the rate or moment there changes by `slope` and T by `torque_slope` a unit.
  double shift(const Collocation& rule, const NodeVector& at_nodes, double slope,
               double torque_slope) const;

 private:
  double torque_;  // T [N m]
  State state_ = State::sticks;
  State fleeting_ = State::sticks;  // the slide before, where it was over at once
};

}  // namespace impactrig::models
