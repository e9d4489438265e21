// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "models/modal/modal_beam.hpp"
#include "models/modal/modal_load.hpp"
#include "models/modal/modal_step.hpp"

namespace impactrig::models {

/// A pendulum at an angle θ [rad] without damping: θ̈ = −ω² sin θ, in closed form by Jacobi's
/// elliptic functions, sin(θ/2) = k sn(ωt, k) [DLMF2010, 22.19]; weightless where ω = 0. It swings,
/// and does not turn over: k < 1.
class PendulumSwing {
 public:
  struct State {
    double angle = 0.0;  ///< [rad]
    double rate = 0.0;   ///< [rad/s]
  };

  PendulumSwing(double omega, const State& from);

  /// Whether it has the energy to turn over; nothing else is known of it then.
  bool turns_over() const { return !(modulus_ < 1.0); }

  const State& start() const { return from_; }

  double widest() const;  ///< the largest angle it reaches [rad]; infinite without weight

  State after(double time) const;

  /// Whether stepped() over such a time errs by rounding alone.
  bool is_short(double time) const { return omega_ * time < 1e-3; }

  /// From any state of it, after a short time, by its Taylor series.
  static State stepped(double omega, const State& from, double time);

  /// When it next comes up through an angle [s]; infinite when it does not.
  double time_up_to(double angle) const;

 private:
  double omega_;
  State from_;
  double modulus_ = 0.0;  // k
  double quarter_ = 0.0;  // of the period, times ω
  double phase_ = 0.0;    // ωt, from where it last came up through zero
};

/// A bar in free flight: it swings about its hinge as a pendulum, as far as it may, and vibrates in
/// its modes meanwhile. Nothing of it is stepped. For a hinge without a spring.
///
/// States are against where the load of gravity from the side holds the modes. It pulls the
/// pendulum to a side, θ̈ = γ cos θ − ω² sin θ = −Ω² sin(θ − θ₀), and bends the bar by the cosine of
/// its angle; of the weight along the bar that is by the sine.
class ModalFlight {
 public:
  ModalFlight(const ModalBeam& beam, const ModalLoad& load, const ModalState& from);

  /// The swing about where it would hang, and that [rad].
  struct Pendulum {
    double omega, rest;

    Pendulum(const ModalBeam& beam, const ModalLoad& load);
  };

  const PendulumSwing& swing() const { return swing_; }

  /// Whether the vibration could bring a point before a stop to it without the bar swinging on:
  /// clear_time() is zero then, which is known here for less, and watched_time() may not be.
  static bool may_reach(const ModalBeam& beam, const ModalLoad& load, const ModalState& state,
                        std::span<const double> gaps);

  /// For how long the points before the stops, with these gaps [m], certainly stay away from them
  /// [s]: until the swing has come so near that the vibration could reach one. Zero when it is that
  /// near, or turns over.
  double clear_time(std::span<const double> gaps) const;

  /// As clear_time(), of a bar that moves on in its modes, the swing too, where the vibration might
  /// reach a stop but does not: from look to look, each as far as gap, speed and the largest
  /// acceleration there may be let nothing happen. Ends before looks lead on by less than `least`,
  /// at `most` [s], and where the swing has carried it beyond the vibration's reach.
  static double watched_time(const ModalBeam& beam, const ModalLoad& load, const ModalState& from,
                             std::span<const double> gaps, double least, double most);

  void state_after(double time, ModalState& to) const;

  /// Where the vibration is known after a short time, the swing too.
  static void swing_on(const ModalBeam& beam, const ModalLoad& load, const ModalState& from,
                       double time, ModalState& to);

  /// How far a point may come to be from where the full equations have it after a time [m]: the
  /// wider the swing, the more its vibration departs from that of a bar that hangs. By comparison
  /// with the full equations, twice what was found there (36 swings from 0.05 to 1 rad of 0.1 to 4
  /// s of bars whose first bending mode is 5 to 200 times as fast as the swing).
  double neglected(const Eigen::VectorXd& row, double time) const;

  /// Energy by which a bar in this state is not lifted as far as its modes have it [J].
  static double drop(const ModalBeam& beam, const ModalLoad& load, const ModalState& state);

  /// Where a point is, given by its row of the modes: it goes round a circle about the hinge.
  static PointMotion on_circle(const ModalBeam& beam, const ModalLoad& load,
                               const Eigen::VectorXd& row, const ModalState& state);

 private:
  double reach(const Eigen::VectorXd& row) const;
  double clear_time_of(const Eigen::VectorXd& row, double gap) const;

  const ModalBeam& beam_;
  const ModalLoad& load_;
  const ModalState& from_;
  Pendulum pendulum_;
  PendulumSwing swing_;
};

}  // namespace impactrig::models
