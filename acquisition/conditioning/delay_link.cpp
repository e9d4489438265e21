// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/delay_link.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "acquisition/conditioning/background.hpp"
#include "acquisition/conditioning/samples.hpp"
#include "datasets/zero_phase_low_pass.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::Quantity;
using datasets::TimeSpan;

double Signal::at(double t) const {
  const double last = static_cast<double>(values.size()) - 3.0;
  const double place = (t - start) / interval;
  const double base = std::clamp(std::floor(place), 1.0, std::max(1.0, last));
  const double u = place - base;
  const double* const y = values.data() + static_cast<std::ptrdiff_t>(base) - 1;
  return -u * (u - 1.0) * (u - 2.0) / 6.0 * y[0] + (u + 1.0) * (u - 1.0) * (u - 2.0) / 2.0 * y[1] -
         (u + 1.0) * u * (u - 2.0) / 2.0 * y[2] + (u + 1.0) * u * (u - 1.0) / 6.0 * y[3];
}

bool Signal::counts_at(double t) const {
  if (sound.empty()) return true;
  const double last = static_cast<double>(values.size()) - 2.0;
  const auto i = static_cast<std::size_t>(
      std::clamp(std::floor((t - start) / interval), 0.0, std::max(0.0, last)));
  return counts(i) && counts(std::min(i + 1, values.size() - 1));
}

std::size_t Link::counted() const {
  return counting.size() - static_cast<std::size_t>(std::ranges::count(counting, 0));
}

void Link::count_at(double delay) {
  counting.assign(channel.values.size(), 1);
  for (std::size_t i = 0; i < counting.size(); ++i)
    if (!channel.counts(i) || !reference.counts_at(channel.time(i) - delay)) counting[i] = 0;
  if (counted() < least_samples + gaps.size())
    throw std::invalid_argument(
        fmt::format("of the {} samples that could tell a delay {} are sound in both channels; at "
                    "least {} are needed",
                    counting.size(), counted(), least_samples + gaps.size()));
}

