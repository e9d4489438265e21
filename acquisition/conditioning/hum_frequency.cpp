// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/hum_frequency.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>
#include <unsupported/Eigen/FFT>
#include <utility>
#include <vector>

#include "acquisition/conditioning/samples.hpp"

namespace impactrig::acquisition {

namespace {

constexpr double pi = std::numbers::pi;

/// So many frequencies are fitted each.
constexpr double few = 64.0;

/// Frequencies that are looked at.
struct Band {
  double lowest, highest;  ///< [Hz]
  double step;             ///< finer than the width of a minimum

  bool within(double f) const { return f >= lowest && f <= highest; }
};

Band band_of(double stated, double span) {
  const double lowest = (1.0 - mains_tolerance) * stated;
  const double highest = (1.0 + mains_tolerance) * stated;
  return {lowest, highest, std::min(0.2 / span, 0.25 * (highest - lowest))};
}

std::vector<double> all_frequencies(double stated, const Band& band) {
  std::vector<double> list = {stated};
  for (double f = band.lowest; f <= band.highest; f += band.step) list.push_back(f);
  return list;
}

/// The points less a line for each stretch, turned back by the stated frequency and averaged in
/// equal times.
std::vector<std::complex<double>> short_series(const HumPoints& coarse, double stated,
                                               double interval) {
  const HumFit lines = fit_hum(coarse, stated, {}, HumFigures::squares);
  const double start = coarse.points.front().time;
  std::vector<std::complex<double>> series(static_cast<std::size_t>(coarse.span() / interval) + 1);
  for (const HumPoint& point : coarse.points) {
    const double line =
        lines.coefficients[2 * point.stretch] + lines.coefficients[2 * point.stretch + 1] * point.u;
    const auto bin = static_cast<std::size_t>((point.time - start) / interval);
    series[std::min(bin, series.size() - 1)] +=
        (point.value - line) * std::polar(1.0, -2.0 * pi * stated * point.time);
  }
  return series;
}

/// The frequencies of the highest peaks of a periodogram in the band.
std::vector<double> peaks(const HumPoints& coarse, double stated, const Band& band) {
  constexpr std::size_t most = 8;
  const double interval = 1.0 / (32.0 * mains_tolerance * stated);
  std::vector<std::complex<double>> series = short_series(coarse, stated, interval);
  std::size_t length = 1;
  while (static_cast<double>(length) * interval * band.step < 1.0) length *= 2;
  series.resize(length);
  std::vector<std::complex<double>> transform;
  Eigen::FFT<double> fft;
  fft.fwd(transform, series);
  const auto power = [&](std::size_t k) { return std::norm(transform[k % length]); };
  std::vector<std::pair<double, double>> found;  // power, frequency
  for (std::size_t k = 0; k < length; ++k) {
    const double turns = k < length / 2 ? static_cast<double>(k)
                                        : static_cast<double>(k) - static_cast<double>(length);
    const double f = stated + turns / (static_cast<double>(length) * interval);
    const bool peak = power(k) >= power(k + 1) && power(k) >= power(k + length - 1);
    if (peak && band.within(f)) found.emplace_back(power(k), f);
  }
  std::ranges::sort(found, std::greater<>());
  std::vector<double> list = {band.lowest, band.highest};
  for (std::size_t i = 0; i < std::min(most, found.size()); ++i) list.push_back(found[i].second);
  return list;
}

}  // namespace

double hum_frequency(const HumPoints& coarse, const HumPoints& points, double stated,
                     int harmonics) {
  const Band band = band_of(stated, points.span());
  const bool many = band.highest - band.lowest > few * band.step;
  double best = stated, least = INFINITY;
  for (const double f : many ? peaks(coarse, stated, band) : all_frequencies(stated, band)) {
    const double squares = fit_hum(coarse, f, {1}, HumFigures::squares).squares;
    if (squares >= least) continue;
    best = f;
    least = squares;
  }
  const double low = std::max(band.lowest, best - band.step);
  const double high = std::min(band.highest, best + band.step);
  const std::vector<int> all = hum_multiples(harmonics);
  double f = best;
  for (int steps = 0; steps < 10; ++steps) {
    const double next =
        std::clamp(f + fit_hum(points, f, all, HumFigures::correction).correction, low, high);
    const double moved = std::abs(next - f);
    f = next;
    if (moved * points.span() <= 1e-9) return f;
  }
  const auto squares = [&](double at) {
    return fit_hum(points, at, all, HumFigures::squares).squares;
  };
  return boost::math::tools::brent_find_minima(squares, low, high, 24).first;
}

namespace {

constexpr double enough_periods = 5.0;  ///< to tell the frequency

void refuse_senseless(const datasets::Channel& channel, const datasets::RemoveHum& hum,
                      double frequency) {
  if (!(frequency > 0.0))
    throw std::invalid_argument(
        fmt::format("a mains frequency of {:g} Hz is not positive", frequency));
  if (hum.harmonics < 1 || hum.harmonics > 20)
    throw std::invalid_argument(fmt::format("hum has 1 to 20 harmonics, not {}", hum.harmonics));
  if (!(4.0 * hum.harmonics * frequency * channel.clock.interval < 1.0))
    throw std::invalid_argument(fmt::format(
        "multiple {} of {:g} Hz is not below a quarter of the sample rate of channel '{}'",
        hum.harmonics, frequency, channel.name));
}

}  // namespace

QuietHum find_quiet_hum(const datasets::Channel& channel, const datasets::RemoveHum& hum,
                        std::span<const double> values) {
  const double stated = hum.frequency.value_or(default_mains);
  refuse_senseless(channel, hum, stated);
  double quiet = 0.0;  // [s]
  for (const datasets::TimeSpan& stretch : hum.quiet)
    quiet += channel.clock.interval * static_cast<double>(samples_in(channel, stretch).size());
  const double widest = std::min(1.0 / (20.0 * stated * hum.harmonics), quiet / 256.0);
  QuietHum found{.points = hum_points(channel, hum, values, widest), .frequency = stated};
  if (found.points.points.size() < 32)
    throw std::invalid_argument(
        fmt::format("channel '{}' has {} samples at quiet times ({}); at least 32 are needed to "
                    "know its hum",
                    channel.name, found.points.points.size(), text_of(hum.quiet)));
  found.from_data = found.points.span() * stated >= enough_periods;
  if (found.from_data)
    found.frequency = hum_frequency(hum_points(channel, hum, values, 0.05 / stated), found.points,
                                    stated, hum.harmonics);
  return found;
}

}  // namespace impactrig::acquisition
