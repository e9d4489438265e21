// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/line_fit.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

namespace impactrig::fitting {
namespace {

// Pearson's points of 1901 with York's weights of 1966.
std::vector<LinePoint> pearson_york() {
  constexpr std::array<double, 10> x = {0.0, 0.9, 1.8, 2.6, 3.3, 4.4, 5.2, 6.1, 6.5, 7.4};
  constexpr std::array<double, 10> y = {5.9, 5.4, 4.4, 4.6, 3.5, 3.7, 2.8, 2.8, 2.4, 1.5};
  constexpr std::array<double, 10> of_x = {1000, 1000, 500, 800, 200, 80, 60, 20, 1.8, 1};
  constexpr std::array<double, 10> of_y = {1, 1.8, 4, 8, 20, 20, 70, 70, 100, 500};
  std::vector<LinePoint> points;
  for (std::size_t i = 0; i < x.size(); ++i)
    points.push_back({x[i], y[i], 1.0 / std::sqrt(of_x[i]), 1.0 / std::sqrt(of_y[i])});
  return points;
}

// [YorkEtAl2004]: slope, intercept, S / (n − 2) and standard errors that go with it.
TEST(LineFit, GivesYorksLineThroughPearsonsPoints) {
  const LineFit line = fit_line(pearson_york());
  EXPECT_TRUE(line.converged);
  EXPECT_NEAR(line.slope, -0.480533407, 5e-10);
  EXPECT_NEAR(line.intercept, 5.479910224, 5e-10);
  EXPECT_NEAR(line.q / 8.0, 1.483294149, 5e-10);
  EXPECT_NEAR(line.slope_error, 0.0579850090, 5e-11);
  EXPECT_NEAR(line.intercept_error, 0.294970735, 5e-10);
}

// Which coordinate is called x does not matter: y = a + b x is x = −a / b + y / b.
TEST(LineFit, DoesNotCareWhichCoordinateIsWhich) {
  std::vector<LinePoint> points = pearson_york();
  for (std::size_t i = 0; i < points.size(); ++i) points[i].correlation = i % 2 ? 0.4 : -0.2;
  const LineFit line = fit_line(points);
  for (LinePoint& p : points) {
    std::swap(p.x, p.y);
    std::swap(p.x_error, p.y_error);
  }
  const LineFit other = fit_line(points);
  EXPECT_NEAR(other.slope * line.slope, 1.0, 1e-11);
  EXPECT_NEAR(other.intercept, -line.intercept / line.slope, 1e-10);
  EXPECT_NEAR(other.q / line.q, 1.0, 1e-11);
  EXPECT_NEAR(other.slope_error * line.slope * line.slope, line.slope_error, 1e-10);
}

// Deming's closed form for one ratio λ of the variances and no correlation.
TEST(LineFit, OfOneRatioIsDemings) {
  std::vector<LinePoint> points = pearson_york();
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
  for (LinePoint& p : points) {
    p.x_error = 0.2;
    p.y_error = 0.3;
    n += 1.0;
    x += p.x;
    y += p.y;
  }
  for (const LinePoint& p : points) {
    xx += std::pow(p.x - x / n, 2);
    xy += (p.x - x / n) * (p.y - y / n);
    yy += std::pow(p.y - y / n, 2);
  }
  const double ratio = 0.09 / 0.04;
  const double half = (yy - ratio * xx) / (2.0 * xy);
  EXPECT_NEAR(fit_line(points).slope, half - std::sqrt(half * half + ratio), 1e-12);
}

TEST(LineFit, FindsTheScatterAboutTheLine) {
  const std::vector<LinePoint> points = pearson_york();
  const double variance = line_variance_where_q_is(8.0, points);
  EXPECT_GT(variance, 0.0);
  EXPECT_NEAR(fit_line(points, variance).q, 8.0, 1e-9);
  EXPECT_EQ(line_variance_where_q_is(12.0, points), 0.0);  // it is 11.87 without
}

TEST(LineFit, RefusesWhatIsNoPoint) {
  std::vector<LinePoint> points = pearson_york();
  EXPECT_THROW(fit_line({points.data(), 2}), std::invalid_argument);
  for (auto* error : {&points[3].x_error, &points[4].y_error, &points[5].correlation}) {
    const double before = *error;
    *error = -1.0;
    EXPECT_THROW(fit_line(points), std::invalid_argument);
    *error = before;
  }
  points[0].y = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(fit_line(points), std::invalid_argument);
}

}  // namespace
}  // namespace impactrig::fitting
