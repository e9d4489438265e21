// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/metrics/area_metric.hpp"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

namespace impactrig::fitting {
namespace {

std::vector<double> sorted(std::span<const double> values) {
  if (values.empty()) throw std::invalid_argument("an area metric needs at least one value");
  std::vector<double> result(values.begin(), values.end());
  if (!std::ranges::all_of(result, [](double x) { return std::isfinite(x); }))
    throw std::invalid_argument("values of an area metric must be finite");
  std::ranges::sort(result);
  return result;
}

double below(double z) {  // Φ(z)
  return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

/// ∫ Φ from −∞ to z.
double integral_below(double z) {
  return z * below(z) + std::exp(-0.5 * z * z) * std::numbers::inv_sqrtpi / std::numbers::sqrt2;
}

/// ∫ (F − level) over an interval, in size, of an F that grows: split where F crosses the level.
template <typename Integral>
double area_between(double from, double to, double level, double crossing, Integral integral) {
  const double middle = std::clamp(crossing, from, to);
  const auto signed_area = [&](double a, double b) {
    return integral(b) - integral(a) - level * (b - a);
  };
  return std::abs(signed_area(from, middle)) + std::abs(signed_area(middle, to));
}

}  // namespace

double area_metric(std::span<const double> model, std::span<const double> measured) {
  const std::vector<double> x = sorted(model), y = sorted(measured);
  const double n = static_cast<double>(x.size()), k = static_cast<double>(y.size());
  std::size_t i = 0, j = 0;
  double area = 0.0, at = std::min(x.front(), y.front());
  while (i < x.size() || j < y.size()) {
    const bool from_model = j == y.size() || (i < x.size() && x[i] <= y[j]);
    const double next = from_model ? x[i] : y[j];
    area += std::abs(static_cast<double>(i) / n - static_cast<double>(j) / k) * (next - at);
    at = next;
    ++(from_model ? i : j);
  }
  return area;
}

double area_metric(double model_mean, double model_deviation, std::span<const double> measured) {
  if (!(model_deviation > 0.0) || !std::isfinite(model_deviation) || !std::isfinite(model_mean))
    throw std::invalid_argument("the model's standard deviation must be greater than zero");
  std::vector<double> z = sorted(measured);
  for (double& value : z) value = (value - model_mean) / model_deviation;
  const double n = static_cast<double>(z.size());
  double area = integral_below(z.front()) + integral_below(-z.back());  // outside all steps
  for (std::size_t i = 1; i < z.size(); ++i) {
    const double level = static_cast<double>(i) / n;
    area += area_between(z[i - 1], z[i], level, boost::math::quantile(boost::math::normal(), level),
                         integral_below);
  }
  return model_deviation * area;
}

double u_pooled_area(std::span<const double> u) {
  const std::vector<double> x = sorted(u);
  if (x.front() < 0.0 || x.back() > 1.0)
    throw std::invalid_argument("values of a distribution function lie between 0 and 1");
  const double n = static_cast<double>(x.size());
  const auto half_square = [](double a) { return 0.5 * a * a; };
  double area = 0.0;
  for (std::size_t i = 0; i <= x.size(); ++i) {
    const double from = i == 0 ? 0.0 : x[i - 1], to = i == x.size() ? 1.0 : x[i];
    const double level = static_cast<double>(i) / n;
    area += area_between(from, to, level, level, half_square);
  }
  return area;
}

double reliability(double mean_difference, double deviation, double tolerance) {
  if (!(deviation > 0.0) || !(tolerance > 0.0))
    throw std::invalid_argument(
        "a reliability needs a standard deviation and a tolerance greater than zero");
  return below((tolerance - mean_difference) / deviation) -
         below((-tolerance - mean_difference) / deviation);
}

}  // namespace impactrig::fitting
