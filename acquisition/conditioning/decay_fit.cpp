// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/decay_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "acquisition/conditioning/background.hpp"
#include "acquisition/conditioning/course_error.hpp"
#include "acquisition/conditioning/hum_frequency.hpp"
#include "acquisition/conditioning/samples.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::RemoveDecay;
using datasets::RemoveHum;
using datasets::TimeSpan;
using Eigen::Index;
using Eigen::VectorXd;

namespace {

/// Fits go through so many samples, or means of neighbours, some 100 times. A mean over 2⁻¹⁸ of the
/// time they span is off the curve by no more than 6e-9 of it, as T is at least a hundredth.
constexpr std::size_t most_points = std::size_t{1} << 18;

constexpr double unknown = std::numeric_limits<double>::infinity();

/// Samples of quiet stretches; times from the first of them.
struct Quiet {
  std::vector<double> times, values;  ///< [s], [the channel's unit]
  double origin = 0.0;                ///< [s]

  Index size() const { return static_cast<Index>(times.size()); }

  double span() const {
    const auto [first, last] = std::ranges::minmax(times);
    return last - first;
  }
};

Quiet quiet_samples(const Channel& channel, const RemoveDecay& decay) {
  const std::vector<double> values = sound_values(channel);
  const std::vector<std::uint8_t> marks = sound_marks(channel);
  std::size_t samples = 0;
  for (const TimeSpan& span : decay.quiet) samples += samples_in(channel, span).size();
  const std::size_t width = samples / (most_points + 1) + 1;
  Quiet quiet;
  quiet.origin = unknown;
  for (const TimeSpan& span : decay.quiet) {
    const IndexRange range = samples_in(channel, span);
    for (std::size_t from = range.begin; from < range.end; from += width) {
      double n = 0.0, time = 0.0, value = 0.0;
      for (std::size_t i = from; i < std::min(from + width, range.end); ++i) {
        if (!marks.empty() && marks[i] == 0) continue;
        n += 1.0;
        time += channel.clock.time(i);
        value += values[i];
        quiet.origin = std::min(quiet.origin, channel.clock.time(i));
      }
      if (n == 0.0) continue;
      quiet.times.push_back(time / n);
      quiet.values.push_back(value / n);
    }
  }
  if (quiet.times.size() < 16)
    throw std::invalid_argument(
        fmt::format("channel '{}' has {} samples at quiet times ({}); at least 16 are needed to "
                    "know how it decays",
                    channel.name, quiet.times.size(), text_of(decay.quiet)));
  for (double& time : quiet.times) time -= quiet.origin;
  return quiet;
}

/// Least squares of a constant, a fall and sinusoids.
class DecayFit {
 public:
  /// `hum`: the fundamental, with so many multiples [Hz]; 0: none.
  DecayFit(const Quiet& quiet, double hum, int multiples)
      : quiet_(quiet),
        times_(quiet.times.data(), quiet.size()),
        values_(quiet.values.data(), quiet.size()),
        hum_(hum),
        steady_(quiet.size(), 1 + (hum > 0.0 ? 2 * multiples : 0)) {
    steady_.col(0).setOnes();
    for (Index k = 1; k < steady_.cols(); k += 2) {
      const double omega = 2.0 * std::numbers::pi * hum * static_cast<double>((k + 1) / 2);
      steady_.col(k) = (omega * times_.array()).cos();
      steady_.col(k + 1) = (omega * times_.array()).sin();
    }
    squares_ = steady_.transpose() * steady_;
    right_ = steady_.transpose() * values_;
  }

  /// c and a for one T; tells the sum of squared residuals.
  double solve(double time) {
    // expm1 keeps the fall apart from the constant where it is slow
    const VectorXd fall = (-times_ / time).array().expm1();
    const Index last = steady_.cols();
    Eigen::MatrixXd normal(last + 1, last + 1);
    normal.topLeftCorner(last, last) = squares_;
    normal.row(last).head(last) = fall.transpose() * steady_;
    normal.col(last).head(last) = normal.row(last).head(last);
    normal(last, last) = fall.squaredNorm();
    VectorXd right(last + 1);
    right << right_, fall.dot(values_);
    const VectorXd solution = normal.ldlt().solve(right);
    const double amplitude = solution[last];
    residuals_ = values_ - steady_ * solution.head(last) - amplitude * fall;
    decay_ = {solution[0] - amplitude, amplitude, time, quiet_.origin, hum_};
    return residuals_.squaredNorm();
  }

