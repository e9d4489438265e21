// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fitting/metrics/history_pair.hpp"

namespace impactrig::fitting {

/// Pearson's correlation Σ(m − m̄)(c − c̄) / √(Σ(m − m̄)² Σ(c − c̄)²) [-], in [−1, 1]. Blind to
/// scale and offset. NaN where one of the two is constant.
double correlation(const HistoryPair& pair);

/// Coefficient of determination R² = 1 − Σ(c − m)² / Σ(m − m̄)² [-], ≤ 1; negative where c is
/// further from m than m's own mean is. NaN where m is constant.
double r_squared(const HistoryPair& pair);

/// RMSE = √(Σ(c − m)² / n) and what it is of the measured history; always name the divisor. An
/// NRMSE whose divisor is zero is NaN.
struct RootMeanSquareError {
  double rmse = 0.0;      ///< [unit of m]
  double of_peak = 0.0;   ///< RMSE / max|m| [-]
  double of_range = 0.0;  ///< RMSE / (max m − min m) [-]
  double of_rms = 0.0;    ///< RMSE / √(Σm² / n) [-]
};

RootMeanSquareError root_mean_square_error(const HistoryPair& pair);

/// Residuals r_i = (m_i − c_i) / max|m| [-]: m − c, so that a mean > 0 says that the computed
/// history is too small.
struct ResidualAnalysis {
  double mean = 0.0;       ///< r̄
  double deviation = 0.0;  ///< s, standard deviation (n − 1); NaN for one sample
  double t = 0.0;          ///< r̄ √n / s, as if samples were independent; NaN where s = 0
  /// Lag-1 autocorrelation Σ(r_i − r̄)(r_{i+1} − r̄) / Σ(r_i − r̄)²; NaN where s = 0.
  double lag1 = 0.0;
  double effective_samples = 0.0;  ///< effective_samples() of r; NaN where s = 0
  double t_effective = 0.0;        ///< r̄ √(effective samples) / s
};

/// Ray's analysis of variance. t above its quantile says that the mean residual is not chance; as
/// residuals of records follow each other smoothly, t_effective is the one to look at. NaN
/// throughout where m is zero. Source: [Ray1996]; roadside practice accepts |r̄| ≤ 0.05 and
/// s ≤ 0.35 [RayEtAl2011].
ResidualAnalysis residual_analysis(const HistoryPair& pair);

/// How many independent samples tell as much of the mean of x as its n do: n / τ with
///
///   τ = 1 + 2 Σ_{k=1..K} ρ_k,   ρ_k the autocorrelation of x at lag k,
///
/// where K is the first lag of at least 5 τ(K), at most n / 2; τ is not taken below 1. A lag of
/// that order must fit into x: below n ≈ 50 τ the count is a rough one. NaN where x is constant.
/// Source: [Sokal1997].
double effective_samples(std::span<const double> x);

}  // namespace impactrig::fitting
