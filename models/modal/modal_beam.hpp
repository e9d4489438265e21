// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "models/beams/beam_dynamics.hpp"
#include "models/modal/bar_stations.hpp"
#include "models/modal/modal_slope.hpp"
#include "models/modal/small_motion.hpp"

namespace impactrig::models {

/// A bar's small motion in its own modes: ä + d ȧ + ω² a = Q − r F, with unit modal mass, a (m).
/// They are those of the undamped bar; what damping couples one to another is left out:
/// coupled_drag().
class ModalBeam {
 public:
  ModalBeam(const SmallMotionBeam& beam, const Rig& rig);

  /// How a bar differs from one of the same length, struck point and mesh.
  struct Change {
    double stiffness = 1.0;  ///< its E I over the other's
    double mass = 1.0;       ///< its ρ A over the other's, and every lumped mass likewise
    double weight = 1.0;     ///< its weight a mass over the other's
    double spring = 0.0;     ///< of its hinge [N m/rad]
    double viscous = 0.0;    ///< likewise [N m s/rad]

    /// In the bar's own time: what it is in the other's takes so many times as long.
    double time() const { return std::sqrt(mass / stiffness); }

    /// How heavy it is for its stiffness, against the other: but for length, time and mass all that
    /// tells two bars without springs and dampers apart.
    double heaviness() const { return weight * mass / stiffness; }
  };

  /// The modes of such a bar from those of one without a spring: they are nearly the same, only
  /// weight and spring bend them differently.
  ModalBeam(const ModalBeam& other, const Change& change);

  /// Becomes a bar without spring and damper between others that differ in weight alone, by the
  /// weights of an interpolation in that, then changed in stiffness and mass.
  void become_between(std::span<const ModalBeam* const> others, std::span<const double> weights,
                      const Change& change);

  int modes() const { return static_cast<int>(omega_.size()); }

  const Eigen::VectorXd& omega() const { return omega_; }  ///< [rad/s], the pendulum's first (m)

  const Eigen::VectorXd& damping() const { return damping_; }  ///< d [1/s] (m)

  const ViscousDamping& viscous() const { return viscous_; }

  bool damped() const { return damped_; }  ///< whether any mode is

  /// Of the fastest that modes vibrate or creep with, |λ| of e^{λt} [1/s].
  double fastest() const;

  /// Q, of gravity from the side [N/√kg] (m).
  const Eigen::VectorXd& load() const { return load_; }

  /// Momentum that a mode takes from others by damping, and is left out, while they move by `a`
  /// (m).
  void coupled_drag(const Eigen::VectorXd& a, Eigen::VectorXd& drag) const;

  /// Displacement of the struck point, closing > 0, under unit modal coordinates [1/√kg] (m).
  const Eigen::VectorXd& struck() const { return struck_; }

  double struck_position() const { return struck_position_; }  ///< from the hinge [m]

  int stops() const { return 1 + static_cast<int>(further_.size()); }

  /// The same of the point before a stop, towards it (m).
  const Eigen::VectorXd& struck(int stop) const {
    return stop == 0 ? struck_ : further_[static_cast<std::size_t>(stop - 1)];
  }

  /// The same of any point, x from the hinge [m].
  Eigen::VectorXd point(double x) const;

  /// How that changes along the bar: its angle there (m).
  Eigen::VectorXd point_slope(double x) const;

  /// Modal velocities of a rigid rotation at 1 rad/s, closing (m).
  const Eigen::VectorXd& rigid() const { return rigid_; }

  /// Deflection of the struck point under a unit force there, the rigid rotation taken out [m/N].
  double elastic_compliance() const { return elastic_compliance_; }

  /// What rounding may leave of the slowest bending mode's frequency, relative: much where one
  /// element is far shorter than the others.
  double rounding() const;

  /// How the modes change with a parameter on which the bar and its damping depend like this; the
  /// points before the stops apart, of which row_slope() tells. First-order perturbation: each
  /// frequency must be its mode's alone.
  ModalSlope slope(const BarInModes& change) const;

  /// SmallMotionBeam::own_values() of the modes (n, m).
  Eigen::MatrixXd own_values() const { return beam_->own_values(shapes()); }

