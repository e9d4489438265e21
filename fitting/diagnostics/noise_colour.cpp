// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/diagnostics/noise_colour.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

namespace impactrig::fitting {
namespace {

constexpr std::size_t highest_order = 8;
constexpr double missing = std::numeric_limits<double>::quiet_NaN();

/// Levinson and Durbin's recursion: φ of every order up to the highest by AICc.
void find_coefficients(std::span<const double> x, NoiseColour& colour) {
  const std::size_t most = std::min(highest_order, colour.samples / 20);
  const std::vector<double> rho = autocorrelations(x, most);
  const double n = static_cast<double>(colour.samples);
  std::vector<double> phi;
  double left = 1.0;  // innovation variance over that of x
  double best = 0.0;  // AICc of independent noise
  double best_left = 1.0;
  for (std::size_t p = 1; p <= most; ++p) {
    double reflection = rho[p - 1];
    for (std::size_t k = 1; k < p; ++k) reflection -= phi[k - 1] * rho[p - k - 1];
    reflection /= left;
    const std::vector<double> old = phi;
    for (std::size_t k = 1; k < p; ++k) phi[k - 1] -= reflection * old[p - k - 1];
    phi.push_back(reflection);
    left *= 1.0 - reflection * reflection;
    if (!(left > 0.0)) break;
    const double order = static_cast<double>(p);
    const double aicc = n * std::log(left) + 2.0 * order * n / std::max(1.0, n - order - 2.0);
    if (aicc >= best) continue;
    best = aicc;
    best_left = left;
    colour.coefficients = phi;
  }
  double sum = 0.0;
  for (const double value : colour.coefficients) sum += value;
  colour.correlation_time = std::max(1.0, best_left / ((1.0 - sum) * (1.0 - sum)));
}

}  // namespace

std::size_t present(std::span<const double> x) {
  return static_cast<std::size_t>(
      std::ranges::count_if(x, [](double value) { return std::isfinite(value); }));
}

double energy(std::span<const double> x) {
  double sum = 0.0;
  for (const double value : x)
    if (std::isfinite(value)) sum += value * value;
  return sum;
}

std::vector<double> without_trend(std::span<const double> x, int degree) {
  std::vector<double> out(x.begin(), x.end());
  const auto count = static_cast<Eigen::Index>(present(x));
  if (count <= degree) return out;
  Eigen::MatrixXd powers(count, degree + 1);
  Eigen::VectorXd values(count);
  const double half = 0.5 * static_cast<double>(x.size());
  const auto place = [&](std::size_t i) { return (static_cast<double>(i) - half) / half; };
  Eigen::Index row = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(x[i])) continue;
    for (int d = 0; d <= degree; ++d) powers(row, d) = std::pow(place(i), d);
    values[row++] = x[i];
  }
  const Eigen::VectorXd trend = powers.colPivHouseholderQr().solve(values);
  for (std::size_t i = 0; i < x.size(); ++i)
    for (int d = 0; d <= degree; ++d) out[i] -= trend[d] * std::pow(place(i), d);
  return out;
}

std::vector<double> autocorrelations(std::span<const double> x, std::size_t lags) {
  std::vector<double> out(lags, 0.0);
  const double whole = energy(x);
  if (!(whole > 0.0)) return out;
  for (std::size_t lag = 1; lag <= lags && lag < x.size(); ++lag) {
    double sum = 0.0;
    for (std::size_t i = lag; i < x.size(); ++i) {
      const double product = x[i] * x[i - lag];
      if (std::isfinite(product)) sum += product;
    }
    out[lag - 1] = sum / whole;
  }
  return out;
}

std::vector<double> whitened(std::span<const double> x, const NoiseColour& colour) {
  const std::size_t order = colour.coefficients.size();
  std::vector<double> out(x.size(), missing);
  for (std::size_t t = order; t < x.size(); ++t) {
    out[t] = x[t];
    for (std::size_t k = 0; k < order; ++k) out[t] -= colour.coefficients[k] * x[t - k - 1];
  }
  return out;
}

NoiseColour noise_colour(std::span<const double> x) {
  constexpr int degree = 2;
  NoiseColour colour;
  colour.samples = present(x);
  if (colour.samples < 20) return colour;
  const std::vector<double> level = without_trend(x, degree);
  const double n = static_cast<double>(colour.samples);
  colour.deviation = std::sqrt(energy(level) / (n - degree - 1.0));
  if (!(colour.deviation > 0.0)) return colour;
  find_coefficients(level, colour);
  const std::vector<double> e = whitened(level, colour);
  const double count = static_cast<double>(present(e));
  const double order = static_cast<double>(colour.coefficients.size());
  const double variance = energy(e) / std::max(1.0, count - degree - 1.0 - order);
  colour.innovation = std::sqrt(variance);
  double fourth = 0.0;
  for (const double value : e)
    if (std::isfinite(value)) fourth += value * value * value * value / count;
  colour.kurtosis = std::max(3.0, fourth / (variance * variance));
  return colour;
}

}  // namespace impactrig::fitting
