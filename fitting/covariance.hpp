// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "fitting/loss.hpp"

namespace impactrig::fitting {

/// What a Jacobian tells about the parameters at the optimum.
struct Uncertainty {
  /// (n, n): of the combinations that are determined, the Moore-Penrose inverse in parameters
  /// scaled to unit columns. Of a parameter that is not identifiable it holds the share that is
  /// determined, which is no variance of the parameter.
  Eigen::MatrixXd covariance;
  /// (n, n); 1 on the diagonal, NaN beside parameters that are not identifiable.
  Eigen::MatrixXd correlations;
  std::vector<bool> identifiable;  ///< (n)
  /// (n, n_undetermined), one column for each way along which the data do not change.
  Eigen::MatrixXd undetermined;
  /// One for each combination the data cannot tell apart, or hardly.
  std::vector<std::string> sentences;
};

/// (J'J)⁻¹ of weighted residuals (n_residuals, n_parameters), by the eigenvectors of J'J scaled to
/// a unit diagonal. A parameter is estimable, and has a variance, where its axis stands upright on
/// all undetermined ways: one without influence, or that moves by more than 1e-3 along an
/// eigenvector whose eigenvalue is below 1e-12, is not identifiable. Strong correlations (above
/// 0.995) are told in a sentence, but not where `held` marks one of the two: a parameter with a
/// prior, or first touch, which goes with the channels' delays as a matter of course.
Uncertainty uncertainty(const Eigen::MatrixXd& jacobian, const std::vector<std::string>& names,
                        const std::vector<bool>& held);

/// The same where residuals were judged by a loss ρ instead of their squares: the sandwich
///
///   H⁻¹ (Σ ψ_i² J_i' J_i) H⁻¹,   H = Σ max(ψ'_i, 0) J_i' J_i,   ψ = ρ'/2
///
/// over the first `data` rows; rows behind them are priors, squared as ever with ψ² = 1. Scatter
/// beyond the noise that was stated is in it, as far as the loss lets it in. Of squares it is
/// (J'J)⁻¹, for which the noise must be right. Source: [HuberRonchetti2009].
Uncertainty uncertainty(const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& residuals,
                        Loss loss, Eigen::Index data, const std::vector<std::string>& names,
                        const std::vector<bool>& held);

/// Whether a number of this gradient (n) is determined: it changes by less than 1e-4 of `value`
/// when parameters move along an undetermined way until one of them has moved by its own size (n).
bool determines(const Uncertainty& spread, const Eigen::VectorXd& gradient,
                const Eigen::VectorXd& sizes, double value);

}  // namespace impactrig::fitting
