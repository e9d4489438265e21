// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/diagnostics/residual_tests.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <numbers>
#include <random>

namespace impactrig::fitting {
namespace {

constexpr std::size_t most_lags = 20;
constexpr std::size_t quantile_count = 61;

double survival_f(double ratio, double above, double below) {
  if (!(ratio > 0.0)) return 1.0;
  const boost::math::fisher_f distribution(std::max(1.0, above), std::max(1.0, below));
  return boost::math::cdf(boost::math::complement(distribution, ratio));
}

/// Natural logarithm of the standard normal distribution function.
double log_normal_cdf(double z) {
  if (z > -30.0) return std::log(0.5 * std::erfc(-z / std::numbers::sqrt2));
  return -0.5 * z * z - std::log(-z * std::sqrt(2.0 * std::numbers::pi));
}

/// Of A² with mean and variance estimated, corrected for the sample's size.
double anderson_darling_p(double a) {
  if (a >= 13.0) return 0.0;
  if (a >= 0.6) return std::exp(1.2937 - 5.709 * a + 0.0186 * a * a);
  if (a >= 0.34) return std::exp(0.9177 - 4.279 * a - 1.38 * a * a);
  if (a >= 0.2) return 1.0 - std::exp(-8.318 + 42.796 * a - 59.938 * a * a);
  return 1.0 - std::exp(-13.436 + 101.14 * a - 223.73 * a * a);
}

std::string shape_words(const Normality& found, double n) {
  if (found.p_value >= 0.01) return "normal";
  const bool skewed = std::abs(found.skewness) > 2.6 * std::sqrt(6.0 / n);
  const bool tailed = std::abs(found.excess_kurtosis) > 2.6 * std::sqrt(24.0 / n);
  // a gamma distribution, one-sided as can be, has 1.5 skewness² of excess kurtosis
  const double by_skewness = 1.5 * found.skewness * found.skewness;
  if (skewed && (!tailed || by_skewness > 0.5 * std::abs(found.excess_kurtosis)))
    return found.skewness > 0.0 ? "skewed upwards" : "skewed downwards";
  if (!tailed) return "not normal";
  return found.excess_kurtosis > 0.0 ? "heavy-tailed" : "light-tailed";
}

struct Moments {
  double mean = 0.0, deviation = 0.0;
};

Moments moments(const std::vector<double>& x) {
  const double n = static_cast<double>(x.size());
  Moments out;
  for (const double value : x) out.mean += value / n;
  double squares = 0.0;
  for (const double value : x) squares += (value - out.mean) * (value - out.mean);
  out.deviation = std::sqrt(squares / (n - 1.0));
  return out;
}

/// In place of each value one that a normal distribution may have had within half a step of it:
/// normal again where x was normal before it was rounded.
void undo_steps(std::vector<double>& x, double quantum) {
  const auto [mean, deviation] = moments(x);
  const double variance = deviation * deviation - quantum * quantum / 12.0;
  if (!(quantum > 0.0 && variance > 0.0)) return;
  const boost::math::normal distribution(mean, std::sqrt(variance));
  std::mt19937_64 generator(1);  // the same residuals always give the same answer
  std::uniform_real_distribution<double> uniform;
  for (double& value : x) {
    const double low = boost::math::cdf(distribution, value - 0.5 * quantum);
    const double high = boost::math::cdf(distribution, value + 0.5 * quantum);
    const double place = low + uniform(generator) * (high - low);
    if (place > 0.0 && place < 1.0 && high > low)
      value = boost::math::quantile(distribution, place);
  }
}

std::vector<double> some_quantiles(const std::vector<double>& sorted) {
  const std::size_t shown = std::min(quantile_count, sorted.size());
  std::vector<double> out;
  for (std::size_t i = 0; i < shown; ++i) {
    const double place = (static_cast<double>(i) + 0.5) / static_cast<double>(shown) *
                             static_cast<double>(sorted.size()) -
                         0.5;
    const auto low = static_cast<std::size_t>(std::max(0.0, place));
    const double part = place - static_cast<double>(low);
    out.push_back((1.0 - part) * sorted[low] + part * sorted[std::min(low + 1, sorted.size() - 1)]);
  }
  return out;
}

}  // namespace

double level_p_value(double sum, std::size_t samples, const NoiseColour& noise) {
  if (samples == 0 || !(noise.innovation > 0.0)) return 1.0;
  const double n = static_cast<double>(samples), before = static_cast<double>(noise.samples);
  const double each = 2.0 / (noise.kurtosis - 1.0);
  const double lost = 3.0 + static_cast<double>(noise.coefficients.size());
  return survival_f(sum / (n * noise.innovation * noise.innovation), each * n,
                    each * (before - lost));
}

double trend_p_value(std::span<const double> whitened_before, const NoiseColour& noise) {
  if (!(noise.innovation > 0.0)) return 1.0;
  const double explained = energy(whitened_before) - energy(without_trend(whitened_before, 2));
  // what the noise does slowly is known from as many samples as are independent
  const double known = static_cast<double>(noise.samples) / (2.0 * noise.correlation_time);
  return survival_f(explained / (3.0 * noise.innovation * noise.innovation), 3.0, known);
}

Whiteness whiteness(std::span<const double> before, std::span<const double> after) {
  Whiteness out;
  const std::size_t n = present(after), n0 = present(before);
  const std::size_t lags = std::min({most_lags, n / 5, n0 / 5});
  if (lags == 0) return out;
  out.autocorrelation = autocorrelations(after, lags);
  out.before = autocorrelations(without_trend(before, 2), lags);
  out.lag1 = out.autocorrelation.front();
  double q = 0.0;
  for (std::size_t k = 1; k <= lags; ++k) {
    const double difference = out.autocorrelation[k - 1] - out.before[k - 1];
    q += difference * difference /
         (1.0 / static_cast<double>(n - k) + 1.0 / static_cast<double>(n0 - k));
  }
  const boost::math::chi_squared distribution(static_cast<double>(lags));
  out.p_value = boost::math::cdf(boost::math::complement(distribution, q));
  out.band = 1.96 * std::sqrt(1.0 / static_cast<double>(n) + 1.0 / static_cast<double>(n0));
  return out;
}

Normality normality(std::span<const double> x, double quantum) {
  Normality out;
  std::vector<double> sorted;
  for (const double value : x)
    if (std::isfinite(value)) sorted.push_back(value);
  if (sorted.size() < 8) return out;
  undo_steps(sorted, quantum);
  const auto [mean, deviation] = moments(sorted);
  if (!(deviation > 0.0)) return out;
  std::ranges::sort(sorted);
  const double n = static_cast<double>(sorted.size());
  double third = 0.0, fourth = 0.0, sum = 0.0;
  for (double& value : sorted) {
    value = (value - mean) / deviation;
    third += value * value * value / n;
    fourth += value * value * value * value / n;
  }
  for (std::size_t i = 0; i < sorted.size(); ++i)
    sum += (2.0 * static_cast<double>(i) + 1.0) / n *
           (log_normal_cdf(sorted[i]) + log_normal_cdf(-sorted[sorted.size() - 1 - i]));
  out.statistic = -n - sum;
  out.p_value = anderson_darling_p(out.statistic * (1.0 + 0.75 / n + 2.25 / (n * n)));
  out.skewness = third;
  out.excess_kurtosis = fourth - 3.0;
  out.words = shape_words(out, n);
  out.quantiles = some_quantiles(sorted);
  return out;
}

SignRun longest_run(std::span<const double> x, double start, double interval) {
  SignRun out;
  long length = 0;
  double sign = 0.0;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(x[i])) continue;
    const double now = x[i] < 0.0 ? -1.0 : 1.0;
    if (now != sign) {
      sign = now;
      begin = i;
      length = 0;
    }
    if (++length <= out.samples) continue;
    out.samples = length;
    out.from = start + interval * static_cast<double>(begin);
    out.to = start + interval * static_cast<double>(i);
  }
  const double n = static_cast<double>(present(x)), l = static_cast<double>(out.samples);
  if (n > 0.0) out.p_value = -std::expm1(-(n - l + 2.0) * std::exp2(-l));
  return out;
}

}  // namespace impactrig::fitting