  /// With the T of least squares: the best of a coarse scan, then Brent's method about it.
  void solve_for_time() {
    const double span = quiet_.span();
    const auto squares = [&](double log_time) { return solve(std::exp(log_time)); };
    const double lowest = std::log(span / 100.0), highest = std::log(30.0 * span);
    constexpr int points = 48;
    const double step = (highest - lowest) / points;
    double best = lowest, least = squares(lowest);
    for (int i = 1; i <= points; ++i) {
      const double here = squares(lowest + step * i);
      if (here >= least) continue;
      least = here;
      best = lowest + step * i;
    }
    const auto found = boost::math::tools::brent_find_minima(squares, std::max(lowest, best - step),
                                                             std::min(highest, best + step), 40);
    solve(std::exp(found.first));
  }

  const Decay& decay() const { return decay_; }

  /// `until`: the last time that is asked for, from the origin [s].
  DecayErrors errors(bool time_known, double until) const {
    const int terms = time_known ? 2 : 3;
    const Eigen::Matrix3d covariance = covariance_of(terms);
    const bool known = std::isfinite(covariance(0, 0));
    const auto of = [&](int k) {
      return known ? std::sqrt(std::max(0.0, covariance(k, k))) : unknown;
    };
    DecayErrors errors{.of_constant = of(0), .of_amplitude = of(1)};
    if (!time_known)
      errors.of_time =
          decay_.amplitude != 0.0 ? decay_.time * of(2) / std::abs(decay_.amplitude) : unknown;
    constexpr int places = 512;
    errors.at_most = known ? 0.0 : unknown;
    for (int i = 0; i <= places && known; ++i) {
      const Eigen::Vector3d row = slopes(until * i / places);
      errors.at_most =
          std::max(errors.at_most, std::sqrt(std::max(0.0, row.dot(covariance * row))));
    }
    if (known) errors.misfit = misfit(terms, until);
    errors.at_most = std::hypot(errors.at_most, errors.misfit);
    return errors;
  }

 private:
  /// By c, a and a ln T: whatever the unit.
  Eigen::Vector3d slopes(double t) const {
    const double fall = std::exp(-t / decay_.time);
    return {1.0, fall, fall * t / decay_.time};
  }

  /// What would show beside `terms` of c, a and a ln T that it is not one fall with this T: another
  /// T where that was stated, else a further fall, so many times as fast.
  double other(int terms, double faster, double t) const {
    return terms == 2 ? slopes(t)[2] : std::exp(-faster * t / decay_.time);
  }

  /// Columns of the `terms` and of the sinusoids.
  Eigen::MatrixXd rows_of(int terms) const {
    const Index sinusoids = steady_.cols() - 1;
    Eigen::MatrixXd rows(quiet_.size(), terms + sinusoids);
    for (Index i = 0; i < rows.rows(); ++i)
      rows.row(i).head(terms) = slopes(times_[i]).head(terms).transpose();
    rows.rightCols(sinusoids) = steady_.rightCols(sinusoids);
    return rows;
  }

  /// By how much the course changes, up to a time, where it may have what other() is; 0 where that
  /// does not stand out of the noise.
  double misfit(int terms, double until) const {
    double least = residuals_.squaredNorm(), found = 0.0;
    Eigen::MatrixXd rows = rows_of(terms);
    const Index last = rows.cols();
    rows.conservativeResize(Eigen::NoChange, last + 1);
    for (double faster = 3.0; faster < 50.0; faster *= 2.0) {
      for (Index i = 0; i < rows.rows(); ++i) rows(i, last) = other(terms, faster, times_[i]);
      const Eigen::FullPivLU<Eigen::MatrixXd> lu(rows.transpose() * rows);
      if (!lu.isInvertible()) continue;
      const VectorXd change = lu.solve(rows.transpose() * residuals_);
      const VectorXd left = residuals_ - rows * change;
      if (left.squaredNorm() >= least) continue;
      least = left.squaredNorm();
      found = 0.0;
      constexpr double stands_out = 5.0;  // standard errors
      const double variance = variance_of(left, rows.cols()) * lu.inverse()(last, last);
      if (change[last] * change[last] > stands_out * stands_out * variance)
        found = largest_of(terms, faster, change, until);
      if (terms == 2) break;
    }
    return found > grain_of(quiet_.values) ? found : 0.0;
  }

