// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Cholesky>
#include <vector>

#include "models/beams/assumed_modes.hpp"
#include "models/beams/beam_dynamics.hpp"

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
/// diagonal when it hangs straight.
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
  void set_steady_motion(double angle, double rate, VectorRef q, VectorRef v) const override;
  using BeamDynamics::acceleration;
  void acceleration(ConstVector q, ConstVector v, std::span<const double> forces,
                    VectorRef a) override;
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

  /// Quadrature over the bar, then its lumped masses: a row or an entry for each of `size`.
  struct Stations {
    Eigen::Index size = 0, of_bar = 0;
    Eigen::VectorXd x;
    Eigen::VectorXd mass;      // quadrature weight times ρA, or a lumped mass [kg]
    Eigen::VectorXd pull;      // quadrature weight times the mass below; of the bar alone [kg m]
    Eigen::MatrixXd axial;     // S1 (size, n_axial)
    Eigen::MatrixXd bending;   // S2 (size, n_bending)
    Eigen::MatrixXd coupling;  // H (n_bending size, n_bending): a row of H of all, then the next
  };

  /// All stations in the frame, and how they move there.
  struct Motions {
    Eigen::VectorXd x, y, x_rate, y_rate;
    Eigen::VectorXd shortened;              // by which x is less than of the straight bar
    Eigen::MatrixXd coupled, coupled_rate;  // H b and H ḃ (size, n_bending)
  };

  /// Position in the frame and its rate, or how these change along the bar.
  struct InFrame {
    double x = 0.0, y = 0.0;
    double x_rate = 0.0, y_rate = 0.0;
  };

  Station section_at(double x) const;  // coupling left at zero
  void set_stations(const std::vector<AssumedModes::Place>& places,
                    const std::vector<LumpedMass>& masses);
  const Stations& stations() const;
  const Station& struck() const;
  void couple() const;
  void set_coupling(Eigen::Index station, const Eigen::MatrixXd& coupling) const;
  void add_coupling(double from, double to, int panels, Eigen::MatrixXd& coupling) const;
  Station station_at(double x) const;
  const Station& cached_station(double x) const;
  InFrame in_frame(const Station& station, ConstVector q, ConstVector v) const;
  const Motions& all_in_frame(ConstVector q, ConstVector v) const;
  InFrame slope_in_frame(double x, ConstVector q, ConstVector v) const;
  static PointMotion motion(const InFrame& p, ConstVector q, ConstVector v);
  Departure departure(const InFrame& p, double straight, ConstVector q) const;
  double advance(const Station& station, ConstVector from, ConstVector way) const;
  void set_mass(const Motions& p);
  void hold_hinge(VectorRef a);
  double acceleration_of(const Station& station, ConstVector q, ConstVector v, ConstVector a) const;
  void add_contact_force(const Station& station, ConstVector q, double force);

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
  // These and the struck point are coupled when it is first needed: small motion does without.
  mutable Stations stations_;
  mutable Station struck_;
  mutable bool coupled_ready_ = false;
  mutable std::vector<Station> looked_at_;  // points asked for by point(), built once
  mutable Eigen::VectorXd look_;            // scratch of looking at a point
  mutable Motions motions_;                 // scratch of looking at all stations
  // of acceleration(): the part of the mass matrix that is the same everywhere, and scratch
  Eigen::MatrixXd lasting_mass_, axial_by_root_, coupled_by_root_;
  Eigen::VectorXd root_mass_, along_, across_, force_x_, force_y_;  // of the stations
  Eigen::MatrixXd mass_;
  Eigen::VectorXd rhs_, coupled_, hinge_turns_;
  Eigen::LLT<Eigen::MatrixXd> factor_;
};

}  // namespace impactrig::models
