// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Cholesky>
#include <memory>
#include <vector>

#include "models/beams/assumed_modes.hpp"
#include "models/beams/beam_dynamics.hpp"
#include "models/beams/frame_equations.hpp"

namespace impactrig::models {

/// Hybrid coordinates: a floating frame that turns with the hinge and modal deformation in it, with
/// the foreshortening terms kept: Shen et al. (1)-(17). Without modes it is the rigid pendulum.
///
/// q = [ψ, a (axial modes), b (bending modes)], ψ = θ + π/2 the frame's angle from hanging
/// straight. A point of the axis is
///   X = sin ψ (x + w) + cos ψ v,   w = S1 a − b'H(x) b / 2,   v = S2 b,   H(x) = ∫₀ˣ S2'ᵀ S2' dξ
///   (2)-(4)
/// and touches the stop at X = 0. S2 are the modes of the chosen basis with unit modal mass, S1 the
/// modes sin((2k − 1) π x / 2L) likewise. Integrals over the bar are taken by one Gauss rule of 20
/// + 4n points, in every element where the shapes come from a mesh: products of two modes come out
/// to rounding, the small products of four to a few digits less. Masses on the bar are further
/// points of that sum; the shapes stay those of the bar alone, so the mass matrix is no longer
/// diagonal when it hangs straight. H is taken by Gauss points of its own, 20 + 4n in the bar or
/// five in every element (FrameIntegrals).
///
/// The axis at the hinge is at the angle ψ + v'(0), v'(0) = 0 for the cantilever's modes.
///
/// Timoshenko's bar has shapes (v, ϑ), ϑ the rotation of the sections against the frame; these turn
/// at ψ̇ + ϑ̇ with rotary inertia ρI, a constant addition to the mass matrix, and the hinge at ψ +
/// ϑ(0).
///
/// Kelvin-Voigt damping acts on the modal rates ȧ and ḃ, which a rotation of the frame leaves
/// alone.
///
/// Valid while v' is small: the foreshortening is exact to second order in v'; it is what stiffens
/// a spinning bar. The energy ½ ∫ EI v''² of the bending lacks ½ ∫ EI v'² v''² of the next order.
class FloatingFrameBeam : public BeamDynamics {
 public:
  FloatingFrameBeam(const Rig& rig, Basis basis, int modes, int axial_modes);

  int size() const override { return 1 + axial_ + bending_; }

  Eigen::VectorXd inertia_diagonal() const override;
  void set_rigid_motion(double angle, double rate, VectorRef q, VectorRef v) const override;
  bool set_steady_motion(double angle, double rate, VectorRef q, VectorRef v) const override;
  using BeamDynamics::acceleration;
  void acceleration(ConstVector q, ConstVector v, std::span<const double> forces,
                    VectorRef a) override;
  /// Generalised forces that states (n, k), a column each, leave unbalanced when they have
  /// accelerations a (n, k), pressed by forces (k, stops) [N, compression > 0]: overwrites r (n,
  /// k). All at once cost far less than one after the other, and less than acceleration(), which
  /// has to solve for what these are zero at. drive() counts by its moment; see hold_hinge().
  void unbalanced(ConstMatrix q, ConstMatrix v, ConstMatrix a, ConstMatrix forces, MatrixRef r);

  /// The mass matrix, and the derivatives of unbalanced() without forces, (n, n) each.
  using Tangent = FrameEquations::Tangent;

  void set_tangent(ConstVector q, ConstVector v, ConstVector a, Tangent& tangent);

  /// Makes of generalised forces (n, k) those that remain when a moment on the hinge balances the
  /// first, the frame's.
  void balance_hinge(MatrixRef forces) const;

  /// The same of the unbalanced forces of accelerations a, and puts what the hinge's acceleration
  /// lacks of a stated one, closing > 0 [rad/s^2], times an inertia, in place of the first. Returns
  /// the moment that holds it, closing > 0 [N m].
  double hold_hinge(ConstVector a, double acceleration, VectorRef r) const;
  void hold_hinge(Tangent& tangent) const;

  /// The generalised forces of a unit force of each stop, (n, stops).
  void set_pressed(ConstVector q, MatrixRef pressed);

  /// Of speeds v (n, k) at one place q: overwrites `energies` (k) [J].
  void kinetic(ConstVector q, ConstMatrix v, VectorRef energies) const {
    equations().kinetic(q, v, energies);
  }

  PointMotion struck_point(ConstVector q, ConstVector v) const override;
  double struck_acceleration(ConstVector q, ConstVector v, ConstVector a) const override;

  /// How far a point of the axis comes from a state to another, `way` on from there, closing > 0
  /// [m]: to all the digits of the way, which the states themselves need not have.
  double struck_advance(ConstVector from, ConstVector way) const {
    return advance(struck(), from, way);
  }

  double point_advance(double x, ConstVector from, ConstVector way) const {
    return advance(cached_station(x), from, way);
  }

