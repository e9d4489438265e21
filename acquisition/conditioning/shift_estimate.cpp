// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/shift_estimate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "acquisition/conditioning/background.hpp"
#include "datasets/band_limited.hpp"
#include "datasets/number_text.hpp"

namespace impactrig::acquisition {

using datasets::BandLimited;
using datasets::TimeSpan;

namespace {

constexpr double most_steps = 4096.0;  ///< over the window; longer ones are thinned
constexpr double few_steps = 24.0;     ///< over the window: 8 over a pulse between rests as long
constexpr double no_likeness = 0.5;    ///< left over, of what follows
constexpr std::ptrdiff_t unknowns = 4;
constexpr std::ptrdiff_t least_counted = 2 * unknowns;
constexpr double slope_step = 0.25;  ///< to either side, for differences
constexpr double grace = 1e-6;       ///< of a sample: times are rounded

using Marks = std::vector<std::uint8_t>;

/// The kernel's reach to either side.
const auto reach =
    static_cast<std::ptrdiff_t>(std::ceil(BandLimited::crossings / BandLimited::cutoff));

/// Of a difference that leaves what is near half of the rate.
constexpr std::ptrdiff_t order = 8;

/// A signal at even steps; beyond the record's ends it stays as it is there, and does not count.
struct Steps {
  std::vector<double> values;
  Marks sound;
};

Steps read_at(const Trace& trace, double start, double step, std::ptrdiff_t count) {
  const BandLimited signal(trace.values, std::max(1.0, step / trace.interval));
  const double last = static_cast<double>(trace.values.size()) - 1.0;
  Steps steps;
  for (std::ptrdiff_t k = 0; k < count; ++k) {
    const double index = trace.index(start + step * static_cast<double>(k));
    steps.values.push_back(signal(std::clamp(index, 0.0, last)));
    steps.sound.push_back(sound_at(trace, index) ? 1 : 0);
  }
  return steps;
}

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

/// Less the straight line through the values that count; 0 where they do not.
std::vector<double> without_line(std::vector<double> values, const Marks& counts) {
  double n = 0.0, sk = 0.0, skk = 0.0, sv = 0.0, skv = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (counts[i] == 0) continue;
    const double k = static_cast<double>(i);
    n += 1.0;
    sk += k;
    skk += k * k;
    sv += values[i];
    skv += k * values[i];
  }
  const double slope = (n * skv - sk * sv) / (n * skk - sk * sk);
  const double level = (sv - slope * sk) / n;
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = counts[i] == 0 ? 0.0 : values[i] - level - slope * static_cast<double>(i);
  return values;
}

/// Σ v, Σ k v and Σ v² of any stretch, k from its begin; of the values less their mean, so that
/// little is lost in differences.
class Sums {
 public:
  struct Part {
    double sum, ramp, square;
  };

  explicit Sums(const std::vector<double>& values) : upto_{{0.0, 0.0, 0.0}} {
    const double mean = std::accumulate(values.begin(), values.end(), 0.0) /
                        static_cast<double>(std::max<std::size_t>(values.size(), 1));
    for (std::size_t k = 0; k < values.size(); ++k) {
      const double value = values[k] - mean;
      const Part& last = upto_.back();
      upto_.push_back({last.sum + value, last.ramp + static_cast<double>(k) * value,
                       last.square + value * value});
    }
  }

  Part over(std::size_t begin, std::size_t end) const {
    const Part &from = upto_[begin], &to = upto_[end];
    const double sum = to.sum - from.sum;
    return {sum, to.ramp - from.ramp - static_cast<double>(begin) * sum, to.square - from.square};
  }

 private:
  std::vector<Part> upto_;
};

/// At steps of one width.
struct Found {
  ShiftEstimate estimate;
  double open = 0.0;  ///< standard uncertainty by what lies beyond half of the rate [s]
};

/// Reference and signal at the same steps.
class Comparison {
 public:
  Comparison(const Trace& reference, const Trace& signal, const TimeSpan& window, double range,
             double step)
      : step_(step),
        most_lags_(static_cast<std::ptrdiff_t>(std::ceil(range / step)) + 1),
        margin_(most_lags_ + reach + order + 1) {
    const double first = std::ceil(reference.index(window.begin) - grace);
    const double start = reference.time(first);
    size_ = static_cast<std::ptrdiff_t>(std::floor((window.end - start) / step + grace)) + 1;
    if (size_ < 1) size_ = 0;
    const double before = start - step * static_cast<double>(margin_);
    x_ = read_at(reference, before, step, size_ + 2 * margin_);
    y_ = read_at(signal, before, step, size_ + 2 * margin_);
  }

