// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/touch_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "acquisition/conditioning/background.hpp"

namespace impactrig::acquisition {

namespace {

constexpr int course_terms = 3;                           ///< place, speed, acceleration
constexpr double fastest_seen = 0.25 * std::numbers::pi;  ///< vibration [radians per point]
constexpr int swing_terms = 7;  ///< such a course, sine and cosine and their growth
constexpr double golden = 0.3819660112501051;
constexpr int sections = 16;

/// Touch and circular frequency of a fit, and how many powers its departure has.
struct Shape {
  double touch = 0.0, omega = 0.0;  ///< [samples], [radians per sample]; 0: no vibration
  int powers = 1;

  int terms() const { return course_terms + powers + (omega > 0.0 ? 2 : 0); }

  int parameters() const { return terms() + (omega > 0.0 ? 3 : 2); }  ///< touch, ω, variance too
};

struct ShapeFit {
  Shape shape;
  double squares = INFINITY;
  Eigen::VectorXd c{};  ///< of powers of (t - touch) / scale, and of the sine and cosine
};

/// One fit's say on touch, level and approach.
struct Opinion {
  std::array<Estimate, 3> told{};
  double criterion = INFINITY;
  bool vibrates = false;
};

class TouchSearch {
 public:
  TouchSearch(const Points& points, const TouchRange& range);
  Touched run();

 private:
  Eigen::MatrixXd terms(const Shape& shape) const;
  ShapeFit solve(const Shape& shape) const;
  ShapeFit best_touch(const Shape& shape, double from, double to) const;
  ShapeFit best_touch(const Shape& shape) const;
  ShapeFit best_omega(const Shape& shape, double from, double to) const;
  double omega_before(double from, double to) const;
  ShapeFit vibrating(int powers, double omega) const;
  void find_correlation(const std::vector<ShapeFit>& fits);
  Eigen::MatrixXd slopes(const ShapeFit& fit) const;
  Opinion opinion(const ShapeFit& fit) const;
  double criterion(const ShapeFit& fit) const;
  bool comes_on(const ShapeFit& fit) const;

