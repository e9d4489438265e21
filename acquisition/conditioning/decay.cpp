// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/decay.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

#include "acquisition/conditioning/background.hpp"
#include "acquisition/conditioning/baseline.hpp"
#include "acquisition/conditioning/samples.hpp"

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
        if (!channel.is_valid(i)) continue;
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

/// Standard uncertainty of T when c, a and T all come from the data.
double time_uncertainty(const Quiet& quiet, const Decay& decay) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  std::vector<double> residuals;
  residuals.reserve(quiet.times.size());
  for (std::size_t i = 0; i < quiet.times.size(); ++i) {
    const double t = quiet.times[i];
    const double fall = std::exp(-t / decay.time);
    // The last column is the derivative by ln T, of an amplitude of 1: whatever the unit.
    const Eigen::Vector3d row(1.0, fall, fall * t / decay.time);
    normal += row * row.transpose();
    residuals.push_back(quiet.values[i] - decay.at(t));
  }
  const double n = static_cast<double>(quiet.times.size());
  const double variance = decay.squares / (n - 3.0) * correlation_time(residuals);
  const Eigen::FullPivLU<Eigen::Matrix3d> lu(normal);
  if (!lu.isInvertible()) return std::numeric_limits<double>::infinity();
  const double of_log = std::sqrt(variance * std::max(0.0, lu.inverse()(2, 2)));
  return decay.amplitude != 0.0 ? decay.time * of_log / std::abs(decay.amplitude)
                                : std::numeric_limits<double>::infinity();
}

}  // namespace

Edit remove_decay(Channel& channel, const datasets::RemoveDecay& wanted) {
  const Quiet quiet = quiet_samples(channel, wanted);
  double span = 0.0;
  for (const double time : quiet.times) span = std::max(span, time);
  Edit edit{"remove decay", channel.name, {{"quiet", text_of(wanted.quiet)}}};
  Decay decay;
  if (wanted.time_constant) {
    if (!(*wanted.time_constant > 0.0))
      throw std::invalid_argument(
          fmt::format("a time constant of {:g} s is not positive", *wanted.time_constant));
    decay = fitted(quiet, *wanted.time_constant);
    edit.parameters["time constant"] = fmt::format("{:.12g} s, stated", decay.time);
  } else {
    decay = with_best_time(quiet, span);
    const double uncertainty = time_uncertainty(quiet, decay);
    if (!(uncertainty < 0.5 * decay.time))
      throw std::invalid_argument(fmt::format(
          "the quiet samples of channel '{}' do not tell the time constant of a decay "
          "({:.3g} s, uncertain by {:.3g} s); state time_constant, or take a straight line off "
          "(step = \"drift\")",
          channel.name, decay.time, uncertainty));
    edit.parameters["time constant"] = fmt::format("{:.6g} s, from the data", decay.time);
    edit.parameters["uncertainty"] = fmt::format("{:.3g} s", uncertainty);
  }
  edit.parameters["offset"] = fmt::format("{:.6g} {}", decay.constant, channel.unit);
  edit.parameters["amplitude"] =
      fmt::format("{:.6g} {} at {:.9g} s", decay.amplitude, channel.unit, quiet.origin);
  std::vector<double> values = channel.values();
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double time = channel.clock.time(i) - quiet.origin;
    if (time >= 0.0) values[i] -= decay.at(time);  // before, it grows without bound
  }
  replace_values(channel, std::move(values));
  return edit;
}

Edit undo_low_cut(Channel& channel, const datasets::UndoLowCut& low_cut) {
  if (!(low_cut.frequency > 0.0))
    throw std::invalid_argument(
        fmt::format("a low cut at {:g} Hz is not positive", low_cut.frequency));
  Edit edit{"undo low cut", channel.name, {}};
  if (low_cut.quiet) edit.parameters = remove_baseline(channel, *low_cut.quiet).parameters;
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
