// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace impactrig::fitting {

/// Values with stated variances that scatter, on top of those, by a variance of their own:
///
///   y = X β + u + ε,  u ~ N(0, τ²),  ε ~ N(0, v);   w = 1 / (v + τ²),  β = (Xᵀ W X)⁻¹ Xᵀ W y
///
/// τ² by Paule and Mandel: Q(τ²) = Σ w (y − X β)² equals its expectation, the degrees of freedom
/// n − p; 0 where Q(0) is below it. An interval of β with Student's t of n − p degrees of freedom
/// is Hartung and Knapp's: their factor Q(τ²) / (n − p) is 1 by construction where τ² > 0, and is
/// not let below 1 where τ² = 0, so that agreement by luck does not narrow it.
///
/// Valid for v as known (each from many samples) and independent errors: what all values share,
/// such as a calibration, is in v but neither scatters nor averages out.
///
/// Source: [PauleMandel1982], [DerSimonianKacker2007], [HartungKnapp2001].
struct RandomEffects {
  Eigen::VectorXd coefficients;  ///< β (p)
  Eigen::MatrixXd covariance;    ///< (Xᵀ W X)⁻¹ (p, p)
  double variance = 0.0;         ///< τ²
  double q = 0.0;                ///< Cochran's: Q(0)
  long dof = 0;                  ///< n − p
};

/// `design` (n, p), `values` and `variances` (n). Throws std::invalid_argument unless n > p, all
/// sizes agree, and all numbers are finite with variances > 0.
RandomEffects random_effects(const Eigen::MatrixXd& design, const Eigen::VectorXd& values,
                             const Eigen::VectorXd& variances);

/// The τ² at which Q(τ²) = `target`; 0 where Q(0) is below it. Q falls and is convex, so Newton's
/// steps from 0 approach from below. Source: [DerSimonianKacker2007].
double variance_where_q_is(double target, const Eigen::MatrixXd& design,
                           const Eigen::VectorXd& values, const Eigen::VectorXd& variances);

}  // namespace impactrig::fitting