  double point_acceleration(double x, ConstVector q, ConstVector v, ConstVector a) const override;
  PointMotion point(double x, ConstVector q, ConstVector v) const override;
  std::vector<int> coordinates_of(double x) const override;
  SmallMotion small_motion() const override;
  Eigen::VectorXd small_motion_row(double x) const override;
  Eigen::VectorXd small_motion_load() const override;
  Eigen::MatrixXd strains(const Eigen::MatrixXd& own) const override;

  Eigen::VectorXd frame() const override { return -Eigen::VectorXd::Unit(1 + bending_, 0); }

  std::optional<int> axial_modes() const override { return axial_; }

  double damping_power(ConstVector q, ConstVector v) const override;
  BeamEnergy energy(ConstVector q, ConstVector v) const override;
  RigidPart rigid_part(ConstVector q, ConstVector v) const override;

  /// What turns the hinge besides its spring and damper, closing > 0: a moment [N m], or whatever
  /// moment gives its angle an acceleration [rad/s^2].
  struct HingeDrive {
    bool held = false;
    double moment = 0.0, acceleration = 0.0;
  };

  void drive(const HingeDrive& drive) { drive_ = drive; }

  /// That held the hinge in the last acceleration(), closing > 0 [N m].
  double holding_moment() const { return holding_moment_; }

  /// A point against the straight bar at the hinge's angle: across it, closing > 0, and along [m].
  struct Departure {
    double deflection = 0.0, extension = 0.0;
  };

  Departure departure(double x, ConstVector q) const;

  /// How what point() tells changes along the bar: [-], [1/s].
  PointMotion point_slope(double x, ConstVector q, ConstVector v) const;
  Departure departure_slope(double x, ConstVector q) const;

  double hinge_angle(ConstVector q) const { return -hinge_row_.dot(q); }

  double hinge_rate(ConstVector v) const { return -hinge_row_.dot(v); }

  /// Turns the whole bar so that its hinge has this angle and rate.
  void set_hinge(double angle, double rate, VectorRef q, VectorRef v) const {
    q[0] += hinge_angle(q) - angle;
    v[0] += hinge_rate(v) - rate;
  }

 private:
  /// A cross-section: its place, shape functions and coupling matrix.
  struct Station {
    double x = 0.0;
    Eigen::VectorXd axial;     // S1 (n_axial)
    Eigen::VectorXd bending;   // S2 (n_bending)
    Eigen::MatrixXd coupling;  // H (n_bending, n_bending)
  };

  /// Position in the frame and its rate, or how these change along the bar.
  struct InFrame {
    double x = 0.0, y = 0.0;
    double x_rate = 0.0, y_rate = 0.0;
  };

  Station section_at(double x) const;  // coupling left at zero
  void set_stations(const std::vector<AssumedModes::Place>& places,
                    const std::vector<LumpedMass>& masses);
  FrameEquations& equations() const;
  const Station& struck() const;
  void add_coupling(double from, double to, int panels, Eigen::MatrixXd& coupling) const;
  Station station_at(double x) const;
  const Station& cached_station(double x) const;
  InFrame in_frame(const Station& station, ConstVector q, ConstVector v) const;
  InFrame slope_in_frame(double x, ConstVector q, ConstVector v) const;
  static PointMotion motion(const InFrame& p, ConstVector q, ConstVector v);
  Departure departure(const InFrame& p, double straight, ConstVector q) const;
  double advance(const Station& station, ConstVector from, ConstVector way) const;
  void add_springs(ConstVector q, ConstVector v, VectorRef r) const;
  void hold_hinge(VectorRef a);
  double acceleration_of(const Station& station, ConstVector q, ConstVector v, ConstVector a) const;
  void add_stop(int stop, ConstVector q, double force, VectorRef r);
  void add_force(const Station& station, ConstVector q, double force, VectorRef r);

  int axial_;
  int bending_;
  double length_;
  double inertia_;                   // about the hinge, straight [kg m^2]
  double gravity_, gravity_across_;  // from hinge to tip and towards closing, of the straight bar
  Hinge hinge_;
  BarDamping damping_;
  std::vector<FurtherStop> further_stops_;
  bool timoshenko_;
  Eigen::VectorXd hinge_row_;  // q to the angle at the hinge, opening > 0 (n)
  HingeDrive drive_;
  double holding_moment_ = 0.0;
  double axial_scale_ = 0.0;
  AssumedModes modes_;
  Eigen::VectorXd stiffness_;  // modal, ω² (n), 0 for ψ
  Eigen::MatrixXd rotary_;     // rotary inertia of the sections of a bar that shears (n, n)
  FrameStations stations_;
  int fineness_;  // of the rule of closed forms
  // Made when first needed: small motion does without.
  mutable std::unique_ptr<FrameEquations> equations_;
  mutable Station struck_;
  mutable bool struck_coupled_ = false;
  mutable std::vector<Station> looked_at_;  // points asked for by point(), built once
  mutable Eigen::VectorXd look_, kinetic_;  // scratch of looking at a point, and of energy()
  // scratch of acceleration() and unbalanced()
  Eigen::MatrixXd mass_, with_damping_;
  Eigen::VectorXd rhs_, coupled_, hinge_turns_, at_rest_;
  Eigen::LLT<Eigen::MatrixXd> factor_;
};

}  // namespace impactrig::models
