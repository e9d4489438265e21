// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/contact_phases.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

namespace impactrig::fitting {
namespace {

constexpr double flank_sigmas = 5.0;    // where a flank begins to count, in standard deviations
constexpr double flank_height = 4.0;    // where it ends, over where it begins
constexpr double rise_part = 0.005;     // of the peak: the first flank begins there at least
constexpr double fall_part = 0.01;      // the last, which is often flat
constexpr double smoothed_part = 0.02;  // of the contact: half a mean for the last flank
constexpr double speed_part = 0.03;     // of the contact: half a parabola for a speed
constexpr double near_part = 0.02;    // of the contact: longest flank, and kept free beside events
constexpr double search_part = 0.15;  // of the contact: how far off the hints may be
constexpr double after_contacts = 3.0;  // contact durations over which vibration is averaged

/// A running integral by trapezoids, at any instant.
class Integral {
 public:
  Integral(std::span<const double> values, double start, double interval)
      : values_(values),
        start_(start),
        interval_(interval),
        sums_(values.size(), 0.0) {
    for (std::size_t i = 1; i < values.size(); ++i)
      sums_[i] = sums_[i - 1] + 0.5 * interval * (values[i - 1] + values[i]);
  }

  double at(double t) const {
    const double place =
        std::clamp((t - start_) / interval_, 0.0, static_cast<double>(values_.size() - 1));
    const auto i = std::min(static_cast<std::size_t>(place), values_.size() - 2);
    const double x = place - static_cast<double>(i);
    return sums_[i] + interval_ * x * (values_[i] + 0.5 * x * (values_[i + 1] - values_[i]));
  }

  double between(double from, double to) const { return at(to) - at(from); }

 private:
  std::span<const double> values_;
  double start_, interval_;
  std::vector<double> sums_;
};

/// All alike, or (1 − |u|³)³ with u from -1 to 1 over the window: then a small shift of the window
/// changes little, whatever the noise.
enum class Weights { even, tapered };

double tapered(double t, double from, double to) {
  const double u = std::abs(2.0 * t - from - to) / (to - from);
  return u < 1.0 ? std::pow(1.0 - u * u * u, 3) : 0.0;
}

/// Polynomial of least squares through samples, about an instant.
Eigen::VectorXd polynomial(std::span<const double> values, const ContactRecord& record, double from,
                           double to, double about, int degree, Weights weights = Weights::even) {
  const auto last = static_cast<std::ptrdiff_t>(values.size()) - 1;
  const auto index = [&](double t) { return (t - record.start) / record.interval; };
  const auto first = std::clamp<std::ptrdiff_t>(
      static_cast<std::ptrdiff_t>(std::ceil(index(from) - 1e-9)), 0, last);
  const auto end = std::clamp<std::ptrdiff_t>(
      static_cast<std::ptrdiff_t>(std::floor(index(to) + 1e-9)), 0, last);
  const double scale = std::max(to - from, record.interval);
  if (end - first < degree) return Eigen::VectorXd::Constant(degree + 1, NAN);
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(degree + 1, degree + 1);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(degree + 1), powers(degree + 1);
  for (std::ptrdiff_t i = first; i <= end; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double x = (record.time(k) - about) / scale;
    powers[0] = 1.0;
    for (int d = 1; d <= degree; ++d) powers[d] = powers[d - 1] * x;
    const double weight = weights == Weights::tapered ? tapered(record.time(k), from, to) : 1.0;
    normal += weight * powers * powers.transpose();
    right += weight * values[k] * powers;
  }
  Eigen::VectorXd solution = normal.ldlt().solve(right);
  for (int d = 1; d <= degree; ++d) solution[d] /= std::pow(scale, d);
  return solution;
}

/// Where a flank begins, continued to zero, and how sure that is.
struct Flank {
  double time, error;
};

class PhaseSearch {
 public:
  PhaseSearch(const ContactRecord& record, double begin, double end)
      : record_(record),
        begin_(begin),
        end_(end),
        duration_(end - begin),
        near_(std::max(near_part * duration_, 2.0 * record.interval)),
        half_(std::max(speed_part * duration_, 3.0 * record.interval)),
        force_(record.force, record.start, record.interval),
        speed_(record.velocity, record.start, record.interval) {}

  ContactPhases run(double touch_shift, double separation_shift);

 private:
  std::size_t index(double t) const {
    return static_cast<std::size_t>(std::clamp((t - record_.start) / record_.interval, 0.0,
                                               static_cast<double>(record_.force.size() - 1)));
  }

