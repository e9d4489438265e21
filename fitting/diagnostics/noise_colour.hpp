// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace impactrig::fitting {

/// Noise as an autoregressive process, learnt from a quiet stretch:
///
///   x_t = Σ_{k=1..p} φ_k x_{t−k} + e_t,   e independent with standard deviation σ_e.
///
/// Throughout, a sample that is not a number is missing.
struct NoiseColour {
  std::vector<double> coefficients;  ///< φ_1 … φ_p [-]
  double deviation = 0.0;            ///< of x [unit of x]
  double innovation = 0.0;           ///< σ_e [unit of x]
  /// Integrated autocorrelation time σ_e² / (σ² (1 − Σφ)²) [samples], not below 1.
  double correlation_time = 1.0;
  double kurtosis = 3.0;  ///< of e, not below the normal distribution's 3
  std::size_t samples = 0;
};

/// The colour of x, once its best parabola is removed: drift and mains hum, which a fit follows,
/// are no noise. φ by Yule and Walker's equations, which keep the process stable; p <= 8 by the
/// least AICc. Valid for stationary noise whose correlation time is below about n / 50.
/// Source: [BrockwellDavis1991], sections 8.1 and 9.3.
NoiseColour noise_colour(std::span<const double> x);

/// e_t = x_t − Σφ_k x_{t−k} (n); missing where one of the samples is.
std::vector<double> whitened(std::span<const double> x, const NoiseColour& colour);

/// x less its least-squares polynomial of a degree; also of use on whitened samples, since
/// whitening a polynomial leaves one.
std::vector<double> without_trend(std::span<const double> x, int degree);

/// Σ_t x_t x_{t+k} / Σ x_t² at lags k = 1 … lags, of samples whose mean is known to be zero (lags).
std::vector<double> autocorrelations(std::span<const double> x, std::size_t lags);

/// How many samples are not missing.
std::size_t present(std::span<const double> x);

/// Σx² of what is not missing.
double energy(std::span<const double> x);

}  // namespace impactrig::fitting
