// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/profile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "fitting/all_cores.hpp"

namespace impactrig::fitting {
namespace {

constexpr double quantile = 3.841458820694124;       // of chi-square, 1 degree of freedom, 95 %
constexpr double seen_to = 1.3 * 1.959963984540054;  // in roots of Δχ², a little past the quantile
constexpr double root_step = 0.5;                    // wanted between neighbouring points
constexpr double farthest = 30.0;                    // standard errors
constexpr int most_points = 24;                      // of a side
constexpr double most_gap = 1.0;       // in roots of Δχ², where it passes the quantile
constexpr double unknown_step = 0.01;  // of a parameter's scale, where no standard error is known
constexpr double noise_of_search = 0.02;  // in Δχ²
constexpr Search follow = {.tolerance = 1e-7};

struct Point {
  double value, delta;
};

double root(double delta) {
  return std::sqrt(std::max(0.0, delta));
}

/// The other parameters, fitted again wherever this one is put.
class Follower {
 public:
  Follower(FitProblem& problem, std::size_t number, double least_cost, double inflation)
      : problem_(problem),
        number_(number),
        least_cost_(least_cost),
        inflation_(inflation),
        values_(problem.values()) {}

  Point at(double value) {
    values_[number_] = value;
    problem_.set_values(values_);
    const SearchEnd end = problem_.search(follow, {number_});
    values_ = problem_.values();
    return {value, 2.0 * (end.cost - least_cost_) / (inflation_ * inflation_)};
  }

 private:
  FitProblem& problem_;
  std::size_t number_;
  double least_cost_, inflation_;
  std::vector<double> values_;
};

/// Halves the last stretch while Δχ² rises so much along it that where it passes the quantile is
/// not known: a step may have been too long by decades.
void close_in(Follower& follower, double best, std::vector<Point>& points) {
  constexpr int most_halvings = 40;
  for (int k = 0; k < most_halvings; ++k) {
    const Point before = points.size() > 1 ? points[points.size() - 2] : Point{best, 0.0};
    const Point& last = points.back();
    if (!(last.delta >= quantile) || root(last.delta) - root(before.delta) <= most_gap) return;
    const Point between = follower.at(0.5 * (before.value + last.value));
    if (between.delta >= quantile)
      points.back() = between;
    else
      points.insert(points.end() - 1, between);
  }
}

/// Points from the best fit outwards, `direction` +1 or -1. From a bound, where the standard error
/// says little, as far as the points go.
std::vector<Point> walk(Follower& follower, const Variable& v, double direction, double std_error) {
  const double best = v.value;
  const double unit = std_error > 0.0 ? std_error : unknown_step * v.scale;
  const double far = std_error > 0.0 ? farthest * unit : std::numeric_limits<double>::infinity();
  const double bound = direction > 0.0 ? v.upper : v.lower;
  std::vector<Point> points;
  double step = root_step * unit;
  double at = best;
  while (points.size() < most_points && std::abs(at - best) < far && at != bound) {
    const double previous = points.empty() ? 0.0 : root(points.back().delta);
    at += direction * step;
    if ((bound - at) * direction < 0.0) at = bound;
    points.push_back(follower.at(at));
    const double reached = root(points.back().delta);
    if (reached > seen_to) break;
    step *= std::clamp(root_step / std::max(reached - previous, 0.1 * root_step), 0.3, 2.0);
  }
  if (!points.empty()) close_in(follower, best, points);
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
  const auto side = [&](double direction) {
    problem.set_values(best);
    Follower follower(problem, number, least, inflation);
    return walk(follower, v, direction, std_error);
  };
  std::vector<Point> down = side(-1.0);
  const std::vector<Point> up = side(1.0);
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
