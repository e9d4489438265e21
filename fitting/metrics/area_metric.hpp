// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

namespace impactrig::fitting {

/// Area metric of a scalar in repeated tests: d = ∫ |F(x) − S(x)| dx with the distribution function
/// F of the model and the step function S of the measured values, in the unit of x. 0 only where
/// the distributions are equal; a shift alone costs its size, and with as many values on both sides
/// d is the mean of |x_(i) − y_(i)| of the sorted ones. It says how far apart they are, not whether
/// so few tests could tell. Throws std::invalid_argument without values.
/// Source: [FersonEtAl2008].
double area_metric(std::span<const double> model, std::span<const double> measured);

/// The same for a model whose values are normally distributed; closed form between the steps.
/// Throws std::invalid_argument without values or for a standard deviation that is not positive.
double area_metric(double model_mean, double model_deviation, std::span<const double> measured);

/// Area metric of tests under different conditions: each measured value y_i is told by
/// u_i = F_i(y_i), its place in what the model predicts for its own condition; d is the area
/// between the step function of the u_i [0, 1] and the uniform law [-], in [0, ½]. Throws
/// std::invalid_argument without values or for one outside [0, 1]. Source: [FersonEtAl2008].
double u_pooled_area(std::span<const double> u);

/// Reliability metric r = P(|D| < ε) of a difference D between model and test that is normally
/// distributed,
///
///   r = Φ((ε − μ) / σ) − Φ((−ε − μ) / σ)   [-], in [0, 1]
///
/// with mean μ, standard deviation σ > 0 and the tolerance ε > 0, all in one unit. Throws
/// std::invalid_argument otherwise. Source: [RebbaMahadevan2008].
double reliability(double mean_difference, double deviation, double tolerance);

}  // namespace impactrig::fitting
