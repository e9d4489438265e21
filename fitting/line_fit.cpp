// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/line_fit.hpp"

#include <cmath>
#include <stdexcept>
#include <vector>

namespace impactrig::fitting {
namespace {

constexpr int most_iterations = 200;
constexpr double fixed = 1e-13;  // change of the slope, in the ratio of the spreads of y and x

void check(std::span<const LinePoint> points) {
  if (points.size() < 3) throw std::invalid_argument("line: three points are needed");
  for (const LinePoint& p : points) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !(p.y_error > 0.0) || !(p.x_error >= 0.0) ||
        !std::isfinite(p.y_error) || !std::isfinite(p.x_error) || !(std::abs(p.correlation) < 1.0))
      throw std::invalid_argument(
          "line: points must be finite, with errors of y above 0, of x not below, and "
          "correlations inside (-1, 1)");
  }
}

/// Sums over the points for one slope.
struct Weighing {
  double weight = 0.0;                    ///< Σ W
  double x = 0.0, y = 0.0;                ///< weighted means
  std::vector<double> weights, adjusted;  ///< W, β

  Weighing(std::span<const LinePoint> points, double variance, double b) {
    for (const LinePoint& p : points) {
      const double c = p.correlation * p.x_error * p.y_error;
      const double of_line =
          p.y_error * p.y_error + variance + b * b * p.x_error * p.x_error - 2.0 * b * c;
      weights.push_back(1.0 / of_line);
      weight += weights.back();
      x += weights.back() * p.x;
      y += weights.back() * p.y;
    }
    x /= weight;
    y /= weight;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const LinePoint& p = points[i];
      const double u = p.x - x, v = p.y - y;
      const double c = p.correlation * p.x_error * p.y_error;
      adjusted.push_back(weights[i] * (u * (p.y_error * p.y_error + variance) +
                                       b * v * p.x_error * p.x_error - (b * u + v) * c));
    }
  }

  double slope(std::span<const LinePoint> points) const {
    double above = 0.0, below = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      above += weights[i] * adjusted[i] * (points[i].y - y);
      below += weights[i] * adjusted[i] * (points[i].x - x);
    }
    return above / below;
  }
};

/// Of y over that of x.
double ratio_of_spreads(std::span<const LinePoint> points) {
  const double n = static_cast<double>(points.size());
  double x = 0.0, y = 0.0, xx = 0.0, yy = 0.0;
  for (const LinePoint& p : points) {
    x += p.x / n;
    y += p.y / n;
  }
  for (const LinePoint& p : points) {
    xx += (p.x - x) * (p.x - x);
    yy += (p.y - y) * (p.y - y);
  }
  return std::sqrt(yy / xx);
}

/// Without errors of x.
double least_squares_slope(std::span<const LinePoint> points, double variance) {
  std::vector<LinePoint> exact(points.begin(), points.end());
  for (LinePoint& p : exact) p.x_error = 0.0;
  return Weighing(exact, variance, 0.0).slope(exact);
}

}  // namespace

LineFit fit_line(std::span<const LinePoint> points, double variance) {
  check(points);
  LineFit line;
  line.slope = least_squares_slope(points, variance);
  const double size = ratio_of_spreads(points);
  for (int i = 0; i < most_iterations && !line.converged; ++i) {
    const double next = Weighing(points, variance, line.slope).slope(points);
    line.converged = std::abs(next - line.slope) <= fixed * size;
    line.slope = next;
    if (!std::isfinite(next)) break;
  }
  const Weighing at(points, variance, line.slope);
  line.intercept = at.y - line.slope * at.x;
  double mean = 0.0, spread = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double residual = points[i].y - line.intercept - line.slope * points[i].x;
    line.q += at.weights[i] * residual * residual;
    mean += at.weights[i] * at.adjusted[i] / at.weight;
  }
  for (std::size_t i = 0; i < points.size(); ++i)
    spread += at.weights[i] * std::pow(at.adjusted[i] - mean, 2);
  line.slope_error = 1.0 / std::sqrt(spread);
  line.intercept_error = std::sqrt(1.0 / at.weight + std::pow((at.x + mean) * line.slope_error, 2));
  return line;
}

double line_variance_where_q_is(double target, std::span<const LinePoint> points) {
  if (!(fit_line(points).q > target)) return 0.0;
  double low = 0.0, high = points.front().y_error * points.front().y_error;
  while (fit_line(points, high).q > target && std::isfinite(high)) {
    low = high;
    high *= 4.0;
  }
  while (high - low > 1e-13 * high) {  // halved, so some 45 times
    const double middle = low + 0.5 * (high - low);
    if (middle == low || middle == high) break;
    (fit_line(points, middle).q > target ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace impactrig::fitting
