// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/covariance.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>

namespace impactrig::fitting {
namespace {

constexpr double null_eigenvalue = 1e-12;
constexpr double strong_correlation = 0.995;
// Of an eigenvector of length 1: beyond what slopes that are good to a part in 1e5 leave there.
constexpr double least_share = 1e-3;
constexpr double untouched = 1e-4;

/// "a, b, c" of the parameters that an undetermined way moves.
std::string carriers(const Eigen::VectorXd& direction, const std::vector<std::string>& names,
                     std::vector<bool>& identifiable) {
  std::string text;
  for (Eigen::Index i = 0; i < direction.size(); ++i) {
    if (std::abs(direction[i]) < least_share) continue;
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
      const bool known = result.identifiable[static_cast<std::size_t>(i)] &&
                         result.identifiable[static_cast<std::size_t>(j)];
      const double r = result.correlations(i, j) = result.correlations(j, i) =
          known ? result.covariance(i, j) / spread : std::numeric_limits<double>::quiet_NaN();
      const bool told_of = !held[static_cast<std::size_t>(i)] && !held[static_cast<std::size_t>(j)];
      if (told_of && std::abs(r) > strong_correlation)
        result.sentences.push_back(fmt::format(
            "{} and {} can hardly be told apart (correlation {:.4f}); fix one of them or give it "
            "a prior",
            names[static_cast<std::size_t>(j)], names[static_cast<std::size_t>(i)], r));
    }
}

/// Lengths of the columns to the power of −1; 0, with a sentence, of those without influence.
Eigen::VectorXd scales_of(const Eigen::MatrixXd& jacobian, const std::vector<std::string>& names,
                          Uncertainty& result) {
  Eigen::VectorXd scales = Eigen::VectorXd::Zero(jacobian.cols());
  for (Eigen::Index i = 0; i < jacobian.cols(); ++i) {
    const double norm = jacobian.col(i).norm();
    if (norm > 0.0 && std::isfinite(norm)) {
      scales[i] = 1.0 / norm;
      continue;
    }
    result.identifiable[static_cast<std::size_t>(i)] = false;
    result.sentences.push_back(fmt::format("{} has no influence on what was measured; fix it",
                                           names[static_cast<std::size_t>(i)]));
  }
  return scales;
}

/// (J'J)⁻¹ of what is determined, and a sentence on what is not; no correlations yet.
Uncertainty invert(const Eigen::MatrixXd& jacobian, const std::vector<std::string>& names) {
  const Eigen::Index n = jacobian.cols();
  Uncertainty result{.covariance = Eigen::MatrixXd::Zero(n, n),
                     .correlations = Eigen::MatrixXd::Identity(n, n),
                     .identifiable = std::vector<bool>(static_cast<std::size_t>(n), true),
                     .undetermined = {},
                     .sentences = {}};
  const Eigen::VectorXd scales = scales_of(jacobian, names, result);
  std::vector<Eigen::Index> live, idle;
  for (Eigen::Index i = 0; i < n; ++i) (scales[i] > 0.0 ? live : idle).push_back(i);
  result.undetermined = Eigen::MatrixXd::Identity(n, n)(Eigen::all, idle);
  if (live.empty()) return result;
  const Eigen::MatrixXd scaled = jacobian(Eigen::all, live) * scales(live).asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled.transpose() * scaled);
  for (Eigen::Index k = 0; k < eigen.eigenvalues().size(); ++k) {
    Eigen::VectorXd direction = Eigen::VectorXd::Zero(n);
    direction(live) = eigen.eigenvectors().col(k);
    const Eigen::VectorXd in_own_units = direction.cwiseProduct(scales);
    if (const double value = eigen.eigenvalues()[k]; value > null_eigenvalue) {
      result.covariance += in_own_units * in_own_units.transpose() / value;
      continue;
    }
    result.undetermined.conservativeResize(Eigen::NoChange, result.undetermined.cols() + 1);
    result.undetermined.rightCols<1>() = in_own_units;
    result.sentences.push_back(
        fmt::format("{}: only a combination of these is determined; fix one of them or give it a "
                    "prior",
                    carriers(direction, names, result.identifiable)));
  }
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

bool determines(const Uncertainty& spread, const Eigen::VectorXd& gradient,
                const Eigen::VectorXd& sizes, double value) {
  for (Eigen::Index k = 0; k < spread.undetermined.cols(); ++k) {
    const Eigen::VectorXd way = spread.undetermined.col(k);
    const double largest = way.cwiseQuotient(sizes).cwiseAbs().maxCoeff();
    if (std::abs(gradient.dot(way)) > untouched * std::abs(value) * largest) return false;
  }
  return true;
}

}  // namespace impactrig::fitting