  double level_of(const std::vector<double>& force, double part) const;
  std::optional<Flank> flank(const std::vector<double>& force, double level, std::size_t outside,
                             int step, std::size_t limit) const;
  std::size_t between_contacts(const std::vector<double>& force) const;
  double deepest(double touch, double separation) const;
  void approach_and_rebound(ContactPhases& phases) const;
  void average_rebound(ContactPhases& phases) const;

  const ContactRecord& record_;
  double begin_, end_, duration_, near_, half_;
  Integral force_, speed_;
  double level_ = 0.0;
};

/// A part of the peak, or what noise before touch does not reach.
double PhaseSearch::level_of(const std::vector<double>& force, double part) const {
  const std::size_t from = index(begin_ - search_part * duration_), to = index(end_);
  double peak = 0.0, sum = 0.0, squares = 0.0;
  for (std::size_t i = from; i <= to; ++i) peak = std::max(peak, force[i]);
  for (std::size_t i = 0; i < from; ++i) {
    sum += force[i];
    squares += force[i] * force[i];
  }
  const double n = std::max<double>(1.0, static_cast<double>(from));
  const double variance = std::max(0.0, squares / n - sum * sum / (n * n));
  return std::max(part * peak, flank_sigmas * std::sqrt(variance));
}

/// From a sample outside the contact inwards (step 1 or -1) until the force is above the level.
std::optional<Flank> PhaseSearch::flank(const std::vector<double>& force, double level,
                                        std::size_t outside, int step, std::size_t limit) const {
  const auto next = [step](std::size_t i) {
    return static_cast<std::size_t>(static_cast<std::ptrdiff_t>(i) + step);
  };
  std::size_t i = outside;
  while (i != limit && !(force[i] > level)) i = next(i);
  if (i == limit) return std::nullopt;
  std::size_t inner = i;
  while (inner != limit && force[inner] < flank_height * level &&
         std::abs(record_.time(next(inner)) - record_.time(i)) <= near_)
    inner = next(inner);
  const double t = record_.time(i), t_inner = record_.time(inner);
  // A flank within one sample: the last one below the level helps.
  const double outer = inner == i ? t - step * record_.interval : t;
  const Eigen::VectorXd line =
      polynomial(force, record_, std::min(outer, t_inner), std::max(outer, t_inner), outer, 1);
  if (!(line[1] * step > 0.0)) return Flank{t, record_.interval};
  const double far = t - step * search_part * duration_;
  const double zero = outer - line[0] / line[1];
  const double bounded = step > 0 ? std::max(zero, far) : std::min(zero, far);
  return Flank{bounded, std::hypot(std::abs(bounded - t) / std::sqrt(3.0),
                                   record_.interval / std::sqrt(3.0))};
}

/// The greatest of the penetrations at which the speed crosses zero downwards.
double PhaseSearch::deepest(double touch, double separation) const {
  const std::size_t from = index(touch) + 1, to = index(separation);
  std::size_t best = from;
  double most = -INFINITY;
  for (std::size_t i = from; i <= to; ++i) {
    const double depth = speed_.at(record_.time(i));
    if (depth <= most) continue;
    most = depth;
    best = i;
  }
  if (best <= from || best >= to) return NAN;  // never turns round within the contact
  const double about = record_.time(best);
  const Eigen::VectorXd c = polynomial(record_.velocity, record_, about - half_, about + half_,
                                       about, 2, Weights::tapered);
  if (!(c[1] < 0.0)) return about;
  const double root = c[1] * c[1] - 4.0 * c[0] * c[2];
  const double shift = root >= 0.0 ? -2.0 * c[0] / (c[1] - std::sqrt(root)) : -c[0] / c[1];
  return std::abs(shift) <= half_ ? about + shift : about;
}

void PhaseSearch::approach_and_rebound(ContactPhases& phases) const {
  const Eigen::VectorXd before =
      polynomial(record_.velocity, record_, record_.start, phases.touch - near_, phases.touch, 1);
  phases.approach = before[0];
  const double t = phases.separation;
  phases.rebound =
      -polynomial(record_.velocity, record_, t - half_, t + half_, t, 2, Weights::tapered)[0];
}

/// The mean speed after separation up to the next contact, and its error: the spread over the root
/// of half the crossings of the mean, as many as there were swings.
void PhaseSearch::average_rebound(ContactPhases& phases) const {
  const std::size_t from = index(phases.separation + near_) + 1;
  std::size_t to =
      std::min(index(phases.separation + after_contacts * duration_), record_.force.size() - 1);
  for (std::size_t i = from; i <= to; ++i)
    if (record_.force[i] > 2.0 * level_) to = i - 1;  // next contact
  if (to < from + 8) return;
  const double n = static_cast<double>(to - from + 1);
  double mean = 0.0, squares = 0.0;
  for (std::size_t i = from; i <= to; ++i) mean += record_.velocity[i] / n;
  for (std::size_t i = from; i <= to; ++i)
    squares += (record_.velocity[i] - mean) * (record_.velocity[i] - mean) / n;
  int crossings = 0;
  const double hysteresis = 0.5 * std::sqrt(squares);
  int side = 0;
  for (std::size_t i = from; i <= to; ++i) {
    const double off = record_.velocity[i] - mean;
    if (std::abs(off) < hysteresis) continue;
    const int here = off > 0.0 ? 1 : -1;
    if (side != 0 && here != side) ++crossings;
    side = here;
  }
  phases.smoothed = -mean;
  phases.smoothed_error = std::sqrt(squares / (1.0 + 0.5 * crossings));
}

/// Where the force is least about the contact's end: the next contact may follow soon.
std::size_t PhaseSearch::between_contacts(const std::vector<double>& force) const {
  const std::size_t from = index(end_ - search_part * duration_);
  const std::size_t to = index(end_ + search_part * duration_);
  std::size_t least = to;
  for (std::size_t i = to + 1; i-- > from;)
    if (force[i] < force[least]) least = i;
  return least;
}

ContactPhases PhaseSearch::run(double touch_shift, double separation_shift) {
  ContactPhases phases;
  level_ = level_of(record_.force, rise_part);
  const auto half = static_cast<std::size_t>(smoothed_part * duration_ / record_.interval);
  const std::vector<double> smoothed = running_means(record_.force, half);
  const std::size_t first = index(begin_ - search_part * duration_);
  const std::size_t last = between_contacts(smoothed);
  const double low = level_of(smoothed, fall_part);
  const auto rise = flank(record_.force, level_, first, 1, last);
  const auto fall = smoothed[last] > low ? std::nullopt : flank(smoothed, low, last, -1, first);
  if (!rise || !fall || !(rise->time < fall->time)) return phases;
  phases.touch = rise->time + touch_shift;
  phases.touch_error = rise->error;
  phases.separation = fall->time + separation_shift;
  phases.separation_error = fall->error;
  approach_and_rebound(phases);
  average_rebound(phases);
  phases.deepest = deepest(phases.touch, phases.separation);
  phases.drift = speed_.between(phases.touch, phases.separation);
  if (!std::isfinite(phases.deepest)) return phases;
  std::vector<double> power(record_.force.size());
  for (std::size_t i = 0; i < power.size(); ++i) power[i] = record_.force[i] * record_.velocity[i];
  const Integral work(power, record_.start, record_.interval);
  phases.impulse_in = force_.between(phases.touch, phases.deepest);
  phases.impulse_out = force_.between(phases.deepest, phases.separation);
  phases.work_in = work.between(phases.touch, phases.deepest);
  phases.work_out = -work.between(phases.deepest, phases.separation);
  phases.depth = speed_.between(phases.touch, phases.deepest);
  return phases;
}

}  // namespace

ContactPhases contact_phases(const ContactRecord& record, double begin, double end,
                             double touch_shift, double separation_shift) {
  if (record.force.size() < 16 || record.velocity.size() != record.force.size() || !(end > begin))
    return {};
  return PhaseSearch(record, begin, end).run(touch_shift, separation_shift);
}

std::vector<double> running_means(const std::vector<double>& values, std::size_t m) {
  std::vector<double> out = values;
  double sum = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    sum += values[i];
    if (i < 2 * m) continue;
    out[i - m] = sum / static_cast<double>(2 * m + 1);
    sum -= values[i - 2 * m];
  }
  return out;
}

std::vector<double> penetration_of(const ContactRecord& record, double touch) {
  const Integral speed(record.velocity, record.start, record.interval);
  std::vector<double> depth(record.velocity.size());
  for (std::size_t i = 0; i < depth.size(); ++i) depth[i] = speed.between(touch, record.time(i));
  return depth;
}

}  // namespace impactrig::fitting
