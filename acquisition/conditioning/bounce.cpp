// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/bounce.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "acquisition/conditioning/background.hpp"

namespace impactrig::acquisition {

namespace {

constexpr int course_terms = 3;        ///< of the motion before: place, speed, acceleration
constexpr int most_powers = 3;         ///< of the departure from it
constexpr double stands_out = 5.0;     ///< standard errors
constexpr double beyond_doubt = 1.96;  ///< standard errors
constexpr std::size_t fewest = 8;      ///< samples that say what a course is
constexpr std::size_t most = 2048;     ///< means that a fit takes in place of more samples
constexpr double averaged = 3.0;       ///< contact durations over which vibration is averaged
constexpr double end_part = 0.15;      ///< of a contact: half a parabola for a place

double as_double(std::size_t n) {
  return static_cast<double>(n);
}

/// Means of neighbours, and where they lie [samples].
struct Points {
  std::vector<double> at, values;
  double per_point = 1.0;  ///< samples
};

/// A fit with the touch at one place; `c` are of powers of (t - touch) / scale.
struct TouchFit {
  double touch = 0.0, squares = INFINITY, criterion = INFINITY;
  Eigen::VectorXd c;
};

struct Touched {
  Estimate touch, level, approach;
};

class BounceFit {
 public:
  BounceFit(const Trace& trace, const Bend& bend, std::size_t floor, std::size_t window);
  std::optional<Bounce> run();

 private:
  bool find_turn();
  Points points() const;
  TouchFit at(const Points& points, double touch, int powers) const;
  TouchFit best(const Points& points, int powers) const;
  std::vector<TouchFit> fits(const Points& points) const;
  Touched touched(const Points& points) const;
  Eigen::MatrixXd covariance(const Points& points, const TouchFit& fit) const;
  std::optional<double> passes(double level, double half) const;
  std::optional<Estimate> place(double at, double half) const;
  std::optional<Bounce::Return> rebound(double sure, double duration) const;

