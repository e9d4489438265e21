// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/random_effects.hpp"

#include <Eigen/Dense>
#include <stdexcept>

namespace impactrig::fitting {
namespace {

struct WeightedFit {
  Eigen::VectorXd coefficients;
  Eigen::MatrixXd covariance;
  double q = 0.0;      ///< Σ w r²
  double slope = 0.0;  ///< dQ/dτ² = −Σ w² r², since β minimises Q
};

WeightedFit weighted_fit(const Eigen::MatrixXd& design, const Eigen::VectorXd& values,
                         const Eigen::VectorXd& variances, double between) {
  const Eigen::VectorXd weights = (variances.array() + between).inverse();
  const Eigen::MatrixXd weighted = weights.asDiagonal() * design;
  WeightedFit fit;
  fit.covariance = (design.transpose() * weighted).inverse();
  fit.coefficients = fit.covariance * (weighted.transpose() * values);
  const Eigen::ArrayXd squares = (values - design * fit.coefficients).array().square();
  fit.q = (weights.array() * squares).sum();
  fit.slope = -(weights.array().square() * squares).sum();
  return fit;
}

void check(const Eigen::MatrixXd& design, const Eigen::VectorXd& values,
           const Eigen::VectorXd& variances) {
  if (values.size() <= design.cols() || values.size() != design.rows() ||
      values.size() != variances.size())
    throw std::invalid_argument("random effects: more values than coefficients are needed");
  if (!values.allFinite() || !variances.allFinite() || !design.allFinite() ||
      !(variances.minCoeff() > 0.0))
    throw std::invalid_argument("random effects: values must be finite, variances above 0");
}

}  // namespace

double variance_where_q_is(double target, const Eigen::MatrixXd& design,
                           const Eigen::VectorXd& values, const Eigen::VectorXd& variances) {
  check(design, values, variances);
  double between = 0.0;
  // far below the root a step doubles v + τ²; 2000 doublings pass the range of a double
  for (int i = 0; i < 2000; ++i) {
    const WeightedFit fit = weighted_fit(design, values, variances, between);
    if (!(fit.q > target)) break;
    const double step = (fit.q - target) / -fit.slope;
    between += step;
    if (step <= 1e-13 * between) break;
  }
  return between;
}

RandomEffects random_effects(const Eigen::MatrixXd& design, const Eigen::VectorXd& values,
                             const Eigen::VectorXd& variances) {
  check(design, values, variances);
  RandomEffects out;
  out.dof = values.size() - design.cols();
  out.q = weighted_fit(design, values, variances, 0.0).q;
  out.variance = variance_where_q_is(static_cast<double>(out.dof), design, values, variances);
  const WeightedFit fit = weighted_fit(design, values, variances, out.variance);
  out.coefficients = fit.coefficients;
  out.covariance = fit.covariance;
  return out;
}

}  // namespace impactrig::fitting
