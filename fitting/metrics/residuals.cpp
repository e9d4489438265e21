// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/metrics/residuals.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace impactrig::fitting {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

double ratio(double above, double below) {
  return below > 0.0 ? above / below : nan;
}

/// x less its mean, in parts of `scale`; nothing but zeros where x is constant.
std::vector<double> centred(std::span<const double> x, double scale) {
  std::vector<double> result(x.size(), 0.0);
  const auto [low, high] = std::ranges::minmax(x);
  if (low == high) return result;
  const double n = static_cast<double>(x.size());
  double mean = 0.0;
  for (const double value : x) mean += value / scale / n;
  for (std::size_t i = 0; i < x.size(); ++i) result[i] = x[i] / scale - mean;
  return result;
}

double dot(std::span<const double> a, std::span<const double> b) {
  using Vector = Eigen::Map<const Eigen::VectorXd>;
  const auto size = static_cast<Eigen::Index>(a.size());
  return Vector(a.data(), size).dot(Vector(b.data(), size));
}

std::vector<double> means_of_two(std::span<const double> x) {
  std::vector<double> result(x.size() / 2);
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = 0.5 * (x[2 * i] + x[2 * i + 1]);
  return result;
}

/// Σ_i x_i x_{i+lag} / Σ x².
double autocorrelation(std::span<const double> x, std::size_t lag) {
  return dot(x.first(x.size() - lag), x.subspan(lag)) / dot(x, x);
}

}  // namespace

double correlation(const HistoryPair& pair) {
  require_comparable(pair);
  const auto m = centred(pair.measured, std::max(peak_of(pair.measured), 1e-300));
  const auto c = centred(pair.computed, std::max(peak_of(pair.computed), 1e-300));
  const double size = std::sqrt(dot(m, m)) * std::sqrt(dot(c, c));
  return size > 0.0 ? std::clamp(dot(m, c) / size, -1.0, 1.0) : nan;
}

double r_squared(const HistoryPair& pair) {
  require_comparable(pair);
  const double peak = peak_of(pair.measured);
  if (peak == 0.0) return nan;
  const auto m = centred(pair.measured, peak);
  const double error = norm_of_difference(pair) / peak;
  return 1.0 - ratio(error * error, dot(m, m));
}

RootMeanSquareError root_mean_square_error(const HistoryPair& pair) {
  require_comparable(pair);
  const double root = std::sqrt(static_cast<double>(pair.measured.size()));
  const auto [low, high] = std::ranges::minmax(pair.measured);
  RootMeanSquareError result;
  result.rmse = norm_of_difference(pair) / root;
  result.of_peak = ratio(result.rmse, peak_of(pair.measured));
  result.of_range = ratio(result.rmse, high - low);
  result.of_rms = ratio(result.rmse, norm_of(pair.measured) / root);
  return result;
}

ResidualAnalysis residual_analysis(const HistoryPair& pair) {
  require_comparable(pair);
  ResidualAnalysis result{nan, nan, nan, nan, nan, nan};
  const double peak = peak_of(pair.measured);
  if (peak == 0.0) return result;
  const std::size_t count = pair.measured.size();
  const double n = static_cast<double>(count);
  std::vector<double> r(count);
  for (std::size_t i = 0; i < count; ++i) r[i] = (pair.measured[i] - pair.computed[i]) / peak;
  result.mean = std::accumulate(r.begin(), r.end(), 0.0) / n;
  if (count < 2) return result;
  const auto deviations = centred(r, 1.0);
  result.deviation = std::sqrt(dot(deviations, deviations) / (n - 1.0));
  if (!(result.deviation > 0.0)) return result;
  result.t = result.mean * std::sqrt(n) / result.deviation;
  result.lag1 = autocorrelation(deviations, 1);
  result.effective_samples = effective_samples(r);
  result.t_effective = result.mean * std::sqrt(result.effective_samples) / result.deviation;
  return result;
}

double effective_samples(std::span<const double> x) {
  if (x.empty()) return nan;
  const auto deviations = centred(x, std::max(peak_of(x), 1e-300));
  if (!(dot(deviations, deviations) > 0.0)) return nan;
  constexpr double window = 5.0;  // [Sokal1997]: 4 to 10 times the correlation time
  constexpr double most_products = 1e8;
  double tau = 1.0;
  for (std::size_t lag = 1; lag <= x.size() / 2; ++lag) {
    tau += 2.0 * autocorrelation(deviations, lag);
    if (static_cast<double>(lag) >= window * tau) break;
    // τ is above a fifth of the lag here: means of two neighbours tell it as well
    if (static_cast<double>(lag) * static_cast<double>(x.size()) > most_products)
      return effective_samples(means_of_two(deviations));
  }
  return static_cast<double>(x.size()) / std::max(1.0, tau);
}

}  // namespace impactrig::fitting
