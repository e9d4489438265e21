// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/decay.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

#include "acquisition/conditioning/background.hpp"
#include "acquisition/conditioning/baseline.hpp"
#include "acquisition/conditioning/course_error.hpp"
#include "acquisition/conditioning/samples.hpp"
#include "datasets/number_text.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::Edit;

namespace {

/// Fits go through so many samples, or means of neighbours, some 100 times. A mean over 2⁻¹⁸ of the
/// time they span is off the curve by no more than 6e-9 of it, as T is at least a hundredth.
constexpr std::size_t most_points = std::size_t{1} << 18;

/// Samples of quiet stretches; times from the first of them.
struct Quiet {
  std::vector<double> times, values;  ///< [s], [the channel's unit]
  double origin = 0.0;                ///< [s]
};

Quiet quiet_samples(const Channel& channel, const datasets::RemoveDecay& decay) {
  const std::vector<double> values = sound_values(channel);
  const std::vector<std::uint8_t> marks = sound_marks(channel);
  std::size_t samples = 0;
  for (const TimeSpan& span : decay.quiet) samples += samples_in(channel, span).size();
  const std::size_t width = samples / (most_points + 1) + 1;
  Quiet quiet;
  quiet.origin = std::numeric_limits<double>::infinity();
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

/// c and a of c + a exp(-t/T) for one T.
struct Decay {
  double constant = 0.0, amplitude = 0.0, time = 0.0;
  double squares = 0.0;  ///< sum of squared residuals

  double at(double t) const { return constant + amplitude * std::exp(-t / time); }
};

Decay fitted(const Quiet& quiet, double time) {
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < quiet.times.size(); ++i) {
    // expm1 keeps the two columns apart where the decay is slow.
    const Eigen::Vector2d row(1.0, std::expm1(-quiet.times[i] / time));
    normal += row * row.transpose();
    right += row * quiet.values[i];
  }
  const Eigen::Vector2d solution = normal.ldlt().solve(right);
  Decay decay{solution[0] - solution[1], solution[1], time, 0.0};
  for (std::size_t i = 0; i < quiet.times.size(); ++i) {
    const double residual = quiet.values[i] - decay.at(quiet.times[i]);
    decay.squares += residual * residual;
  }
  return decay;
}

/// The T of least squares: the best of a coarse scan, then Brent's method about it.
Decay with_best_time(const Quiet& quiet, double span) {
  const auto squares = [&](double log_time) { return fitted(quiet, std::exp(log_time)).squares; };
  const double lowest = std::log(span / 100.0), highest = std::log(30.0 * span);
  constexpr int points = 48;
  const double step = (highest - lowest) / points;
  double best = lowest;
  for (int i = 1; i <= points; ++i)
    if (squares(lowest + step * i) < squares(best)) best = lowest + step * i;
  const auto [log_time, least] = boost::math::tools::brent_find_minima(
      squares, std::max(lowest, best - step), std::min(highest, best + step), 40);
  return fitted(quiet, std::exp(log_time));
}

/// What a fitted decay is uncertain by. Of c, a and a ln T: whatever the unit.
class DecayError {
 public:
  /// `time_known`: T was stated.
  DecayError(const Quiet& quiet, const Decay& decay, bool time_known)
      : decay_(decay),
        terms_(time_known ? 2 : 3) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    QuietResiduals about;
    about.residuals.reserve(quiet.times.size());
    for (std::size_t i = 0; i < quiet.times.size(); ++i) {
      const Eigen::Vector3d row = slopes(quiet.times[i]);
      normal += row * row.transpose();
      about.residuals.push_back(quiet.values[i] - decay.at(quiet.times[i]));
    }
    const auto [first, last] = std::ranges::minmax(quiet.times);
    about.scatter = std::sqrt(decay.squares / (static_cast<double>(quiet.times.size()) - terms_));
    about.quantum = quantum_of(quiet.values);
    about.rise = std::abs(decay.at(first) - decay.at(last));
    about.terms = terms_;
    const double variance = slow_variance(std::move(about));
    const Eigen::FullPivLU<Eigen::MatrixXd> lu(normal.topLeftCorner(terms_, terms_));
    known_ = lu.isInvertible();
    if (known_) covariance_.topLeftCorner(terms_, terms_) = variance * lu.inverse();
  }

  double of_constant() const { return of(0); }

  double of_amplitude() const { return of(1); }

  /// Of T [s].
  double of_time() const {
    return decay_.amplitude != 0.0 ? decay_.time * of(2) / std::abs(decay_.amplitude) : unknown;
  }

  /// Of the decay, at most from its first quiet sample to so much later [s].
  double at_most(double until) const {
    constexpr int places = 512;
    double most = known_ ? 0.0 : unknown;
    for (int i = 0; i <= places && known_; ++i) {
      const Eigen::Vector3d row = slopes(until * i / places);
      most = std::max(most, std::sqrt(std::max(0.0, row.dot(covariance_ * row))));
    }
    return most;
  }

 private:
  static constexpr double unknown = std::numeric_limits<double>::infinity();

  Eigen::Vector3d slopes(double t) const {
    const double fall = std::exp(-t / decay_.time);
    return {1.0, fall, fall * t / decay_.time};
  }

  double of(int k) const { return known_ ? std::sqrt(std::max(0.0, covariance_(k, k))) : unknown; }

  const Decay& decay_;
  int terms_;
  bool known_ = false;
  Eigen::Matrix3d covariance_ = Eigen::Matrix3d::Zero();
};

