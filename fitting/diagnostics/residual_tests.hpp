// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "fitting/diagnostics/channel_diagnostics.hpp"
#include "fitting/diagnostics/noise_colour.hpp"

namespace impactrig::fitting {

/// Chance that noise alone has a sum of squares as large as `sum` over `samples` whitened samples:
/// sum / (samples σ_e²) against Snedecor's F with as many degrees of freedom as the mean square of
/// each side has, 2 n / (κ − 1) for samples of kurtosis κ.
double level_p_value(double sum, std::size_t samples, const NoiseColour& noise);

/// Chance that a parabola explains so much of whitened samples before touch, where a right model
/// leaves none: F of 3 and the noise's degrees of freedom.
double trend_p_value(std::span<const double> whitened_before, const NoiseColour& noise);

/// Autocorrelations ρ_k of whitened residuals after touch against ρ⁰_k before it, at lags up to 20:
///
///   Q = Σ_k (ρ_k − ρ⁰_k)² / (1/(n − k) + 1/(n₀ − k)),
///
/// chi-squared with that many degrees of freedom where the colour is the same; for known colour
/// (n₀ → ∞) it is Ljung and Box's. The difference takes out what the colour is not known of.
/// Source: [LjungBox1978].
Whiteness whiteness(std::span<const double> before, std::span<const double> after);

/// Anderson and Darling's test with mean and variance estimated, its p-value by Stephens' fit.
/// `quantum` [unit of x]: the digitiser's step; each value is first replaced by one that a normal
/// distribution may have had within half a step of it, so that steps are not taken for a shape. The
/// words name skewness or tails, whichever the moments speak for. Source: [Stephens1986].
Normality normality(std::span<const double> x, double quantum);

/// The longest run of one sign among n samples at start + k interval. Among fair coins one of L or
/// more comes with probability 1 − exp(−(n − L + 2) / 2^L), within 0.01 for n > 50.
SignRun longest_run(std::span<const double> x, double start, double interval);

}  // namespace impactrig::fitting