  /// None, and why, where the two have no likeness.
  std::optional<Found> estimate(double range, std::string& reason) const {
    if (size_ < least_counted) {
      reason = fmt::format("{} samples are too few", size_);
      return std::nullopt;
    }
    const std::ptrdiff_t lag = best_lag();
    const Marks counts = counting_at(lag);
    const auto counted = std::ranges::count(counts, 1);
    if (counted < std::max(least_counted, size_ / 3)) {
      reason = fmt::format("{} of {} samples are sound in both", counted, size_);
      return std::nullopt;
    }
    return refined(lag, counts, range, reason);
  }

 private:
  std::vector<double> part(const std::vector<double>& values, std::ptrdiff_t lag) const {
    const auto begin = values.begin() + margin_ + lag;
    return {begin, begin + size_};
  }

  /// Between steps, on the steps of the reference.
  std::vector<double> moved(const Steps& steps, double shift) const {
    const BandLimited signal(steps.values, 1.0);
    std::vector<double> values;
    for (std::ptrdiff_t k = 0; k < size_; ++k)
      values.push_back(signal(static_cast<double>(k + margin_) + shift));
    return values;
  }

  std::vector<double> slopes(const Steps& steps, double shift) const {
    std::vector<double> values = moved(steps, shift + slope_step);
    const std::vector<double> before = moved(steps, shift - slope_step);
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = (values[i] - before[i]) / (2.0 * slope_step);
    return values;
  }

  /// In whole steps, where the two are most alike, a line taken off each: of x once, and of y's
  /// square by sums that know every lag's.
  std::ptrdiff_t best_lag() const {
    const auto n = static_cast<double>(size_);
    const std::vector<double> x =
        without_line(part(x_.values, 0), Marks(static_cast<std::size_t>(size_), 1));
    const Sums sums(y_.values);
    std::ptrdiff_t best = 0;
    double most = -INFINITY;
    for (std::ptrdiff_t lag = -most_lags_; lag <= most_lags_; ++lag) {
      const auto begin = static_cast<std::size_t>(margin_ + lag);
      const Sums::Part y = sums.over(begin, begin + static_cast<std::size_t>(size_));
      const double level = y.sum / n, about = y.ramp - 0.5 * (n - 1.0) * y.sum;
      const double square = y.square - y.sum * level - 12.0 * about * about / (n * (n * n - 1.0));
      const double xy = std::inner_product(
          x.begin(), x.end(), y_.values.begin() + static_cast<std::ptrdiff_t>(begin), 0.0);
      const double alike = xy / std::sqrt(square);
      if (!(alike > most)) continue;
      most = alike;
      best = lag;
    }
    return best;
  }

  Marks counting_at(std::ptrdiff_t lag) const {
    Marks counts(static_cast<std::size_t>(size_), 0);
    for (std::ptrdiff_t k = 0; k < size_; ++k) {
      const auto i = static_cast<std::size_t>(k + margin_);
      const auto j = static_cast<std::size_t>(k + margin_ + lag);
      counts[static_cast<std::size_t>(k)] = x_.sound[i] != 0 && y_.sound[j] != 0 ? 1 : 0;
    }
    return counts;
  }

  std::optional<Found> refined(std::ptrdiff_t lag, const Marks& counts, double range,
                               std::string& reason) const {
    const std::vector<double> x = without_line(moved(x_, 0.0), counts);
    const double xx = dot(x, x);
    const auto left_over = [&](double part_of_step) {  // of y's square
      const std::vector<double> y =
          without_line(moved(y_, static_cast<double>(lag) + part_of_step), counts);
      const double xy = dot(x, y);
      return std::max(0.0, 1.0 - xy * std::abs(xy) / (xx * dot(y, y)));
    };
    const auto [fraction, least] = boost::math::tools::brent_find_minima(left_over, -1.0, 1.0, 20);
    const double shift = static_cast<double>(lag) + fraction;
    const double misfit = least < 1.0 ? std::sqrt(least / (1.0 - least)) : INFINITY;
    if (!(misfit < no_likeness)) {
      reason = fmt::format("what is left over is {} of what follows", datasets::figures(misfit, 2));
      return std::nullopt;
    }
    if (!(std::abs(shift) * step_ < range)) {
      reason = fmt::format("the best shift is at the edge of +-{:.3g} s", range);
      return std::nullopt;
    }
    const auto [error, open] = uncertainties_at(shift, x, counts);
    if (std::isfinite(error)) return Found{{shift * step_, error * step_}, open * step_};
    reason = "its noise hides how steep it is";
    return std::nullopt;
  }

