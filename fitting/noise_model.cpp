// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/noise_model.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace impactrig::fitting {
namespace {

constexpr Eigen::Index samples_an_order = 20, highest_order = 24;
constexpr double settled = 1e-4;  // of the standard deviation of a long record's mean
constexpr int most_rounds = 20;
constexpr double rounding = 1e-12;  // of the largest value; less is no noise

/// Burg's recursion: the reflection coefficients that make forward and backward prediction errors
/// least, order by order, over all columns together.
std::vector<double> reflections(const Eigen::MatrixXd& series, Eigen::Index orders) {
  const Eigen::Index n = series.rows();
  Eigen::MatrixXd forward = series, backward = series;
  std::vector<double> result;
  for (Eigen::Index m = 1; m <= orders; ++m) {
    auto ahead = forward.bottomRows(n - m);
    auto behind = backward.middleRows(m - 1, n - m);
    const double squares = ahead.squaredNorm() + behind.squaredNorm();
    if (!(squares > 0.0)) break;
    const double reflection = 2.0 * ahead.cwiseProduct(behind).sum() / squares;
    if (!(std::abs(reflection) < 1.0)) break;
    result.push_back(reflection);
    const Eigen::MatrixXd f = ahead - reflection * behind, b = behind - reflection * ahead;
    ahead = f;
    backward.bottomRows(n - m) = b;
  }
  return result;
}

/// n ln σ²_m + m ln n is least.
std::size_t best_order(const std::vector<double>& reflections, std::size_t samples) {
  const double n = static_cast<double>(samples);
  double gained = 0.0, least = 0.0;
  std::size_t best = 0;
  for (std::size_t m = 1; m <= reflections.size(); ++m) {
    gained += n * std::log1p(-reflections[m - 1] * reflections[m - 1]);
    const double criterion = gained + static_cast<double>(m) * std::log(n);
    if (criterion >= least) continue;
    least = criterion;
    best = m;
  }
  return best;
}

}  // namespace

NoiseModel::NoiseModel(double sigma, double correlation)
    : sigma_(sigma),
      correlation_(correlation),
      deviations_{sigma * std::sqrt(correlation)} {}

NoiseModel NoiseModel::of_series(const Eigen::MatrixXd& series) {
  const auto samples = static_cast<double>(series.rows());
  NoiseModel model(std::sqrt(series.squaredNorm() / samples), 1.0);
  if (!(model.sigma_ > 0.0)) return model;
  std::vector<double> found =
      reflections(series, std::min(highest_order, series.rows() / samples_an_order));
  found.resize(best_order(found, static_cast<std::size_t>(series.rows())));
  std::vector<double> predictor;
  for (const double reflection : found) {
    std::vector<double> next = predictor;
    for (std::size_t i = 0; i < predictor.size(); ++i)
      next[i] -= reflection * predictor[predictor.size() - 1 - i];
    next.push_back(reflection);
    predictor = next;
    model.predictors_.push_back(predictor);
    model.deviations_.push_back(model.deviations_.back() *
                                std::sqrt(1.0 - reflection * reflection));
  }
  return model;
}

NoiseModel NoiseModel::estimate(const Eigen::VectorXd& quiet, const Eigen::MatrixXd& trends) {
  const Eigen::Index n = trends.rows(), p = trends.cols();
  const auto whitened = [n](const NoiseModel& noise, Eigen::MatrixXd columns) {
    for (Eigen::Index k = 0; k < columns.cols(); ++k)
      noise.whiten({columns.col(k).data(), static_cast<std::size_t>(n)});
    return columns;
  };
  const double largest = quiet.lpNorm<Eigen::Infinity>();
  NoiseModel model = p > 0 ? NoiseModel(1.0, 1.0) : of_series(quiet);
  double before = 0.0;
  for (int round = 0; p > 0 && round < most_rounds; ++round) {
    // what the trends hide of the noise has the covariance of the trends themselves, X R⁻¹ (X R⁻¹)ᵀ
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(whitened(model, trends));
    const Eigen::MatrixXd r = qr.matrixQR().topRows(p).triangularView<Eigen::Upper>();
    const Eigen::VectorXd level = qr.solve(whitened(model, quiet)).col(0);
    Eigen::MatrixXd series(n, round == 0 ? 1 : 1 + p);
    series.col(0) = quiet - trends * level;
    if (!(series.col(0).norm() > rounding * std::sqrt(static_cast<double>(n)) * largest)) {
      model = NoiseModel(0.0, 1.0);
      break;
    }
    if (round > 0)
      series.rightCols(p) =
          r.transpose().triangularView<Eigen::Lower>().solve(trends.transpose()).transpose();
    model = of_series(series);
    const double slow = model.sigma_ * std::sqrt(model.correlation_time());
    if (round > 1 && std::abs(slow - before) <= settled * slow) break;
    before = slow;
  }
  // how well its level is known at low frequency, as by so many independent samples: of first order
  // var ln S(0) = 2/n + 4 c/n
  const double known = model.order() > 0 ? 1.0 + 2.0 * model.correlation_time() : 1.0;
  model.freedom_ = std::max(1.0, static_cast<double>(n) / known - static_cast<double>(p));
  return model;
}

NoiseModel NoiseModel::known_from(double samples) const {
  NoiseModel model = *this;
  model.freedom_ = std::max(1.0, samples);
  return model;
}

NoiseModel NoiseModel::at_least(double sigma) const {
  NoiseModel model = *this;
  if (!(sigma > sigma_)) return model;
  if (sigma_ == 0.0) return NoiseModel(sigma, correlation_).known_from(freedom_);
  for (double& deviation : model.deviations_) deviation *= sigma / sigma_;
  model.sigma_ = sigma;
  return model;
}

NoiseModel NoiseModel::as_if_white() const {
  return predictors_.empty() ? *this : NoiseModel(sigma_, 1.0).known_from(freedom_);
}

double NoiseModel::correlation_time() const {
  if (predictors_.empty()) return correlation_;
  double gain = 1.0;
  for (const double a : predictors_.back()) gain -= a;
  const double at_zero = deviations_.back() / gain;
  return at_zero * at_zero / (sigma_ * sigma_);
}

void NoiseModel::whiten(std::span<double> stretch) const {
  for (std::size_t k = stretch.size(); k-- > 0;) {
    const std::size_t order = std::min(k, predictors_.size());
    double foretold = 0.0;
    if (order > 0) {
      const std::vector<double>& a = predictors_[order - 1];
      for (std::size_t i = 0; i < order; ++i) foretold += a[i] * stretch[k - 1 - i];
    }
    stretch[k] = (stretch[k] - foretold) / deviations_[order];
  }
}

void NoiseModel::colour(std::span<double> white) const {
  for (std::size_t k = 0; k < white.size(); ++k) {
    const std::size_t order = std::min(k, predictors_.size());
    double foretold = 0.0;
    if (order > 0) {
      const std::vector<double>& a = predictors_[order - 1];
      for (std::size_t i = 0; i < order; ++i) foretold += a[i] * white[k - 1 - i];
    }
    white[k] = foretold + deviations_[order] * white[k];
  }
}

}  // namespace impactrig::fitting
