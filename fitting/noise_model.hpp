// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <limits>
#include <span>
#include <vector>

namespace impactrig::fitting {

/// Of the largest value, what a standard deviation may come to by the rounding of single precision,
/// and be no noise: a digitiser of 24 bits has more. What samples before do not foretell of one may
/// be as little as the second where noise is filtered, or a course is smooth.
inline constexpr double rounding_part = 1e-6, rounding_unforetold = 1e-7;

/// Stationary noise of a sampled channel, as an autoregression:
///
///   x_k = a_1 x_{k−1} + … + a_p x_{k−p} + ε_k,   ε independent, normal
///
/// Whitening takes from each sample what the samples before it foretell. The first p samples of a
/// stretch are foretold from as many as there are, with the predictors of lower order that
/// Levinson's recursion passes through; so a whitened stretch has exactly the likelihood of the
/// noise (it is the Cholesky factor of the inverse covariance, applied).
class NoiseModel {
 public:
  NoiseModel() = default;

  /// White, or taken for white: independent samples of the standard deviation `sigma`, of which
  /// `correlation` (>= 1) together count as one.
  NoiseModel(double sigma, double correlation);

  /// Of noise seen on top of unknown trends (n_samples, n_trends): reflection coefficients by
  /// Burg's recursion, the order by the Bayesian information criterion among 0 to a twentieth of
  /// the samples, at most 24. What the trends took from the noise with them is given back, so that
  /// slow noise is not underrated: the restricted likelihood, by expectation and maximisation. At
  /// least 20 samples more than trends. Of a record that shows nothing beside its trends: of size
  /// 0. Source: [Burg1975], [Schwarz1978], [PattersonThompson1971], [DempsterEtAl1977].
  static NoiseModel estimate(const Eigen::VectorXd& quiet, const Eigen::MatrixXd& trends);

  /// The same, known from this many independent samples.
  NoiseModel known_from(double samples) const;

  /// The same with the standard deviation of a sample, at least this.
  NoiseModel at_least(double sigma) const;

  /// White noise of the same standard deviation where this one's samples hang together; else this
  /// one.
  NoiseModel as_if_white() const;

  /// From how many independent samples, less the trends, its level is known, slow noise included;
  /// infinite where it was stated.
  double freedom() const { return freedom_; }

  double sigma() const { return sigma_; }  ///< of a sample [SI]

  /// Of what the samples before do not foretell of one [SI].
  double unforetold() const { return deviations_.empty() ? sigma_ : deviations_.back(); }

  int order() const { return static_cast<int>(predictors_.size()); }

  /// Of whitened samples that count as independent: 1, unless the noise was taken for white though
  /// it is not.
  double independent_share() const { return predictors_.empty() ? 1.0 / correlation_ : 1.0; }

  /// How many samples of a long record tell as much of a constant as one would of white noise of
  /// the same sigma: spectral density at zero frequency over variance.
  double correlation_time() const;

  /// Makes consecutive residuals or derivatives of residuals, in their unit, independent and of
  /// unit standard deviation, in place.
  void whiten(std::span<double> stretch) const;

  /// What whiten() makes into `white`: from independent standard normal values to noise.
  void colour(std::span<double> white) const;

 private:
  static NoiseModel of_series(const Eigen::MatrixXd& series);

  double sigma_ = 1.0;
  double correlation_ = 1.0;
  double freedom_ = std::numeric_limits<double>::infinity();
  std::vector<std::vector<double>> predictors_;  // of order 1, 2, … p
  std::vector<double> deviations_;  // of the prediction error of order 0, 1, … p [SI]
};

}  // namespace impactrig::fitting
