// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/profile.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "fitting/all_cores.hpp"

namespace impactrig::fitting {
namespace {

constexpr double quantile = 3.841458820694124;       // of chi-square, 1 degree of freedom, 95 %
constexpr double seen_to = 1.3 * 1.959963984540054;  // in roots of Δχ², a little past the quantile
constexpr double root_step = 0.5;                    // wanted between neighbouring points
constexpr double farthest = 30.0;                    // standard errors
constexpr int most_points = 24;                      // of a side
constexpr double unknown_step = 0.01;  // of a parameter's scale, where no standard error is known
constexpr double noise_of_search = 0.02;  // in Δχ²
constexpr Search follow = {.tolerance = 1e-7};

struct Point {
  double value, delta;
};

double root(double delta) {
  return std::sqrt(std::max(0.0, delta));
}

/// Points from the best fit outwards, `direction` +1 or -1.
std::vector<Point> walk(FitProblem& problem, std::size_t number, double direction, double std_error,
                        double least_cost, double inflation) {
  const Variable& v = problem.variables()[number];
  const double best = v.value;
  const double unit = std_error > 0.0 ? std_error : unknown_step * v.scale;
  const double bound = direction > 0.0 ? v.upper : v.lower;
  std::vector<double> values = problem.values();
  std::vector<Point> points;
  double step = root_step * unit;
  double at = best;
  while (points.size() < most_points && std::abs(at - best) < farthest * unit && at != bound) {
    const double previous = points.empty() ? 0.0 : root(points.back().delta);
    at += direction * step;
    if ((bound - at) * direction < 0.0) at = bound;
    values[number] = at;
    problem.set_values(values);
    const SearchEnd end = problem.search(follow, {number});
    values = problem.values();
    const double delta = 2.0 * (end.cost - least_cost) / (inflation * inflation);
    points.push_back({at, delta});
    if (root(delta) > seen_to) break;
    const double gained = std::max(root(delta) - previous, 0.1 * root_step);
    step *= std::clamp(root_step / gained, 0.3, 2.0);
  }
  return points;
}

/// Where the root of Δχ², nearly linear, passes that of the quantile; none where it does not.
std::optional<double> crossing(double best, const std::vector<Point>& points) {
  Point before{best, 0.0};
  const double wanted = std::sqrt(quantile);
  for (const Point& point : points) {
    if (point.delta >= quantile) {
      const double from = root(before.delta), to = root(point.delta);
      return before.value + (point.value - before.value) * (wanted - from) / (to - from);
    }
    before = point;
  }
  return std::nullopt;
}

Profile profile(FitProblem problem, std::size_t number, double std_error, double inflation) {
  const Variable v = problem.variables()[number];
  Profile result{
      .name = v.name, .unit = v.unit, .value = {}, .delta_chi2 = {}, .lower = {}, .upper = {}};
  const std::vector<double> start = problem.values();
  const double least = problem.search(follow, {number}).cost;
  const std::vector<double> best = problem.values();
  std::vector<Point> down = walk(problem, number, -1.0, std_error, least, inflation);
  problem.set_values(best);
  const std::vector<Point> up = walk(problem, number, 1.0, std_error, least, inflation);
  result.lower = crossing(v.value, down);
  result.upper = crossing(v.value, up);
  std::ranges::reverse(down);
  down.push_back({v.value, 0.0});
  down.insert(down.end(), up.begin(), up.end());
  for (const Point& point : down) {
    result.value.push_back(point.value);
    result.delta_chi2.push_back(point.delta);
    result.found_better = result.found_better || point.delta < -noise_of_search;
  }
  return result;
}

}  // namespace

std::vector<Profile> profiles(const FitProblem& problem, const std::vector<std::size_t>& numbers,
                              const std::vector<double>& std_errors, double inflation) {
  std::vector<Profile> result(numbers.size());
  run_on_all_cores(numbers.size(), [&](std::size_t i, std::size_t) {
    result[i] = profile(problem.copy(), numbers[i], std_errors[i], inflation);
  });
  return result;
}

}  // namespace impactrig::fitting
