// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/bounce.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "acquisition/conditioning/background.hpp"

namespace impactrig::acquisition {

namespace {

constexpr int most_powers = 5;         ///< of the departure from it
constexpr double stands_out = 5.0;     ///< standard errors
constexpr double beyond_doubt = 1.96;  ///< standard errors
constexpr std::size_t fewest = 8;      ///< samples that say what a course is
constexpr std::size_t most = 512;      ///< means that a fit takes in place of more samples
constexpr double averaged = 3.0;       ///< contact durations over which vibration is averaged
constexpr double end_part = 0.15;      ///< of a contact: half a parabola for a place

double as_double(std::size_t n) {
  return static_cast<double>(n);
}

/// How many standard deviations nothing but noise may go up and down again by among n samples: 6 of
/// a difference, and more of many samples, twice their expected extreme sqrt(2 ln n) and the margin
/// that noise_gate has.
double noise_range(std::size_t n) {
  return std::sqrt(2.0) * std::max(6.0, 2.0 * std::sqrt(std::log(as_double(n))) + 1.7);
}

class BounceFit {
 public:
  BounceFit(const Trace& trace, const Bend& bend, std::size_t floor, std::size_t window);
  std::optional<Bounce> run();

 private:
  bool find_turn();
  double mean_about(std::size_t at, std::size_t half) const;
  void near_touch();
  Touched touched(bool may_vibrate) const;
  Points points(std::size_t last) const;
  std::optional<double> passes(double level, double half) const;
  std::optional<Estimate> place(double at, double half) const;
  std::optional<Bounce::Return> rebound(double sure, double duration) const;
  bool steady() const;
  bool swings(const Bounce& bounce, const Touched& found) const;

