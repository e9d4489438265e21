// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "models/collocation/collocation.hpp"
#include "models/rig.hpp"

namespace impactrig::models {

/// The head of a compliant stop: a mass on its sensor's spring and damper, pressed by the contact
/// force F,
///
///   m ẍ + c ẋ + k x = F
///
/// x is its displacement from rest, away from the bar [m].
class StopHead {
 public:
  struct State {
    double displacement = 0.0;  ///< x [m]
    double velocity = 0.0;      ///< ẋ [m/s]
  };

  /// Motion from rest after a unit change of speed: S(t) [s], and its rate Ṡ(t) [-].
  struct Impulse {
    double displacement = 0.0;
    double velocity = 0.0;
  };

  /// The head as a mode of unit modal mass, b̈ + d ḃ + ω² b = −r F with b = √m x.
  struct Mode {
    double omega, damping;  ///< ω [rad/s], d [1/s]
    double struck;          ///< r: displacement of the contact, closing > 0, under b = 1 [1/√kg]
  };

  explicit StopHead(const Stop& stop);

  Mode mode() const;

  double mass() const { return mass_; }

  /// Magnitude of the faster root of m λ² + c λ + k: ω = √(k/m) up to critical damping [1/s].
  double fastest() const { return fastest_; }

  Impulse impulse(double t) const;

  /// What resonance makes, in a time t [s], of a force at the head's own frequency: ½ω t at first,
  /// 1/2ζ in the end, less than either between.
  double magnification(double t) const;

  /// Free for a time t [s].
  State coasted(const State& from, double t) const;

  double acceleration(const State& state, double force) const {
    return (force - sensor_force(state)) / mass_;
  }

  /// What the sensor carries, k x + c ẋ [N].
  double sensor_force(const State& state) const {
    return stiffness_ * state.displacement + viscous_ * state.velocity;
  }

  /// Its rate under a contact force [N/s].
  double sensor_rate(const State& state, double force) const {
    return stiffness_ * state.velocity + viscous_ * acceleration(state, force);
  }

  /// Of mass and spring [J].
  double energy(const State& state) const;

  /// What the damper takes [W].
  double damping_power(const State& state) const {
    return viscous_ * state.velocity * state.velocity;
  }

  /// The sensor's force in free motion does not exceed this from now on [N].
  double largest_free_force(const State& state) const;

  bool damped() const { return viscous_ > 0.0; }

 private:
  double mass_, stiffness_, viscous_;
  double decay_;   // γ = c / 2m [1/s]
  double square_;  // ω² − γ² [1/s²]
  double root_;    // √|ω² − γ²| [1/s]
  double fastest_ = 0.0;
};

/// Exact response of the head, over a step, to a force given at the nodes of a collocation rule: by
/// convolution of the force's polynomial with the Legendre series of S and Ṡ.
class HeadStep {
 public:
  /// A step this long in terms of the head's fastest() still has a response: S needs that many
  /// terms of its series.
  static constexpr double longest_phase = 300.0;

  HeadStep() = default;
  /// `inside`: whether the motion at the nodes is asked for too.
  HeadStep(const StopHead& head, const Collocation& rule, double h, bool inside = true);

  double h() const { return h_; }

  /// False where the step is longer than longest_phase; then only free motion is known.
  bool responds() const { return responds_; }

  /// At the nodes, under unit forces at the nodes (s, s).
  const NodeMatrix& displacement_of_force() const { return displacement_of_force_; }

  const NodeMatrix& velocity_of_force() const { return velocity_of_force_; }

  /// At the nodes, free (s).
  void coast(const StopHead::State& from, NodeVector& displacement, NodeVector& velocity) const;

  /// At the end, free.
  StopHead::State coasted(const StopHead::State& from) const;

  /// At the end, under a force given at the nodes.
  StopHead::State advanced(const StopHead::State& from, const NodeVector& force) const;

 private:
  void respond(const StopHead& head, const Collocation& rule, bool inside);

  /// x of x₀ and v₀, ẋ of x₀ and v₀.
  struct Transition {
    double xx = 1.0, xv = 0.0, vx = 0.0, vv = 1.0;

    StopHead::State operator()(const StopHead::State& from) const {
      return {xx * from.displacement + xv * from.velocity,
              vx * from.displacement + vv * from.velocity};
    }
  };

  static Transition transition(const StopHead& head, double t);

  double h_ = 0.0;
  bool responds_ = false;
  Transition end_;
  Eigen::Matrix<double, Eigen::Dynamic, 4, 0, most_nodes, 4> nodes_;  // transitions to the nodes
  NodeVector end_displacement_, end_velocity_;                        // of force (s)
  NodeMatrix displacement_of_force_, velocity_of_force_;
};

}  // namespace impactrig::models