/// What was fitted, and what that is uncertain by. Refuses where the data do not tell T.
void state(const Channel& channel, const Quiet& quiet, const Decay& decay, bool time_known,
           Edit& edit) {
  const DecayError error(quiet, decay, time_known);
  const auto text = [](double value) { return datasets::figures(value, 2); };
  if (time_known) {
    edit.parameters["time constant"] = fmt::format("{:.12g} s, stated", decay.time);
  } else {
    const double uncertainty = error.of_time();
    if (!(uncertainty < 0.5 * decay.time))
      throw std::invalid_argument(fmt::format(
          "the quiet samples of channel '{}' do not tell the time constant of a decay "
          "({:.3g} s, uncertain by {:.3g} s); state time_constant, or take a straight line off "
          "(step = \"drift\")",
          channel.name, decay.time, uncertainty));
    edit.parameters["time constant"] = fmt::format("{:.6g} s, from the data", decay.time);
    edit.parameters["uncertainty"] = fmt::format("{:.3g} s", uncertainty);
  }
  edit.parameters["offset"] = fmt::format("{:.6g} {}, uncertain by {} {}", decay.constant,
                                          channel.unit, text(error.of_constant()), channel.unit);
  edit.parameters["amplitude"] =
      fmt::format("{:.6g} {} at {:.9g} s, uncertain by {} {}", decay.amplitude, channel.unit,
                  quiet.origin, text(error.of_amplitude()), channel.unit);
  const double until = channel.clock.time(channel.size() - 1) - quiet.origin;
  edit.parameters["uncertainty of what came off"] =
      fmt::format("{} {} at most", text(error.at_most(until)), channel.unit);
}

}  // namespace

Edit remove_decay(Channel& channel, const datasets::RemoveDecay& wanted) {
  const Quiet quiet = quiet_samples(channel, wanted);
  double span = 0.0;
  for (const double time : quiet.times) span = std::max(span, time);
  Edit edit{"remove decay", channel.name, {{"quiet", text_of(wanted.quiet)}}};
  if (wanted.time_constant && !(*wanted.time_constant > 0.0))
    throw std::invalid_argument(
        fmt::format("a time constant of {:g} s is not positive", *wanted.time_constant));
  const Decay decay =
      wanted.time_constant ? fitted(quiet, *wanted.time_constant) : with_best_time(quiet, span);
  state(channel, quiet, decay, wanted.time_constant.has_value(), edit);
  std::vector<double> values = channel.values();
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double time = channel.clock.time(i) - quiet.origin;
    if (time >= 0.0) values[i] -= decay.at(time);  // before, it grows without bound
  }
  replace_values(channel, std::move(values));
  return edit;
}

namespace {

/// Standard error of the sum of `values` where lines bridge what is not valid, in their unit: of
/// noise, whose two samples beside a gap of n stand for all within it, and of a corner in the
/// middle of the gap between the courses on both sides, of as many samples.
double error_of_bridged(const std::vector<double>& values, const std::vector<std::uint8_t>& marks,
                        const RemovedBaseline& noise) {
  double variance = 0.0;
  const std::size_t size = marks.size();
  for (std::size_t begin = 0; begin < size; ++begin) {
    if (marks[begin] != 0) continue;
    std::size_t end = begin;
    while (end < size && marks[end] == 0) ++end;
    const std::size_t reach = std::max<std::size_t>(3, end - begin);
    const auto slope = [&](std::size_t from, std::size_t to) {
      if (to < from + 3) return 0.0;
      const QuietFit course = fit_quiet(values, from, to, 1, 0.0, marks);
      return course.coefficients[1] / course.half;
    };
    const double n = static_cast<double>(end - begin);
    const double bend =
        slope(begin > reach ? begin - reach : 0, begin) - slope(end, std::min(size, end + reach));
    variance += noise.noise * noise.noise * (0.5 * n * n + noise.correlation * n) +
                std::pow((n + 1.0) * (n + 1.0) / 8.0 * bend, 2);
    begin = end;
  }
  return std::sqrt(variance);
}

}  // namespace

Edit undo_low_cut(Channel& channel, const datasets::UndoLowCut& low_cut) {
  if (!(low_cut.frequency > 0.0))
    throw std::invalid_argument(
        fmt::format("a low cut at {:g} Hz is not positive", low_cut.frequency));
  Edit edit{"undo low cut", channel.name, {}};
  if (low_cut.quiet) {
    RemovedBaseline baseline = remove_baseline(channel, *low_cut.quiet);
    edit.parameters = std::move(baseline.edit.parameters);
    const double grown = 1.0 + 2.0 * std::numbers::pi * low_cut.frequency * channel.clock.interval *
                                   static_cast<double>(channel.size());
    const double step = 2.0 * std::numbers::pi * low_cut.frequency * channel.clock.interval;
    const double error =
        std::hypot(grown * baseline.uncertainty,
                   step * error_of_bridged(sound_values(channel), sound_marks(channel), baseline));
    edit.parameters["uncertainty"] =
        fmt::format("{} {} at most", datasets::figures(error, 2), channel.unit);
  }
  edit.parameters["frequency"] = fmt::format("{:.12g} Hz, first order", low_cut.frequency);
  std::vector<double> values = sound_values(channel);
  const double half_step = std::numbers::pi * low_cut.frequency * channel.clock.interval;
  double previous = values.front(), integral = 0.0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double value = values[i];
    integral += half_step * (previous + value);
    previous = value;
    values[i] = value + integral;
  }
  channel.valid = sound_marks(channel);
  replace_values(channel, std::move(values));
  return edit;
}

}  // namespace impactrig::acquisition