  const Trace& trace_;
  std::vector<double> y_;  ///< grows while the bar approaches
  double grain_;
  std::size_t begin_, end_;  ///< of the course before the bend
  std::size_t turn_ = 0;
  double sign_ = 1.0, noise_ = 0.0, correlation_ = 1.0, scale_ = 1.0;
};

BounceFit::BounceFit(const Trace& trace, const Bend& bend, std::size_t floor, std::size_t window)
    : trace_(trace),
      y_(trace.values),
      grain_(grain_of_motion(trace)),
      end_(bend.index > 2 * bend.width ? bend.index - 2 * bend.width : 0) {
  begin_ = std::max(floor, end_ > window ? end_ - window : 0);
}

/// The farthest sample before the motion comes back by more than its noise, or the last one where
/// it does not. False where there is no course before.
bool BounceFit::find_turn() {
  if (end_ < begin_ + fewest) return false;
  const QuietFit line = fit_quiet(y_, begin_, end_, 1, grain_, trace_.valid);
  if (line.coefficients[1] < 0.0) sign_ = -1.0;
  for (double& value : y_) value *= sign_;
  const QuietFit course = fit_quiet(y_, begin_, end_, 2, grain_, trace_.valid);
  noise_ = std::max(course.sigma, grain_ / std::sqrt(12.0));
  correlation_ = course.correlation;
  const double band = stands_out * std::sqrt(2.0) * noise_;
  turn_ = end_;
  for (std::size_t i = end_ + 1; i < y_.size(); ++i) {
    if (y_[i] > y_[turn_]) turn_ = i;
    if (y_[i] < y_[turn_] - band) return turn_ >= end_ + 3;
  }
  return false;
}

Points BounceFit::points() const {
  const std::size_t block = (turn_ + 1 - begin_ + most - 1) / most;
  Points points;
  points.per_point = as_double(block);
  for (std::size_t i = begin_; i + block <= turn_ + 1; i += block) {
    double sum = 0.0;
    bool sound = true;
    for (std::size_t k = i; k < i + block; ++k) {
      sum += y_[k];
      sound = sound && trace_.is_valid(k);
    }
    if (!sound) continue;
    points.at.push_back(as_double(i) + 0.5 * (points.per_point - 1.0));
    points.values.push_back(sum / points.per_point);
  }
  return points;
}

/// The terms of the course and of the departure from it at u, and by `slopes` their derivatives.
void fill_row(double u, bool slopes, Eigen::Ref<Eigen::RowVectorXd> row) {
  for (int k = 0; k < row.size(); ++k) {
    const double power = k < course_terms ? k : 2.5 + 0.5 * (k - course_terms);
    if (k >= course_terms && u <= 0.0)
      row(k) = 0.0;
    else if (slopes)
      row(k) = k == 0 ? 0.0 : power * std::pow(u, power - 1.0);
    else
      row(k) = std::pow(u, power);
  }
}

TouchFit BounceFit::at(const Points& points, double touch, int powers) const {
  const auto n = static_cast<Eigen::Index>(points.at.size());
  Eigen::MatrixXd matrix(n, course_terms + powers);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double u = (points.at[static_cast<std::size_t>(i)] - touch) / scale_;
    const double root = u > 0.0 ? std::sqrt(u) : 0.0;
    matrix(i, 0) = 1.0;
    matrix(i, 1) = u;
    matrix(i, 2) = u * u;
    double term = u * u * root;
    for (int k = 0; k < powers; ++k, term *= root) matrix(i, course_terms + k) = term;
  }
  const Eigen::Map<const Eigen::VectorXd> values(points.values.data(), n);
  TouchFit fit;
  fit.touch = touch;
  fit.c = matrix.householderQr().solve(values);
  fit.squares = (values - matrix * fit.c).squaredNorm();
  return fit;
}

/// The best place of the touch: on a grid, then by golden section between its neighbours.
TouchFit BounceFit::best(const Points& points, int powers) const {
  constexpr int steps = 32, sections = 24;
  constexpr double golden = 0.3819660112501051;
  const double low = std::max(as_double(begin_ + fewest), as_double(end_) - 2.0 * scale_);
  const double step = (as_double(turn_) - low) / steps;
  TouchFit best;
  for (int i = 0; i <= steps; ++i)
    if (const TouchFit fit = at(points, low + step * i, powers); fit.squares < best.squares)
      best = fit;
  double from = std::max(low, best.touch - step);
  double to = std::min(as_double(turn_), best.touch + step);
  for (int i = 0; i < sections; ++i) {
    const TouchFit left = at(points, from + golden * (to - from), powers);
    const TouchFit right = at(points, to - golden * (to - from), powers);
    (left.squares < right.squares ? to : from) =
        left.squares < right.squares ? right.touch : left.touch;
    const TouchFit& better = left.squares < right.squares ? left : right;
    if (better.squares < best.squares) best = better;
  }
  return best;
}

/// With one power and more, as many as the samples carry.
std::vector<TouchFit> BounceFit::fits(const Points& points) const {
  const double n = as_double(points.at.size());
  const double rounding = n * grain_ * grain_ / (120.0 * points.per_point);  // fits no better
  std::vector<TouchFit> fits;
  for (int powers = 1; powers <= most_powers; ++powers) {
    const double p = course_terms + powers + 2.0;  // touch and variance besides
    if (n < p + 2.0 || powers >= static_cast<int>(turn_ - end_)) break;
    fits.push_back(best(points, powers));
    fits.back().criterion = n * std::log(std::max(fits.back().squares, rounding) / n) + 2.0 * p +
                            2.0 * p * (p + 1.0) / (n - p - 1.0);
  }
  return fits;
}

/// Touch, level and approach of all fits, each by its weight exp(-criterion/2).
Touched BounceFit::touched(const Points& points) const {
  Touched result;
  double least = INFINITY, weights = 0.0;
  std::vector<std::array<Estimate, 3>> all;
  const std::vector<TouchFit> fits = this->fits(points);
  for (const TouchFit& fit : fits) least = std::min(least, fit.criterion);
  const std::array<Estimate*, 3> told = {&result.touch, &result.level, &result.approach};
  for (const TouchFit& fit : fits) {
    const Eigen::MatrixXd c = covariance(points, fit);
    const Eigen::Index last = c.rows() - 1;
    all.push_back({Estimate{fit.touch, std::sqrt(c(last, last))},
                   Estimate{fit.c(0), std::sqrt(c(0, 0))},
                   Estimate{fit.c(1) / scale_, std::sqrt(c(1, 1)) / scale_}});
    const double weight = std::exp(0.5 * (least - fit.criterion));
    weights += weight;
    for (std::size_t k = 0; k < told.size(); ++k) told[k]->value += weight * all.back()[k].value;
  }
  for (Estimate* const estimate : told) estimate->value /= weights;
  for (std::size_t k = 0; k < told.size(); ++k) {
    double variance = 0.0;
    for (std::size_t i = 0; i < fits.size(); ++i) {
      const double off = all[i][k].value - told[k]->value;
      variance += std::exp(0.5 * (least - fits[i].criterion)) / weights *
                  (all[i][k].error * all[i][k].error + off * off);
    }
    told[k]->error = std::sqrt(variance);
  }
  return result;
}

/// Of the coefficients and, last, of the touch.
Eigen::MatrixXd BounceFit::covariance(const Points& points, const TouchFit& fit) const {
  const auto n = static_cast<Eigen::Index>(points.at.size());
  const Eigen::Index p = fit.c.size();
  Eigen::MatrixXd slopes(n, p + 1);
  Eigen::RowVectorXd row(p);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double u = (points.at[static_cast<std::size_t>(i)] - fit.touch) / scale_;
    fill_row(u, false, row);
    slopes.row(i).head(p) = row;
    fill_row(u, true, row);
    slopes(i, p) = -row.dot(fit.c) / scale_;
  }
  const double freedom = std::max(1.0, static_cast<double>(n - p - 1));
  const double variance =
      std::max(fit.squares / freedom * std::max(1.0, correlation_ / points.per_point),
               noise_ * noise_ * correlation_ / points.per_point);
  return variance * (slopes.transpose() * slopes).completeOrthogonalDecomposition().pseudoInverse();
}