  const Trace& trace_;
  std::vector<double> y_;  ///< grows while the bar approaches
  double grain_;
  std::size_t window_, floor_;
  double bent_;              ///< where the bend is over
  std::size_t begin_, end_;  ///< of the course before the bend
  std::size_t turn_ = 0;
  Points fitted_;  ///< from begin_ to turn_
  double sign_ = 1.0, noise_ = 0.0, correlation_ = 1.0, scale_ = 1.0;
};

BounceFit::BounceFit(const Trace& trace, const Bend& bend, std::size_t floor, std::size_t window)
    : trace_(trace),
      y_(trace.values),
      grain_(grain_of_motion(trace)),
      window_(window),
      floor_(floor),
      bent_(as_double(bend.index + 2 * bend.width)),
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
  turn_ = end_;
  for (std::size_t i = end_ + 1; i < y_.size(); ++i) {
    if (y_[i] > y_[turn_]) turn_ = i;
    if (y_[i] < y_[turn_] - noise_ * noise_range(i - end_)) return turn_ >= end_ + 3;
  }
  return false;
}

/// The mean of the valid samples about a place, up to `half` to either side.
double BounceFit::mean_about(std::size_t at, std::size_t half) const {
  double sum = 0.0, count = 0.0;
  for (std::size_t i = at - std::min(at, half); i <= std::min(at + half, y_.size() - 1); ++i) {
    if (!trace_.is_valid(i)) continue;
    sum += y_[i];
    count += 1.0;
  }
  return count > 0.0 ? sum / count : y_[at];
}

/// A bar that vibrates as it comes bends before it touches. If it leaves its course as s³, its mean
/// speed from touch to turn is two thirds of what it came with: the course is taken up to twice as
/// long before the turn.
void BounceFit::near_touch() {
  constexpr double part = 2.0 / 3.0;
  for (int i = 0; i < 2; ++i) {
    const QuietFit line = fit_quiet(y_, begin_, end_, 1, grain_, trace_.valid);
    const double speed = line.coefficients[1] / line.half;
    const auto stays_behind = [&](std::size_t n) {
      const double doubt = beyond_doubt * noise_ * std::sqrt(2.0 / as_double(2 * (n / 8) + 1));
      return mean_about(turn_, n / 8) - mean_about(turn_ - n, n / 8) <
             part * speed * as_double(n) + doubt;
    };
    std::size_t lasts = (turn_ - end_) / 2;
    while (lasts > 3 && !stays_behind(lasts)) --lasts;
    window_ = std::max(window_, 2 * lasts);
    end_ = std::max(end_, turn_ - 2 * lasts);
    begin_ = std::max(floor_, end_ > window_ ? end_ - window_ : 0);
  }
}

Touched BounceFit::touched(bool may_vibrate) const {
  return fit_touch(fitted_, {.earliest = std::max(as_double(begin_ + fewest),
                                                  2.0 * as_double(end_) - as_double(turn_)),
                             .latest = as_double(turn_),
                             .course_end = as_double(end_),
                             .scale = scale_,
                             .most_powers = std::min(most_powers, static_cast<int>(scale_) - 1),
                             .grain = grain_,
                             .may_vibrate = may_vibrate});
}

/// Those of the course and up to the sample `last`.
Points BounceFit::points(std::size_t last) const {
  const std::size_t block = (last + 1 - begin_ + most - 1) / most;
  Points points;
  points.per_point = as_double(block);
  for (std::size_t i = begin_; i + block <= last + 1; i += block) {
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

/// Where the motion, by such parabolas, comes back through `level`; a straight line bridges what is
/// lost.
std::optional<double> BounceFit::passes(double level, double half) const {
  double at = as_double(turn_), before = y_[turn_];
  for (std::size_t i = turn_; as_double(i) + half <= as_double(y_.size() - 1); ++i) {
    const auto here = place(as_double(i), half);
    if (!here) continue;
    if (here->value <= level && i == turn_) return at;
    if (here->value <= level)
      return at + (as_double(i) - at) * (before - level) / (before - here->value);
    at = as_double(i);
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

bool BounceFit::steady() const {
  constexpr double same = 0.3;
  const std::size_t middle = begin_ + (end_ - begin_) / 2;
  if (middle < begin_ + fewest) return false;
  const auto slope = [&](std::size_t first, std::size_t last) {
    const QuietFit line = fit_quiet(y_, first, last, 1, grain_, trace_.valid);
    return line.coefficients[1] / line.half;
  };
  const double early = slope(begin_, middle), late = slope(middle, end_);
  return std::abs(late - early) < same * std::abs(late);
}

/// Whether something else has bent the course, as where a bar is let go, and what follows is the
/// swing of a bar that touches nothing: it leaves no more than the touch does, by three standard
/// errors of the variances.
bool BounceFit::swings(const Bounce& bounce, const Touched& found) const {
  constexpr double same = 3.0;
  if (floor_ == 0 && bounce.touch <= bent_) return false;
  const double end = bounce.rebound ? bounce.rebound->to : bounce.back.value_or(as_double(turn_));
  const Points whole = points(static_cast<std::size_t>(end));
  const double swing =
      variance_beside_swing(whole, std::numbers::pi / (as_double(turn_) - bounce.touch));
  const double doubt =
      std::sqrt(2.0 / as_double(whole.at.size()) + 2.0 / as_double(fitted_.at.size()));
  return swing * whole.per_point < (1.0 + same * doubt) * found.variance * fitted_.per_point;
}

std::optional<Bounce> BounceFit::run() {
  if (!find_turn()) return std::nullopt;
  near_touch();
  scale_ = std::max(as_double(turn_ - end_), as_double(fewest));
  if (turn_ + 1 - begin_ < fewest + 1) return std::nullopt;
  fitted_ = points(turn_);
  scale_ = std::max(as_double(turn_) - touched(false).touch.value, as_double(fewest));
  const Touched found = touched(true);
  if (!(found.course.value > stands_out * found.course.error)) return std::nullopt;
  Bounce bounce{.sign = sign_,
                .touch = found.touch.value,
                .level = sign_ * found.level.value,
                .turn = turn_,
                .course = found.course,
                .approach = found.approach,
                .steady = steady()};
  const double half = std::max(2.0, end_part * (as_double(turn_) - bounce.touch));
  bounce.back = passes(found.level.value, half);
  if (bounce.back)
    bounce.rebound =
        rebound(found.level.value - beyond_doubt * found.level.error, *bounce.back - bounce.touch);
  return swings(bounce, found) ? std::nullopt : std::optional(bounce);
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
