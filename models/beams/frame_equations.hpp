// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "models/beams/beam_dynamics.hpp"
#include "models/beams/frame_integrals.hpp"

namespace impactrig::models {

using ConstMatrix = Eigen::Ref<const Eigen::MatrixXd>;
using MatrixRef = Eigen::Ref<Eigen::MatrixXd>;

/// Weight and inertia of a bar in a floating frame, Shen et al. (2)-(10), q = [ψ, a, b] as
/// FloatingFrameBeam has it. With s = S2' b a point of the axis is in the frame at
///   x + S1 a − ½ I s²,  S2 b
/// and every sum over the bar is one over the products of s, ṡ, s̈ at the points where slopes are
/// known, so that no coupling matrix H(x) is needed: of n modes and p points a state costs some
/// p (p + n) operations. Not for concurrent use: evaluations share scratch memory.
class FrameEquations {
 public:
  /// `along`, `across`: weight of the straight bar, from hinge to tip and towards closing [m/s^2];
  /// `rotary`: a constant addition to the mass matrix (n, n), or empty.
  FrameEquations(FrameIntegrals integrals, double along, double across, Eigen::MatrixXd rotary);

  /// Generalised forces that weight and inertia leave unbalanced in states (n, k), a column each,
  /// that have accelerations a (n, k): overwrites r (n, k).
  void unbalanced(ConstMatrix q, ConstMatrix v, ConstMatrix a, MatrixRef r);

  /// Mass matrix (n, n).
  void set_mass(ConstVector q, MatrixRef mass);

  /// The mass matrix and the derivatives of unbalanced(), (n, n) each.
  struct Tangent {
    Eigen::MatrixXd mass, by_q, by_v;
  };

  void set_tangent(ConstVector q, ConstVector v, ConstVector a, Tangent& tangent);

  /// Of speeds v (n, k) at one place q: overwrites `energies` (k) [J].
  void kinetic(ConstVector q, ConstMatrix v, VectorRef energies);

  /// Against hanging straight [J]: not as a difference of places, a slow bar has less energy than
  /// that would be rounded to.
  double gravitational(ConstVector q);

  /// Moments about the hinge over the bar's own, straight: of momentum, and of the places along
  /// and across where gravity would hang the bar.
  RigidPart rigid_part(ConstVector q, ConstVector v);

 private:
  /// Sums over the bar at a place q.
  struct Place {
    Eigen::VectorXd slope, half_square;    // s, ½ s² (p)
    Eigen::VectorXd run_x, run_y;          // ∫ I g x dm, ∫ I g y dm (p)
    Eigen::VectorXd axial_x, axial_y;      // ∫ S1 x dm, ∫ S1 y dm
    Eigen::VectorXd bending_x, bending_y;  // ∫ S2 x dm, ∫ S2 y dm
    Eigen::VectorXd bending_gained;        // the former less that of the straight bar
    double x = 0.0, y = 0.0;               // ∫ x dm, ∫ y dm
    double moment_x = 0.0;                 // ∫ (x of the straight bar) x dm
    double inertia_gained = 0.0;           // ∫ x² + y² dm less that of the straight bar
  };

  /// Scratch of k states. f is what weight and inertia make of each point of the bar, a force along
  /// the frame and one across: columns of 2k are of those along, then of those across.
  struct States {
    Eigen::MatrixXd bent, slope;                   // b, ḃ, b̈ (modes, 3k); s, ṡ, s̈ (p, 3k)
    Eigen::MatrixXd shortening;                    // what of f is m I g: g (p, 2k)
    Eigen::MatrixXd deflection;                    // what of f is m S2 c: c (modes, 2k)
    Eigen::MatrixXd extension;                     // what of f is m S1 c: c (modes, 2k)
    Eigen::MatrixXd on_run, on_axial, on_bending;  // ∫ I g f, S1ᵀ f, S2ᵀ f
    Eigen::MatrixXd pull;                          // −s ∫ I g f of f along (p, k)
    Eigen::MatrixXd lateral;  // f or speed across the straight bar (stations, k)
  };

  /// In the frame at its angle [m/s^2].
  struct Weight {
    double along = 0.0, across = 0.0;
  };

  Weight weight_at(double angle) const;
  void go_to(ConstVector q);
  States& scratch_of(Eigen::Index states);
  void set_parts(States& of, Eigen::Index state, ConstVector q, ConstVector v, ConstVector a) const;
  void set_work(States& of) const;
  void add_straight(States& of, Eigen::Index state, const Weight& weight, double spin,
                    double turn) const;
  void derive_by_q(ConstVector q, ConstVector v, ConstVector a, Eigen::MatrixXd& by_q);
  void derive_by_v(ConstVector v, Eigen::MatrixXd& by_v);

  FrameIntegrals bar_;
  double along_, across_;
  Eigen::MatrixXd rotary_;
  Eigen::Index axial_, bending_, points_;
  Place at_;
  States one_, many_;

  // Of the mass matrix and the derivatives: s S2', ṡ S2' and W s S2' (p, modes), the transpose of
  // the first, and products.
  Eigen::MatrixXd turned_, turned_rate_, run_turned_, of_turned_, weighted_;
  Eigen::MatrixXd across_turned_, across_rate_, along_turned_;
  Eigen::VectorXd weights_, residual_, turn_;
};

}  // namespace impactrig::models
