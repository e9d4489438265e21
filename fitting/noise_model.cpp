// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/noise_model.hpp"

#include <algorithm>
#include <cmath>

namespace impactrig::fitting {
namespace {

constexpr std::size_t fewest_samples = 100;
constexpr std::size_t samples_an_order = 20;
constexpr std::size_t highest_order = 24;

/// Burg's recursion: the reflection coefficients that make forward and backward prediction errors
/// least, order by order.
std::vector<double> reflections(std::span<const double> x, std::size_t orders) {
  std::vector<double> forward(x.begin(), x.end()), backward(x.begin(), x.end());
  std::vector<double> result;
  for (std::size_t m = 1; m <= orders; ++m) {
    double product = 0.0, squares = 0.0;
    for (std::size_t k = m; k < x.size(); ++k) {
      product += forward[k] * backward[k - 1];
      squares += forward[k] * forward[k] + backward[k - 1] * backward[k - 1];
    }
    if (!(squares > 0.0)) break;
    const double reflection = 2.0 * product / squares;
    if (!(std::abs(reflection) < 1.0)) break;
    result.push_back(reflection);
    for (std::size_t k = x.size() - 1; k >= m; --k) {
      const double f = forward[k], b = backward[k - 1];
      forward[k] = f - reflection * b;
      backward[k] = b - reflection * f;
    }
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

NoiseModel NoiseModel::estimate(std::span<const double> quiet, double sigma) {
  NoiseModel model(sigma, 1.0);
  if (quiet.size() < fewest_samples) return model;
  std::vector<double> found =
      reflections(quiet, std::min(highest_order, quiet.size() / samples_an_order));
  found.resize(best_order(found, quiet.size()));
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
