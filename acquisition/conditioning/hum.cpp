// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/hum.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

#include "acquisition/conditioning/decay_fit.hpp"
#include "acquisition/conditioning/hum_fit.hpp"
#include "acquisition/conditioning/hum_frequency.hpp"
#include "acquisition/conditioning/samples.hpp"
#include "datasets/number_text.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::Edit;
using datasets::RemoveHum;

namespace {

constexpr double significant = 4.0;  ///< standard errors
/// Standard deviation of a grid's frequency from the stated one, as a part of it: 50 mHz of 50 Hz.
constexpr double mains_wander = 1e-3;

// Of half a period a sinusoid and a line are nearly a parabola: multiples took the place of the
// mains, and what came off was off by up to 57 times what was stated; of 0.73 by no more than that.
constexpr double fewest_periods = 0.7;

/// Leaves out the least significant multiple until all that is left is significant.
HumFit significant_part(const HumPoints& points, double frequency, int harmonics) {
  std::vector<int> multiples = hum_multiples(harmonics);
  for (;;) {
    HumFit fit = fit_hum(points, frequency, multiples, HumFigures::errors);
    std::size_t weakest = 0;
    double least = INFINITY;
    for (std::size_t m = 0; m < multiples.size(); ++m) {
      const double ratio = fit.significance(m);
      if (ratio >= least) continue;  // 0/0, as of a constant, is no hum
      least = std::isnan(ratio) ? 0.0 : ratio;
      weakest = m;
    }
    if (!(least < significant)) return fit;
    multiples.erase(multiples.begin() + static_cast<std::ptrdiff_t>(weakest));
    if (multiples.empty()) return fit_hum(points, frequency, {}, HumFigures::errors);
  }
}

/// Quiet samples and the mains in them, whichever of the world's two explains them better where
/// none is stated.
struct Mains {
  QuietHum quiet;
  bool told = true;  ///< clearly, or by its frequency
};

Mains find_mains(const Channel& channel, const RemoveHum& hum, std::span<const double> values) {
  constexpr double other_mains = 60.0;  // [Hz]
  constexpr double clearly = 1.2;       // times the variance left over
  Mains mains{find_quiet_hum(channel, hum, values)};
  if (hum.frequency) return mains;
  RemoveHum other = hum;
  other.frequency = other_mains;
  QuietHum others = find_quiet_hum(channel, other, values);
  const auto left_over = [&hum](const QuietHum& quiet) {
    return significant_part(quiet.points, quiet.frequency, hum.harmonics).variance;
  };
  const double own = left_over(mains.quiet), of_others = left_over(others);
  mains.told =
      mains.quiet.from_data || std::max(own, of_others) > clearly * std::min(own, of_others);
  if (of_others < own) mains.quiet = std::move(others);
  return mains;
}

/// What an error of the frequency makes of the hum per second from the middle of the points
/// [unit/s]. From the data that error is √6 s / (pi A T √n) [RifeBoorstyn1974], else the grid's.
double drift_of(const HumPoints& quiet, const HumFit& fit, bool frequency_from_data) {
  if (frequency_from_data) {
    const double n = static_cast<double>(quiet.points.size());
    return 2.0 * std::sqrt(6.0 * fit.variance / n) / quiet.span() * fit.multiples.back();
  }
  double amplitude = 0.0;  // times the multiple
  for (std::size_t m = 0; m < fit.multiples.size(); ++m)
    amplitude = std::hypot(amplitude, fit.multiples[m] * fit.amplitude(m));
  return 2.0 * std::numbers::pi * mains_wander * fit.frequency * amplitude;
}

/// The largest standard error of the hum anywhere in the record. What the frequency's own error
/// adds grows with the distance from the quiet samples.
double largest_error(const Channel& channel, const HumPoints& quiet, const HumFit& fit,
                     bool frequency_from_data) {
  const double first = quiet.points.front().time, last = quiet.points.back().time;
  const double drift = drift_of(quiet, fit, frequency_from_data);
  constexpr int places = 512;
  const double length = channel.clock.interval * static_cast<double>(channel.size());
  double largest = 0.0;
  for (int i = 0; i <= places; ++i) {
    const double time = channel.clock.start + length * i / places;
    const double error = std::hypot(fit.error_at(time), drift * (time - 0.5 * (first + last)));
    largest = std::max(largest, error);
  }
  return largest;
}

}  // namespace

Edit remove_hum(Channel& channel, const RemoveHum& hum, const datasets::RemoveDecay* decay) {
  std::vector<double> values = sound_values(channel);
  std::vector<double> without_decay = values;
  if (decay) {
    const Decay fitted = fit_decay(channel, *decay, &hum).decay;
    for (std::size_t i = 0; i < values.size(); ++i)
      without_decay[i] -= fitted.at(channel.clock.time(i));
  }
  const Mains mains = find_mains(channel, hum, without_decay);
  const QuietHum& found = mains.quiet;
  const HumPoints& quiet_points = found.points;
  const double frequency = found.frequency;
  const bool from_data = found.from_data;
  if (const double periods = quiet_points.span() * frequency; periods < fewest_periods)
    throw std::invalid_argument(fmt::format(
        "the quiet samples of channel '{}' span {:.2g} of a period of the mains, which does not "
        "tell hum from drift, nor the mains from their multiples: record at least a period before "
        "the trigger, or leave this step out",
        channel.name, periods));
  const HumFit fit = significant_part(quiet_points, frequency, hum.harmonics);

  Edit edit{"remove hum", channel.name, {{"quiet", text_of(hum.quiet)}}};
  if (decay) edit.parameters["fitted beside"] = "a decay";
  if (fit.multiples.empty()) {
    edit.parameters["found"] = "nothing above the noise, so nothing was taken off";
    return edit;
  }
  double amplitude = 0.0, error = 0.0;
  for (std::size_t m = 0; m < fit.multiples.size(); ++m) {
    amplitude += fit.amplitude(m);
    edit.parameters[fmt::format("amplitude {}", fit.multiples[m])] =
        fmt::format("{} {}, uncertain by {}", datasets::figures(fit.amplitude(m), 4), channel.unit,
                    datasets::figures(fit.error(m), 2));
  }
  error = largest_error(channel, quiet_points, fit, from_data);
  if (!(error <= 0.5 * amplitude))
    throw std::invalid_argument(fmt::format(
        "the quiet samples of channel '{}' do not tell hum from drift: what would be taken off has "
        "an amplitude of {} {}, uncertain by up to {}; record at least a period of the "
        "mains before the trigger, or leave this step out",
        channel.name, datasets::figures(amplitude, 3), channel.unit, datasets::figures(error, 3)));
  edit.parameters["frequency"] =
      fmt::format("{:.6g} Hz{}", frequency,
                  from_data       ? ""
                  : hum.frequency ? ", stated"
                  : mains.told    ? ", the likelier of 50 and 60 Hz"
                                  : ", of 50 and 60 Hz as likely as the other");
  edit.parameters["uncertainty"] =
      fmt::format("{} {} at most", datasets::figures(error, 2), channel.unit);
  channel.valid = sound_marks(channel);
  fit.take_off(values, channel.clock.start, channel.clock.interval);
  // Samples that are not sound keep what was recorded.
  if (!channel.valid.empty())
    for (std::size_t i = 0; i < values.size(); ++i)
      if (!channel.is_valid(i)) values[i] = channel.value(i);
  replace_values(channel, std::move(values));
  return edit;
}

}  // namespace impactrig::acquisition
