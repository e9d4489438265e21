// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/covariance.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <cmath>

namespace impactrig::fitting {
namespace {

constexpr double null_eigenvalue = 1e-12;
constexpr double strong_correlation = 0.995;

/// "a, b and c" of the parameters that carry an eigenvector.
std::string carriers(const Eigen::VectorXd& direction, const std::vector<std::string>& names,
                     std::vector<bool>& identifiable) {
  std::string text;
  for (Eigen::Index i = 0; i < direction.size(); ++i) {
    if (std::abs(direction[i]) < 0.1) continue;
    identifiable[static_cast<std::size_t>(i)] = false;
    text += fmt::format("{}{}", text.empty() ? "" : ", ", names[static_cast<std::size_t>(i)]);
  }
  return text;
}

/// From the covariance; a sentence on every pair that is hardly told apart.
void find_correlations(const std::vector<std::string>& names, const std::vector<bool>& held,
                       Uncertainty& result) {
  const Eigen::Index n = result.covariance.rows();
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < i; ++j) {
      const double spread = std::sqrt(result.covariance(i, i) * result.covariance(j, j));
      if (!(spread > 0.0)) continue;
      const double r = result.correlations(i, j) = result.correlations(j, i) =
          result.covariance(i, j) / spread;
      const bool told_of = !held[static_cast<std::size_t>(i)] && !held[static_cast<std::size_t>(j)];
      if (told_of && std::abs(r) > strong_correlation)
        result.sentences.push_back(fmt::format(
            "{} and {} can hardly be told apart (correlation {:.4f}); fix one of them or give it "
            "a prior",
            names[static_cast<std::size_t>(j)], names[static_cast<std::size_t>(i)], r));
    }
}

/// (J'J)⁻¹ of what is determined, and a sentence on what is not; no correlations yet.
Uncertainty invert(const Eigen::MatrixXd& jacobian, const std::vector<std::string>& names) {
  const Eigen::Index n = jacobian.cols();
  Uncertainty result{.covariance = Eigen::MatrixXd::Zero(n, n),
                     .correlations = Eigen::MatrixXd::Identity(n, n),
                     .identifiable = std::vector<bool>(static_cast<std::size_t>(n), true),
                     .sentences = {}};
  const Eigen::VectorXd norms = jacobian.colwise().norm();
  Eigen::VectorXd inverse_norms = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    if (norms[i] > 0.0 && std::isfinite(norms[i])) {
      inverse_norms[i] = 1.0 / norms[i];
      continue;
    }
    result.identifiable[static_cast<std::size_t>(i)] = false;
    result.sentences.push_back(fmt::format("{} has no influence on what was measured; fix it",
                                           names[static_cast<std::size_t>(i)]));
  }
  const Eigen::MatrixXd scaled = jacobian * inverse_norms.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled.transpose() * scaled);
  Eigen::MatrixXd inverse = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const double value = eigen.eigenvalues()[k];
    const Eigen::VectorXd direction = eigen.eigenvectors().col(k);
    if (value > null_eigenvalue) {
      inverse += direction * direction.transpose() / value;
      continue;
    }
    const bool dead =
        (direction.cwiseProduct(norms)).norm() == 0.0;  // a parameter already named above
    if (!dead)
      result.sentences.push_back(fmt::format(
          "{}: only a combination of these is determined; fix one of them or give it a prior",
          carriers(direction, names, result.identifiable)));
  }
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j)
      if (result.identifiable[static_cast<std::size_t>(i)] &&
          result.identifiable[static_cast<std::size_t>(j)])
        result.covariance(i, j) = inverse(i, j) * inverse_norms[i] * inverse_norms[j];
  return result;
}

}  // namespace

Uncertainty uncertainty(const Eigen::MatrixXd& jacobian, const std::vector<std::string>& names,
                        const std::vector<bool>& held) {
  Uncertainty result = invert(jacobian, names);
  find_correlations(names, held, result);
  return result;
}

Uncertainty uncertainty(const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& residuals,
                        Loss loss, Eigen::Index data, const std::vector<std::string>& names,
                        const std::vector<bool>& held) {
  if (loss == Loss::squares) return uncertainty(jacobian, names, held);
  Eigen::MatrixXd bread = jacobian, filling = jacobian;
  for (Eigen::Index i = 0; i < data; ++i) {
    const LossValue at = evaluate(loss, residuals[i]);
    bread.row(i) *= std::sqrt(std::max(0.0, at.slope));
    filling.row(i) *= at.influence;
  }
  Uncertainty result = invert(bread, names);
  result.covariance = result.covariance * (filling.transpose() * filling) * result.covariance;
  find_correlations(names, held, result);
  return result;
}

}  // namespace impactrig::fitting