  const Points& points_;
  const TouchRange& range_;
  Eigen::Index n_;
  Eigen::Map<const Eigen::VectorXd> values_;
  double correlation_ = 1.0;                ///< of what the fits leave [points]
  double step_, slowest_, slow_, fastest_;  ///< [radians per sample]
};

TouchSearch::TouchSearch(const Points& points, const TouchRange& range)
    : points_(points),
      range_(range),
      n_(static_cast<Eigen::Index>(points.at.size())),
      values_(points.values.data(), n_) {
  const double whole = points.at.back() - points.at.front();
  slowest_ = std::numbers::pi / whole;
  step_ = 0.5 * slowest_;
  slow_ = std::numbers::pi / range.scale;
  fastest_ = fastest_seen / points.per_point;
}

Eigen::MatrixXd TouchSearch::terms(const Shape& shape) const {
  Eigen::MatrixXd matrix(n_, shape.terms());
  for (Eigen::Index i = 0; i < n_; ++i) {
    const double s = points_.at[static_cast<std::size_t>(i)] - shape.touch;
    const double u = s / range_.scale, root = u > 0.0 ? std::sqrt(u) : 0.0;
    matrix(i, 0) = 1.0;
    matrix(i, 1) = u;
    matrix(i, 2) = u * u;
    double term = u * u * root;
    for (int k = 0; k < shape.powers; ++k, term *= root) matrix(i, course_terms + k) = term;
    if (shape.omega > 0.0)
      matrix.row(i).tail(2) << std::sin(shape.omega * s), std::cos(shape.omega * s);
  }
  return matrix;
}

ShapeFit TouchSearch::solve(const Shape& shape) const {
  const Eigen::MatrixXd matrix = terms(shape);
  ShapeFit fit{.shape = shape};
  fit.c = matrix.householderQr().solve(values_);
  fit.squares = (values_ - matrix * fit.c).squaredNorm();
  return fit;
}

/// By golden section over what `at` sets.
template <typename At>
ShapeFit best_within(double from, double to, const At& at) {
  ShapeFit best;
  for (int i = 0; i < sections; ++i) {
    const double left = from + golden * (to - from), right = to - golden * (to - from);
    const ShapeFit low = at(left), high = at(right);
    (low.squares < high.squares ? to : from) = low.squares < high.squares ? right : left;
    const ShapeFit& better = low.squares < high.squares ? low : high;
    if (better.squares < best.squares) best = better;
  }
  return best;
}

ShapeFit TouchSearch::best_touch(const Shape& shape, double from, double to) const {
  return best_within(std::max(from, range_.earliest), std::min(to, range_.latest),
                     [&](double touch) {
                       Shape other = shape;
                       other.touch = touch;
                       return solve(other);
                     });
}

/// On a grid, then between its neighbours.
ShapeFit TouchSearch::best_touch(const Shape& shape) const {
  constexpr int steps = 32;
  const double step = (range_.latest - range_.earliest) / steps;
  ShapeFit best;
  for (int i = 0; i <= steps; ++i) {
    Shape other = shape;
    other.touch = range_.earliest + step * i;
    if (const ShapeFit fit = solve(other); fit.squares < best.squares) best = fit;
  }
  const double top = best.shape.touch;
  const ShapeFit finer = best_touch(best.shape, top - step, top + step);
  return finer.squares < best.squares ? finer : best;
}

ShapeFit TouchSearch::best_omega(const Shape& shape, double from, double to) const {
  return best_within(std::max(from, slowest_), std::min(to, fastest_), [&](double omega) {
    Shape other = shape;
    other.omega = omega;
    return solve(other);
  });
}

/// The ω within a band with which the course before touch leaves least; 0 where there is none.
double TouchSearch::omega_before(double from, double to) const {
  Eigen::Index n = 0;
  while (n < n_ && points_.at[static_cast<std::size_t>(n)] < range_.course_end) ++n;
  if (n < course_terms + 5) return 0.0;
  Eigen::MatrixXd matrix(n, course_terms + 2);
  double best = 0.0, least = INFINITY;
  for (double omega = from; omega <= to; omega += step_) {
    for (Eigen::Index i = 0; i < n; ++i) {
      const double s = points_.at[static_cast<std::size_t>(i)] - range_.course_end;
      const double u = s / range_.scale;
      matrix.row(i) << 1.0, u, u * u, std::sin(omega * s), std::cos(omega * s);
    }
    const Eigen::VectorXd c = matrix.householderQr().solve(values_.head(n));
    const double squares = (values_.head(n) - matrix * c).squaredNorm();
    if (squares < least) best = omega, least = squares;
  }
  return best;
}

/// With a vibration of about ω: touch and ω in turns.
ShapeFit TouchSearch::vibrating(int powers, double omega) const {
  constexpr int turns = 2;
  ShapeFit best = best_touch({.omega = omega, .powers = powers});
  double reach = step_, way = 0.5 * range_.scale;
  for (int i = 0; i < turns; ++i, reach *= 0.5, way *= 0.5) {
    const double around = best.shape.omega, touch = best.shape.touch;
    if (const ShapeFit fit = best_omega(best.shape, around - reach, around + reach);
        fit.squares < best.squares)
      best = fit;
    if (const ShapeFit fit = best_touch(best.shape, touch - way, touch + way);
        fit.squares < best.squares)
      best = fit;
  }
  return best;
}

void TouchSearch::find_correlation(const std::vector<ShapeFit>& fits) {
  const ShapeFit& best = *std::ranges::min_element(fits, {}, &ShapeFit::squares);
  const Eigen::VectorXd left = values_ - terms(best.shape) * best.c;
  correlation_ = correlation_time({left.data(), static_cast<std::size_t>(n_)});
}

/// Of all that the fit has found by: its coefficients, touch and, last, ω.
Eigen::MatrixXd TouchSearch::slopes(const ShapeFit& fit) const {
  const Shape& shape = fit.shape;
  const bool vibrates = shape.omega > 0.0;
  const Eigen::Index p = shape.terms();
  Eigen::MatrixXd matrix(n_, p + (vibrates ? 2 : 1));
  matrix.leftCols(p) = terms(shape);
  for (Eigen::Index i = 0; i < n_; ++i) {
    const double s = points_.at[static_cast<std::size_t>(i)] - shape.touch;
    const double u = s / range_.scale, root = u > 0.0 ? std::sqrt(u) : 0.0;
    double speed = fit.c(1) + 2.0 * fit.c(2) * u, term = u * root;
    for (int k = 0; k < shape.powers; ++k, term *= root)
      speed += (2.5 + 0.5 * k) * fit.c(course_terms + k) * term;
    speed /= range_.scale;
    if (vibrates) {
      const double across = fit.c(p - 2) * matrix(i, p - 1) - fit.c(p - 1) * matrix(i, p - 2);
      speed += shape.omega * across;
      matrix(i, p + 1) = s * across;
    }
    matrix(i, p) = -speed;
  }
  return matrix;
}

/// The sum of 1/k up to n, but for 1/(2n).
double harmonic(double n) {
  return std::log(n + 1.0) + std::numbers::egamma;
}

/// Akaike's, corrected for few samples. What is faster than a contact is looked for among many ω,
/// of which the best gains twice the harmonic number of theirs where there is none; that and as
/// much again has to be gained.
double TouchSearch::criterion(const ShapeFit& fit) const {
  const double n = static_cast<double>(n_) / correlation_, p = fit.shape.parameters();
  if (n < p + 2.0) return INFINITY;
  const double rounding =
      static_cast<double>(n_) * range_.grain * range_.grain / (120.0 * points_.per_point);
  const double sought =
      fit.shape.omega > slow_ ? 4.0 * harmonic((fastest_ - slow_) / slowest_) : 0.0;
  return n * std::log(std::max(fit.squares, rounding)) + 2.0 * p +
         2.0 * p * (p + 1.0) / (n - p - 1.0) + sought;
}

Opinion TouchSearch::opinion(const ShapeFit& fit) const {
  const Eigen::Index p = fit.shape.terms();
  const bool vibrates = fit.shape.omega > 0.0;
  const Eigen::MatrixXd slopes = this->slopes(fit);
  const double freedom = std::max(1.0, static_cast<double>(n_ - slopes.cols()));
  const double rounding = range_.grain * range_.grain / (12.0 * points_.per_point);
  const double variance = correlation_ * std::max(fit.squares / freedom, rounding);
  const Eigen::MatrixXd inverse = slopes.completeOrthogonalDecomposition().pseudoInverse();
  Eigen::MatrixXd which = Eigen::MatrixXd::Zero(3, slopes.cols());
  which(0, p) = 1.0;
  which(1, 0) = 1.0;
  which(2, 1) = 1.0 / range_.scale;
  Eigen::Vector3d value(fit.shape.touch, fit.c(0), fit.c(1) / range_.scale);
  if (vibrates) {
    which(1, p - 1) = 1.0;
    which(2, p - 2) = fit.shape.omega;
    which(2, p + 1) = fit.c(p - 2);
    value(1) += fit.c(p - 1);
    value(2) += fit.shape.omega * fit.c(p - 2);
  }
  const Eigen::Vector3d squares = (which * inverse).rowwise().squaredNorm();
  Opinion opinion{.criterion = criterion(fit), .vibrates = vibrates};
  for (Eigen::Index i = 0; i < 3; ++i)
    opinion.told[static_cast<std::size_t>(i)] = {value(i), std::sqrt(variance * squares(i))};
  return opinion;
}

/// A bar that vibrates comes on all the time: its course is faster than the vibration.
bool TouchSearch::comes_on(const ShapeFit& fit) const {
  return fit.shape.omega == 0.0 || fit.shape.omega * fit.c.tail(2).norm() < fit.c(1) / range_.scale;
}

/// The mean of these opinions' numbers `which` by their weights exp(-criterion/2), and its error.
Estimate mean_of(const std::vector<Opinion>& opinions, std::size_t which, bool vibrates) {
  double least = INFINITY, weights = 0.0, sum = 0.0, variance = 0.0;
  const auto counts = [&](const Opinion& o) { return vibrates || !o.vibrates; };
  for (const Opinion& o : opinions)
    if (counts(o)) least = std::min(least, o.criterion);
  const auto weight = [&](const Opinion& o) {
    return counts(o) ? std::exp(0.5 * (least - o.criterion)) : 0.0;
  };
  for (const Opinion& o : opinions) {
    weights += weight(o);
    sum += weight(o) * o.told[which].value;
  }
  const double mean = sum / weights;
  for (const Opinion& o : opinions) {
    if (weight(o) == 0.0) continue;
    const double off = o.told[which].value - mean;
    variance += weight(o) / weights * (o.told[which].error * o.told[which].error + off * off);
  }
  return {mean, std::sqrt(variance)};
}

Touched TouchSearch::run() {
  std::vector<ShapeFit> fits;
  const auto add = [&fits](ShapeFit fit) {
    if (fit.squares < INFINITY) fits.push_back(std::move(fit));
  };
  const double slow = omega_before(slowest_, std::min(slow_, fastest_));
  const double fast = omega_before(slow_, fastest_);
  for (int powers = 1; powers <= range_.most_powers; ++powers) {
    if (n_ < course_terms + powers + 4) break;
    add(best_touch({.powers = powers}));
    if (!range_.may_vibrate || n_ < course_terms + powers + 8) continue;
    for (const double omega : {slow, fast})
      if (omega > 0.0) add(vibrating(powers, omega));
  }
  constexpr Estimate unknown{.error = INFINITY};
  if (fits.empty()) return {unknown, unknown, unknown, unknown, 0.0};
  find_correlation(fits);
  std::vector<Opinion> opinions;
  for (const ShapeFit& fit : fits)
    if (comes_on(fit)) opinions.push_back(opinion(fit));
  const ShapeFit& best =
      *std::ranges::min_element(fits, {}, [this](const ShapeFit& fit) { return criterion(fit); });
  return {.touch = mean_of(opinions, 0, true),
          .level = mean_of(opinions, 1, true),
          .course = mean_of(opinions, 2, false),
          .approach = mean_of(opinions, 2, true),
          .variance = best.squares / static_cast<double>(n_ - best.shape.parameters())};
}

/// What a vibration of this ω leaves, whose amplitude changes steadily beside a course.
ShapeFit swing(const Points& points, double omega) {
  const auto n = static_cast<Eigen::Index>(points.at.size());
  const double length = points.at.back() - points.at.front();
  Eigen::MatrixXd terms(n, swing_terms);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double s = points.at[static_cast<std::size_t>(i)] - points.at.front();
    const double u = s / length, sine = std::sin(omega * s), cosine = std::cos(omega * s);
    terms.row(i) << 1.0, u, u * u, sine, cosine, u * sine, u * cosine;
  }
  const Eigen::Map<const Eigen::VectorXd> values(points.values.data(), n);
  ShapeFit fit{.shape = {.omega = omega}};
  fit.c = terms.householderQr().solve(values);
  fit.squares = (values - terms * fit.c).squaredNorm();
  return fit;
}

}  // namespace

double variance_beside_swing(const Points& points, double fastest) {
  const double freedom = static_cast<double>(points.at.size()) - swing_terms - 2.0;
  if (freedom < 1.0) return 0.0;
  const double step = 0.5 * std::numbers::pi / (points.at.back() - points.at.front());
  const double end = std::min(fastest, fastest_seen / points.per_point);
  const auto at = [&](double omega) { return swing(points, omega); };
  ShapeFit best;
  for (double omega = step; omega <= end; omega += step)
    if (const ShapeFit fit = at(omega); fit.squares < best.squares) best = fit;
  const double around = best.shape.omega;
  const ShapeFit finer = best_within(std::max(0.1 * step, around - step), around + step, at);
  return std::min(best.squares, finer.squares) / freedom;
}

Touched fit_touch(const Points& points, const TouchRange& range) {
  return TouchSearch(points, range).run();
}

}  // namespace impactrig::acquisition
