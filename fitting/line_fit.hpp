// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

namespace impactrig::fitting {

/// A point both of whose coordinates have an error.
struct LinePoint {
  double x = 0.0, y = 0.0;
  double x_error = 0.0;      ///< standard deviation, ≥ 0
  double y_error = 0.0;      ///< standard deviation, > 0
  double correlation = 0.0;  ///< of the two errors, inside (−1, 1)
};

/// The straight line y = a + b x through such points.
struct LineFit {
  double slope = 0.0;      ///< b
  double intercept = 0.0;  ///< a
  double slope_error = 0.0;
  double intercept_error = 0.0;
  double q = 0.0;  ///< Σ W (y − a − b x)²
  bool converged = false;
};

/// Most likely line where both coordinates have normal errors of known variance:
///
///   W⁻¹ = s_y² + τ² + b² s_x² − 2 b c,  c = r s_x s_y,  U = x − Σ W x / Σ W,  V likewise
///   β = W (U (s_y² + τ²) + b V s_x² − (b U + V) c),  b = Σ W β V / Σ W β U
///
/// to a fixed point, from weighted least squares. `variance` is τ², scatter of y about the line
/// besides the points' own errors. Standard errors are those of the adjusted points x̄ + β,
/// σ_b⁻² = Σ W (β − β̄)², σ_a² = 1 / Σ W + (x̄ + β̄)² σ_b²; they are of first order: the errors of x
/// must be small beside the spread of x, by three times for errors in b of some percent of σ_b.
/// Without errors of x it is weighted least squares.
///
/// Throws std::invalid_argument for fewer than three points or an error that is no standard
/// deviation. Source: [YorkEtAl2004].
LineFit fit_line(std::span<const LinePoint> points, double variance = 0.0);

/// The τ² at which q = `target`; 0 where it is below that without.
double line_variance_where_q_is(double target, std::span<const LinePoint> points);

}  // namespace impactrig::fitting