namespace {

constexpr std::size_t most_samples = 4096;  ///< of a segment; longer ones are averaged in blocks

double mean_of(const std::vector<double>& values, std::size_t first, std::size_t n) {
  double sum = 0.0;
  for (std::size_t i = first; i < first + n; ++i) sum += values[i];
  return sum / static_cast<double>(n);
}

/// The samples within a span, by means of blocks where there are too many.
Signal segment_of(const Channel& channel, const TimeSpan& span) {
  // Interpolated white noise is smaller between samples than on them, which would pull delays to
  // half samples; both channels pass the same filter, so that what links them is left as it is.
  const datasets::LowPass filter{compared_band / channel.clock.interval, 4};
  const std::vector<double> all =
      datasets::zero_phase_low_pass(sound_values(channel), channel.clock.interval, filter);
  const std::vector<std::uint8_t> marks = sound_marks(channel);
  std::vector<double> sound(marks.begin(), marks.end());
  if (!sound.empty()) sound = datasets::zero_phase_low_pass(sound, channel.clock.interval, filter);
  const IndexRange range = samples_in(channel, span);
  if (range.size() < least_samples)
    throw std::invalid_argument(
        fmt::format("channel '{}' has {} samples between {:g} s and {:g} s; at least {} are needed "
                    "to estimate a delay",
                    channel.name, range.size(), span.begin, span.end, least_samples));
  const std::size_t width = (range.size() + most_samples - 1) / most_samples;
  Signal signal;
  signal.interval = channel.clock.interval * static_cast<double>(width);
  signal.start = channel.clock.time(range.begin) + 0.5 * (signal.interval - channel.clock.interval);
  for (std::size_t i = range.begin; i + width <= range.end; i += width) {
    signal.values.push_back(mean_of(all, i, width));
    if (!sound.empty()) signal.sound.push_back(mean_of(sound, i, width));
  }
  return signal;
}

Signal integral_of(const Signal& signal) {
  Signal result{signal.start, signal.interval, std::vector<double>(signal.values.size(), 0.0)};
  for (std::size_t i = 1; i < signal.values.size(); ++i)
    result.values[i] =
        result.values[i - 1] + 0.5 * signal.interval * (signal.values[i - 1] + signal.values[i]);
  return result;
}

/// ∫ (t - s)^p f(s) ds from the first sample on, p > -1, exact for an f that is linear between
/// samples and begins at 0: the second differences of m^(p+2), times h^(p+1)/((p+1)(p+2)), are its
/// weights.
Signal fractional_integral(const Signal& signal, double p) {
  const std::size_t n = signal.values.size();
  const auto power = [&](double m) { return m > 0.0 ? std::pow(m, p + 2.0) : 0.0; };
  std::vector<double> weights(n);
  for (std::size_t m = 0; m < n; ++m) {
    const double x = static_cast<double>(m);
    weights[m] = power(x + 1.0) - 2.0 * power(x) + power(x - 1.0);
  }
  const double factor = std::pow(signal.interval, p + 1.0) / ((p + 1.0) * (p + 2.0));
  Signal result{signal.start, signal.interval, std::vector<double>(n, 0.0)};
  for (std::size_t i = 0; i < n; ++i) {
    double sum = 0.0;
    for (std::size_t j = 0; j <= i; ++j) sum += signal.values[j] * weights[i - j];
    result.values[i] = factor * sum;
  }
  return result;
}

/// Samples before a signal departs from its level.
std::size_t quiet_head(const std::vector<double>& y) {
  const std::size_t head = std::max<std::size_t>(8, y.size() / 20);
  const double level = median({y.begin(), y.begin() + static_cast<std::ptrdiff_t>(head)});
  double peak = 0.0;
  for (const double value : y) peak = std::max(peak, std::abs(value - level));
  const double limit = std::max(6.0 * step_noise(y), 0.05 * peak);
  std::size_t crossing = 0;
  while (crossing < y.size() && std::abs(y[crossing] - level) <= limit) ++crossing;
  return std::max<std::size_t>(1, crossing - crossing / 4);
}

/// A force without what it shows before it rises.
void take_level_off(Signal& force) {
  std::vector<double>& y = force.values;
  const std::size_t quiet = quiet_head(y);
  double mean = 0.0;
  for (std::size_t i = 0; i < quiet; ++i) mean += y[i] / static_cast<double>(quiet);
  for (double& value : y) value -= mean;
}

/// Power of a signal's noise at low frequencies, as of white noise: variance times interval, from
/// the line through what it shows before it moves [unit² s]; 0 where that is too short.
double noise_power(const Signal& signal) {
  const std::size_t quiet = quiet_head(signal.values);
  if (quiet < least_samples) return 0.0;
  const QuietFit line = fit_quiet(signal.values, 0, quiet, 1, 0.0);
  return line.sigma * line.sigma * line.correlation * signal.interval;
}

TimeSpan widened(const TimeSpan& window, double by) {
  return {window.begin - by, window.end + by};
}

/// Leaves only samples of the channel whose references, however delayed, exist.
void cut_to_reference(const Signal& reference, double range, Signal& channel) {
  const double margin = range + 2.0 * reference.interval;
  const double from = reference.start + margin;
  const double to = reference.time(reference.values.size() - 1) - margin;
  Signal cut{0.0, channel.interval, {}};
  for (std::size_t i = 0; i < channel.values.size(); ++i) {
    const double t = channel.time(i);
    if (t < from || t > to) continue;
    if (cut.values.empty()) cut.start = t;
    cut.values.push_back(channel.values[i]);
    if (!channel.sound.empty()) cut.sound.push_back(channel.sound[i]);
  }
  if (cut.values.size() < least_samples)
    throw std::invalid_argument(
        "the two channels share too little time to estimate a delay between them");
  channel = std::move(cut);
}

/// Per gap of the reference, of a period of what is compared or more, as many pieces as it is
/// integrated: by their integrals its line may be off.
std::vector<Signal> gaps_of(const Signal& reference, int integrations) {
  std::vector<Signal> gaps;
  const std::size_t n = reference.values.size();
  for (std::size_t begin = 0; begin < n; ++begin) {
    if (reference.counts(begin)) continue;
    std::size_t end = begin;
    while (end < n && !reference.counts(end)) ++end;
    const bool long_enough = static_cast<double>(end - begin) * compared_band >= 1.0;
    const std::size_t pieces = long_enough ? static_cast<std::size_t>(integrations) : 0;
    for (std::size_t k = 0; k < pieces; ++k) {
      Signal piece{reference.start, reference.interval, std::vector<double>(n, 0.0)};
      for (std::size_t i = begin + (end - begin) * k / pieces;
           i < begin + (end - begin) * (k + 1) / pieces; ++i)
        piece.values[i] = 1.0;
      for (int times = 0; times < integrations; ++times) piece = integral_of(piece);
      gaps.push_back(std::move(piece));
    }
    begin = end;
  }
  return gaps;
}

}  // namespace

std::optional<int> derivative_of(Quantity quantity) {
  if (quantity == Quantity::displacement) return 0;
  if (quantity == Quantity::velocity) return 1;
  if (quantity == Quantity::acceleration) return 2;
  return std::nullopt;
}

Link link_between(const Channel& reference, const Channel& channel, const TimeSpan& window,
                  double range) {
  Link link;
  const double margin = range + 4.0 * reference.clock.interval;
  Signal x = segment_of(reference, widened(window, margin));
  link.channel = segment_of(channel, window);
  const auto from = derivative_of(reference.quantity), to = derivative_of(channel.quantity);
  if (reference.quantity == Quantity::force && to) {
    take_level_off(x);
    if (*to == 2) link.channel = integral_of(link.channel);
    const double first = *to == 0 ? 0.5 : -0.5;
    for (int k = 0; k < most_terms; ++k)
      link.basis.push_back(fractional_integral(x, first + 0.5 * k));
    link.degree = *to == 0 ? 2 : 1;
    link.expansion = true;
  } else {
    link.integrations = from && to ? *from - *to : 0;
    link.reference = x;
    if (link.integrations > 0) link.noise_power = noise_power(x);
    if (link.integrations > 0) link.gaps = gaps_of(x, link.integrations);
    for (int i = 0; i < link.integrations; ++i) x = integral_of(x);
    link.degree = 1 + link.integrations;
    link.basis.push_back(x);
  }
  cut_to_reference(link.basis.front(), range, link.channel);
  link.count_at(0.0);
  return link;
}

}  // namespace impactrig::acquisition
