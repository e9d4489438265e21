// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace impactrig::models {

/// ∫ (∫₀ˣ g dξ) (∫₀ˣ h dξ) dm over a bar, g and h given at Gauss points of its parts: with ∫ of the
/// mass beyond both. Of two parts it is a product of a number each, so that the cost is that of the
/// square of the points of one part, times the parts.
class RunningProduct {
 public:
  /// A part and the points in it.
  struct Part {
    Eigen::MatrixXd within;  // both points in it (p, p)
    Eigen::VectorXd width;   // ∫ ℓ_j dx of Lagrange's polynomials at its points (p) [m]
    Eigen::VectorXd beyond;  // ∫ ℓ_j (mass beyond x) dx (p) [kg m]
  };

  /// Parts from the hinge to the tip, of as many points each.
  explicit RunningProduct(std::vector<Part> parts = {}) : parts_(std::move(parts)) {}

  /// Of each column with every point: to = W g (points, columns).
  void multiply(const Eigen::Ref<const Eigen::MatrixXd>& g, Eigen::Ref<Eigen::MatrixXd> to) const;

 private:
  std::vector<Part> parts_;
};

/// A cross-section of a bar and what mass counts there: a share of the bar's in an integral over
/// it, or a lumped mass.
struct FrameStations {
  Eigen::Index size = 0, of_bar = 0;  ///< the bar's first, from hinge to tip
  Eigen::VectorXd x;                  ///< [m]
  Eigen::VectorXd mass;               ///< [kg]
  Eigen::VectorXd pull;     ///< quadrature weight times the mass below; of the bar alone [kg m]
  Eigen::MatrixXd axial;    ///< S1 (size, axial modes)
  Eigen::MatrixXd bending;  ///< S2 (size, bending modes)
};

/// A part of a bar within which its shapes are smooth.
struct FramePart {
  double x = 0.0, length = 0.0;  ///< [m]
};

/// What motion in a floating frame needs of a bar: integrals over its mass of products of x, S1,
/// S2 and of running integrals I g = ∫₀ˣ g dξ, g being given at Gauss points of the bar's parts and
/// exact there as a polynomial through them. S2' of each mode at these points makes g of it.
struct FrameIntegrals {
  /// `points`: at which slopes are given, those of the rule of so many in every part, ascending;
  /// `slopes`: S2' there.
  FrameIntegrals(const FrameStations& stations, const std::vector<FramePart>& parts, int points,
                 Eigen::MatrixXd slopes);

  Eigen::VectorXd places, masses;               ///< x, dm (stations)
  Eigen::MatrixXd deflections, of_deflections;  ///< S2 (stations, bending modes), its transpose
  double moment, inertia;                       ///< ∫ x dm, ∫ x² dm
  Eigen::VectorXd axial, axial_moment;          ///< ∫ S1 dm, ∫ x S1 dm
  Eigen::VectorXd bending, bending_moment;      ///< ∫ S2 dm, ∫ x S2 dm
  Eigen::MatrixXd axial_axial, axial_bending, bending_bending;  ///< ∫ Siᵀ Sj dm
  Eigen::MatrixXd slopes, of_slopes;       ///< S2' (points, bending modes), and its transpose
  Eigen::VectorXd run, run_moment;         ///< ∫ I g dm, ∫ x I g dm as sums over g (points)
  Eigen::MatrixXd run_axial, run_bending;  ///< ∫ I g S dm (points, modes)
  Eigen::MatrixXd bending_run;             ///< the transpose of the latter
  RunningProduct run_run;                  ///< ∫ I g I h dm
};

/// Places of the rule of so many points in every part, from hinge to tip.
Eigen::VectorXd gauss_points(const std::vector<FramePart>& parts, int points);

}  // namespace impactrig::models