  /// How a point's displacement under unit modal coordinates changes, whose row (n) is this and
  /// changes like that (m).
  Eigen::VectorXd row_slope(const ModalSlope& slope, const Eigen::VectorXd& row,
                            const Eigen::VectorXd& row_change) const {
    return slope.shapes.transpose() * row + rows_ * row_change;
  }

  /// The bar with frequencies, damping, load, struck points and rigid rotation moved along a slope;
  /// for its responses alone.
  ModalBeam moved(const ModalSlope& slope, double amount) const;

  /// Some of its modes, by their numbers; for their responses alone.
  ModalBeam only(const std::vector<Eigen::Index>& modes) const;

  /// The bar with a mode more that the first stop sees, as the head of a stop that gives way is
  /// one; for its responses alone.
  ModalBeam with_mode(double omega, double damping, double struck) const;

  /// Of unit modal mass (n, m); empty where the coordinates are the modes.
  Eigen::MatrixXd shapes() const { return rows_.transpose(); }

  BeamEnergy energy(const Eigen::VectorXd& a, const Eigen::VectorXd& rate) const;

  /// Of elements whose axes are cubics, what they are stretched by bending unevenly [J]: the square
  /// of a slope that changes along an element as P₁ and P₂ has parts in P₃ and P₄, which the
  /// stretch of its axis, of second degree, cannot take back. Not part of the small motion.
  double stretching_energy(const Eigen::VectorXd& a) const;

  /// The most of it, as a part of the energy of a bar that has this much [J], whatever its motion.
  double most_stretching(double energy) const { return most_stretching_ * energy; }

  /// Adds what that energy, and damping of that stretch, do to modes that move like this (m).
  void add_stretching_force(const Eigen::VectorXd& a, const Eigen::VectorXd& rate,
                            Eigen::VectorXd& force) const;

  const BarStations& stations() const { return stations_; }

  /// SmallMotionBeam::frame(), under unit modal coordinates (m).
  const Eigen::VectorXd& frame() const { return frame_; }

  /// Angle at the hinge, closing > 0, under unit modal coordinates [1/(m √kg)] (m).
  const Eigen::VectorXd& hinge() const { return hinge_; }

  bool sprung() const { return spring_ > 0.0; }  ///< a spring in the hinge

  RigidPart rigid_part(const Eigen::VectorXd& a, const Eigen::VectorXd& rate) const;

 private:
  /// A matrix of modes, once it is asked for; copies of a bar share it.
  struct Late {
    std::once_flag found;
    Eigen::MatrixXd matrix;
  };

  void hang(double weight, double spring);
  void scale(double stiffness, double mass);
  void take(BarModes modes);
  void find_damping();
  void find_stretching();
  const Eigen::MatrixXd& uneven_slopes() const;
  const Eigen::MatrixXd& whole_weight() const;

  const SmallMotionBeam* beam_;
  Eigen::MatrixXd rows_;    // of the modes' shapes (m, n); none where the coordinates are the modes
  Eigen::MatrixXd weight_;  // the hanging weight's stiffness, of the slowest (p, p), p ≤ m
  Eigen::VectorXd omega_, struck_, rigid_, load_;
  ViscousDamping viscous_;
  Eigen::VectorXd damping_;
  bool damped_ = false;
  bool all_digits_ = false;               // the modes are right to all of them, or nearly
  std::vector<Eigen::VectorXd> further_;  // of further stops
  Eigen::VectorXd hinge_;                 // hinge()
  double length_, struck_position_;       // [m]
  double spring_;                         // of the hinge [N m/rad]
  double elastic_compliance_ = 0.0;
  BarStations stations_;
  Eigen::VectorXd frame_;
  // of each element that stretches its slope's parts in P₁ and P₂, row by row (2 e, m)
  std::shared_ptr<Late> uneven_ = std::make_shared<Late>();
  std::shared_ptr<Late> whole_weight_ = std::make_shared<Late>();  // weight_ of all modes (m, m)
  Eigen::VectorXd axial_;         // EA h of each element that stretches
  double most_stretching_ = 0.0;  // of that energy, over the square of the bar's [1/J]
};

}  // namespace impactrig::models