/// Where the motion is by a parabola through what lies up to `half` to either side; none where the
/// record ends before or too few samples are valid.
std::optional<Estimate> BounceFit::place(double at, double half) const {
  if (at - half < 0.0 || at + half > as_double(y_.size() - 1)) return std::nullopt;
  std::vector<std::array<double, 2>> sound;
  for (auto i = static_cast<std::size_t>(std::ceil(at - half)); as_double(i) <= at + half; ++i)
    if (trace_.is_valid(i)) sound.push_back({(as_double(i) - at) / half, y_[i]});
  if (sound.size() < 4) return std::nullopt;
  const auto n = static_cast<Eigen::Index>(sound.size());
  Eigen::MatrixXd matrix(n, 3);
  Eigen::VectorXd values(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto [u, value] = sound[static_cast<std::size_t>(i)];
    matrix.row(i) << 1.0, u, u * u;
    values(i) = value;
  }
  const Eigen::Matrix3d inverse = (matrix.transpose() * matrix).inverse();
  const Eigen::Vector3d c = inverse * (matrix.transpose() * values);
  return Estimate{c(0), noise_ * std::sqrt(correlation_ * inverse(0, 0))};
}

/// Where the motion, by such parabolas, comes back through `level`.
std::optional<double> BounceFit::passes(double level, double half) const {
  double before = 0.0;
  for (std::size_t i = turn_; i < y_.size(); ++i) {
    const auto here = place(as_double(i), half);
    if (!here) return std::nullopt;
    if (here->value <= level)
      return as_double(i) - (i == turn_ ? 0.0 : (level - here->value) / (before - here->value));
    before = here->value;
  }
  return std::nullopt;
}

std::optional<Bounce::Return> BounceFit::rebound(double sure, double duration) const {
  const double half = std::max(2.0, end_part * duration);
  const auto from = passes(sure, half);
  if (!from) return std::nullopt;
  const double length = std::min(averaged * duration, as_double(y_.size() - 1) - half - *from);
  if (length < duration) return std::nullopt;
  std::array<Estimate, 4> places;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const auto here = place(*from + length * as_double(k) / 3.0, half);
    if (!here) return std::nullopt;
    places[k] = *here;
  }
  Bounce::Return result{.from = *from, .to = *from + length};
  result.speed = {(places[0].value - places[3].value) / length,
                  std::hypot(places[0].error, places[3].error) / length};
  double squares = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double third = 3.0 * (places[k].value - places[k + 1].value) / length;
    squares += (third - result.speed.value) * (third - result.speed.value);
  }
  result.vibration = std::sqrt(squares / 6.0);  // of the mean of three
  return result;
}

std::optional<Bounce> BounceFit::run() {
  if (!find_turn()) return std::nullopt;
  scale_ = std::max(as_double(turn_ - end_), as_double(fewest));
  const Points points = this->points();
  if (points.at.size() < course_terms + 6) return std::nullopt;
  const Touched found = touched(points);
  if (!(found.approach.value > stands_out * found.approach.error)) return std::nullopt;
  Bounce bounce{.sign = sign_,
                .touch = found.touch.value,
                .level = sign_ * found.level.value,
                .turn = turn_,
                .approach = found.approach};
  const double half = std::max(2.0, end_part * (as_double(turn_) - bounce.touch));
  bounce.back = passes(found.level.value, half);
  if (!bounce.back) return bounce;
  bounce.rebound =
      rebound(found.level.value - beyond_doubt * found.level.error, *bounce.back - bounce.touch);
  return bounce;
}

}  // namespace

double grain_of_motion(const Trace& trace) {
  const std::vector<double>& y = trace.values;
  std::vector<double> seconds;
  for (std::size_t i = 2; i < y.size(); ++i)
    if (trace.is_valid(i) && trace.is_valid(i - 1) && trace.is_valid(i - 2))
      seconds.push_back(y[i] - 2.0 * y[i - 1] + y[i - 2]);
  const double grain = grain_of(y, trace.valid);
  return seconds.size() < fewest ? grain : std::max(grain, quantum_of(seconds));
}

std::optional<Bounce> fit_bounce(const Trace& trace, const Bend& bend, std::size_t floor,
                                 std::size_t window) {
  return BounceFit(trace, bend, floor, window).run();
}

}  // namespace impactrig::acquisition