  /// By noise, and by what lies beyond half of the rate, in steps.
  std::pair<double, double> uncertainties_at(double shift, const std::vector<double>& x,
                                             const Marks& counts) const {
    std::vector<double> residuals = without_line(moved(y_, shift), counts);
    const double xx = dot(x, x), a = dot(x, residuals) / xx;
    const auto without_x = [&](std::vector<double>&& values) {
      std::vector<double> rest = without_line(std::move(values), counts);
      const double share = dot(x, rest) / xx;
      for (std::size_t i = 0; i < rest.size(); ++i) rest[i] -= share * x[i];
      return rest;
    };
    const std::vector<double> dx = without_x(slopes(x_, 0.0)), dy = without_x(slopes(y_, shift));
    for (std::size_t i = 0; i < residuals.size(); ++i) residuals[i] -= a * x[i];
    const double steepness = sure_steepness(a, dx, dy);
    if (!(steepness > 0.0)) return {INFINITY, 0.0};
    const double of_noise = std::max(0.0, dot(dy, dy) - steepness);
    const double freedom = static_cast<double>(std::ranges::count(counts, 1) - unknowns);
    const double variance =
        dot(residuals, residuals) / freedom * correlation_time(residuals, counts);
    return {std::sqrt(variance / steepness * (1.0 + 0.5 * of_noise / steepness)),
            std::sqrt(2.0 * near_half_of_rate(shift, a, counts) / steepness)};
  }

  /// The square of what both have near half of the rate, less two standard errors of what noise
  /// makes of it. As much lies beyond, at least, and looks like something below.
  double near_half_of_rate(double shift, double a, const Marks& counts) const {
    const std::vector<double> x = differences(x_, 0.0, counts), y = differences(y_, shift, counts);
    const double noise = std::sqrt(dot(x, x) * dot(y, y) / static_cast<double>(size_));
    return std::max(0.0, a * dot(x, y) - 2.0 * std::abs(a) * noise);
  }

  /// The eighth differences over 2⁸: sin⁸(π f/f_s) of what has the frequency f.
  std::vector<double> differences(const Steps& steps, double shift, const Marks& counts) const {
    std::vector<double> sum(static_cast<std::size_t>(size_), 0.0);
    double weight = std::pow(0.5, order);
    for (std::ptrdiff_t k = 0; k <= order; ++k) {
      const std::vector<double> values = moved(steps, shift + static_cast<double>(k - order / 2));
      for (std::size_t i = 0; i < sum.size(); ++i)
        if (counts[i] != 0) sum[i] += weight * values[i];
      weight *= -static_cast<double>(order - k) / static_cast<double>(k + 1);
    }
    return sum;
  }

  /// S = a Σ x' y' less two standard errors of what noise makes of it: among several S with noise
  /// of their own the largest would be too large.
  double sure_steepness(double a, const std::vector<double>& dx,
                        const std::vector<double>& dy) const {
    const double steepness = a * dot(dx, dy);
    const double of_x = std::max(0.0, a * a * dot(dx, dx) - steepness);
    const double of_y = std::max(0.0, dot(dy, dy) - steepness);
    const double squares = std::max(0.0, steepness) * (of_x + of_y) + of_x * of_y;
    return steepness - 2.0 * std::sqrt(squares / static_cast<double>(size_));
  }

  double step_;
  std::ptrdiff_t most_lags_, margin_, size_ = 0;
  Steps x_, y_;  ///< of the window and a margin to either side
};

}  // namespace

bool sound_at(const Trace& trace, double index) {
  const double last = static_cast<double>(trace.values.size()) - 1.0;
  if (index < -grace || index > last + grace) return false;
  const auto below = static_cast<std::size_t>(std::max(0.0, std::floor(index)));
  const std::size_t end = trace.values.size() - 1;
  return trace.is_valid(std::min(below, end)) && trace.is_valid(std::min(below + 1, end));
}

ShiftEstimate estimate_shift(const Trace& reference, const Trace& signal, const TimeSpan& window,
                             double range) {
  const double length = window.end - window.begin;
  const double interval = std::max(reference.interval, signal.interval);
  double step = std::max(interval, length / most_steps);
  const bool thinned = step > interval;
  std::optional<Found> best;
  double open = 0.0;
  std::string reason;
  for (bool first = true; first || length >= few_steps * step; first = false, step *= 2.0) {
    const auto found = Comparison(reference, signal, window, range, step).estimate(range, reason);
    if (found && first && !thinned) open = found->open;
    if (found && (!best || found->estimate.uncertainty < best->estimate.uncertainty)) best = found;
  }
  if (!best) throw std::invalid_argument(reason);
  return {best->estimate.value, std::hypot(best->estimate.uncertainty, open)};
}

}  // namespace impactrig::acquisition