  /// Of what these terms, and in the last place other(), make of the course up to a time.
  double largest_of(int terms, double faster, const VectorXd& change, double until) const {
    constexpr int places = 512;
    double largest = 0.0;
    for (int i = 0; i <= places; ++i) {
      const double t = until * i / places;
      const double by_terms = slopes(t).head(terms).dot(change.head(terms));
      const double further = change[change.size() - 1] * other(terms, faster, t);
      largest = std::max(largest, std::abs(by_terms + further));
    }
    return largest;
  }

  /// Of a sample that knows the course as well as these residuals about `terms` do.
  double variance_of(const VectorXd& residuals, Index terms) const {
    QuietResiduals about;
    about.residuals.assign(residuals.begin(), residuals.end());
    about.scatter = std::sqrt(residuals.squaredNorm() /
                              static_cast<double>(std::max<Index>(1, residuals.size() - terms)));
    about.quantum = quantum_of(quiet_.values);
    const auto [first, last] = std::ranges::minmax(quiet_.times);
    about.rise = std::abs(decay_.amplitude *
                          (std::exp(-first / decay_.time) - std::exp(-last / decay_.time)));
    about.terms = static_cast<int>(terms);
    return slow_variance(std::move(about));
  }

  /// Of the first `terms` of c, a and a ln T; infinite where the data do not tell.
  Eigen::Matrix3d covariance_of(int terms) const {
    const Eigen::MatrixXd rows = rows_of(terms);
    const double variance = variance_of(residuals_, rows.cols());
    const Eigen::FullPivLU<Eigen::MatrixXd> lu(rows.transpose() * rows);
    if (!lu.isInvertible()) return Eigen::Matrix3d::Constant(unknown);
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    covariance.topLeftCorner(terms, terms) = variance * lu.inverse().topLeftCorner(terms, terms);
    return covariance;
  }

  const Quiet& quiet_;
  Eigen::Map<const VectorXd> times_, values_;
  double hum_;
  Eigen::MatrixXd steady_;   // a column for the constant and two for each multiple
  Eigen::MatrixXd squares_;  // of them
  VectorXd right_;
  Decay decay_;
  VectorXd residuals_;
};

/// Multiples that the samples can tell, as remove_hum() takes them.
int multiples_of(const RemoveHum& hum, double frequency, double interval) {
  int multiples = std::max(hum.harmonics, 0);
  while (multiples > 0 && !(4.0 * multiples * frequency * interval < 1.0)) --multiples;
  return multiples;
}

/// The mains in what a decay leaves of a channel [Hz].
double frequency_beside(const Channel& channel, const Decay& decay, const RemoveHum& hum) {
  std::vector<double> values = sound_values(channel);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] -= decay.at(channel.clock.time(i));
  return find_quiet_hum(channel, hum, values).frequency;
}

}  // namespace

double Decay::at(double t) const {
  return t >= origin ? constant + amplitude * std::exp(-(t - origin) / time) : 0.0;
}

FittedDecay fit_decay(const Channel& channel, const RemoveDecay& wanted, const RemoveHum* hum) {
  const Quiet quiet = quiet_samples(channel, wanted);
  if (wanted.time_constant && !(*wanted.time_constant > 0.0))
    throw std::invalid_argument(
        fmt::format("a time constant of {:g} s is not positive", *wanted.time_constant));
  const double until = channel.clock.time(channel.size() - 1) - quiet.origin;
  const bool time_known = wanted.time_constant.has_value();
  const auto fitted = [&](double frequency, int multiples) {
    DecayFit fit(quiet, frequency, multiples);
    if (time_known)
      fit.solve(*wanted.time_constant);
    else
      fit.solve_for_time();
    return FittedDecay{fit.decay(), fit.errors(time_known, until)};
  };
  const double mains = hum ? hum->frequency.value_or(default_mains) : 0.0;
  const int multiples = hum ? multiples_of(*hum, mains, channel.clock.interval) : 0;
  if (multiples == 0 || !(quiet.span() * mains >= 1.0)) return fitted(0.0, 0);
  return fitted(frequency_beside(channel, fitted(mains, multiples).decay, *hum), multiples);
}

}  // namespace impactrig::acquisition
