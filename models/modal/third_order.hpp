// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "models/collocation/bar_motion.hpp"
#include "models/modal/modal_beam.hpp"
#include "models/modal/modal_step.hpp"

namespace impactrig::models {

/// What small motion leaves out of the first contact: terms of third order in the motion, by what
/// they would have changed to first order.
///
/// In displacements w across the hanging bar of its material points forces and places of the stops
/// are linear, whatever they are. With s = w' the rest of the motion is, in coordinates a of modes
/// wⱼ,
///
///   u(x) = ∫₀ˣ ½ s² dξ − Σ Uₖ eₖ,  ëₖ + Ωₖ² eₖ = ∫ Uₖ d²/dt² ∫₀ˣ ½ s² dξ dm,  N(x) = ∫ₓᴸ ü dm
///   Qⱼ = −∫ N s wⱼ' dx
///        − ∂/∂aⱼ ∫ (½ EI w''² (s² − (s − ψ)²) + ⅛ P (s⁴ − (s − ψ)⁴) − ½ P ε s²) dx
///
/// u draws the points towards the hinge, N [N] is the pull that takes, eₖ how the bar's axial modes
/// stretch, P the weight beyond and ε the strain by it and by the turning. ψ is the angle of the
/// frame that a beam in floating coordinates bends in, to lowest order of the angle between; one in
/// absolute coordinates has no powers of s − ψ. To
/// Qⱼ [N/√kg] come what uneven bending stretches (ModalBeam::stretching_energy()) and what damping
/// couples modes by (ModalBeam::coupled_drag()), and friction in the hinge, by its sense of turning
/// at the step's ends; to the state at touch that a bar that hangs and turns is longer. Q is taken
/// as constant within a step, the contact as linear within it.
class ThirdOrder {
 public:
  explicit ThirdOrder(const ModalBeam& beam);

  /// Of the hinge [N m].
  void set_friction(double torque) { friction_ = torque; }

  /// The bar in this state meets its stop; its BarStations::find_slopes(). What uneven bending
  /// stretches is left out where it is a smaller part of the energy than `negligible`.
  void touch(const ModalState& state, const BarStations::Slopes& slopes, double negligible);

  /// A step, or the first part of one, has led to this state under this mean force; at its end the
  /// contact answers like this.
  void follow(const ModalState& state, const BarStations::Slopes& slopes, const ModalStep& step,
              double part, double contact_force, const BarMotion::ContactSlope& contact);

  /// Displacement of the struck point that is missing now [m].
  double displacement() const { return beam_.struck().dot(missing_.a); }

  /// The largest of it so far [m].
  double most_displacement() const { return most_displacement_; }

  /// What is missing of the contact's peak force [-].
  double of_peak() const { return of_peak_; }

  /// The most energy that shortening took, as a part of the largest so far: that at touch, or what
  /// weight or a spring has set free since [-].
  double shortening() const { return shortening_; }

  /// What is missing of the contact's impulse so far [-].
  double of_impulse() const { return impulse_ > 0.0 ? missing_impulse_ / impulse_ : 0.0; }

 private:
  /// Of the stations and axial modes in one state.
  struct Look {
    Eigen::VectorXd slope;              // s
    Eigen::VectorXd momentum;           // ∫ₓᴸ u̇ dm
    Eigen::VectorXd drawn, drawn_rate;  // ∫ Uₖ ∫₀ˣ ½ s² dξ dm and its rate, of each axial mode
  };

  double energy_of(const ModalState& state) const;  // [J]
  double look(const BarStations::Slopes& slopes, Look& at);
  void draw(const BarStations::Slopes& slopes, Look& at);
  void stretch(double h);
  void turn_steadily(double rate);
  void lengthen(double rate);
  double find_pull(double h, double frame);
  void find_force(const ModalState& state, double h);
  void rub(const ModalState& state);
  void move(const ModalStep& step, double part);
  void answer(const ModalStep& step, double part, double contact_force,
              const BarMotion::ContactSlope& contact);

  const ModalBeam& beam_;
  bool stretches_ = true;    // by uneven bending
  double negligible_ = 0.0;  // part of the energy that it may be
  double friction_ = 0.0;    // [N m]
  Look before_, after_;
  Eigen::VectorXd axial_, axial_rate_;  // Uₖ's part of u, of each axial mode
  Eigen::VectorXd elastic_rate_;        // ėₖ
  Eigen::VectorXd strain_;              // of the stations, by weight and turning
  Eigen::VectorXd slope_, pull_;        // of the stations
  Eigen::VectorXd force_, held_, middle_, rate_, drag_;
  ModalState last_, missing_, end_, answer_, rest_;
  BarMotion::ContactSlope contact_;
  double energy_ = 0.0, shortening_ = 0.0;
  double largest_ = 0.0, impulse_ = 0.0, missing_impulse_ = 0.0, of_peak_ = 0.0;
  double most_displacement_ = 0.0;
};

}  // namespace impactrig::models
