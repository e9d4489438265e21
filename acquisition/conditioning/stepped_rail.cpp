// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/stepped_rail.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "acquisition/conditioning/background.hpp"
#include "acquisition/conditioning/cut_or_late.hpp"

namespace impactrig::acquisition {

using datasets::Impact;
using datasets::ImpactSignal;
using datasets::Quantity;

namespace {

constexpr std::size_t fewest_level = 16;  ///< samples

double as_double(std::size_t n) {
  return static_cast<double>(n);
}

/// The longest level stretch of a signal at its largest value, in the direction of `sign`, of a
/// digitiser whose step is known.
struct LevelStretch {
  const ImpactSignal& signal;
  double sign, top;
  std::size_t first = 0, size = 0;  ///< samples
  long span = 0;                    ///< steps to the other extreme

  LevelStretch(const ImpactSignal& of, double direction) : signal(of), sign(direction) {
    const auto [least, most] = std::ranges::minmax(signal.values);
    top = sign > 0.0 ? most : least;
    span = std::lround((most - least) / signal.quantum);
    for (std::size_t i = 0, begin = 0; i < signal.values.size(); ++i) {
      if (below(i) > 0) begin = i + 1;
      if (i + 1 - begin > size) first = begin, size = i + 1 - begin;
    }
  }

  bool begins_inside() const { return first == 0; }

  bool ends_inside() const { return first + size == signal.values.size(); }

  /// Steps under the extreme.
  long below(std::size_t i) const {
    return std::lround(sign * (top - signal.values[i]) / signal.quantum);
  }

  /// How far the signal has fallen `samples` behind the end of the stretch, or before its begin.
  long fall(std::size_t samples, bool behind) const {
    if (behind) return below(std::min(first + size - 1 + samples, signal.values.size() - 1));
    return below(first > samples ? first - samples : 0);
  }

  /// Samples from the end (or begin) until the signal is so many steps down; none where it is not.
  std::optional<double> samples_to(long depth, bool behind) const {
    const std::size_t most = behind ? signal.values.size() - first - size : first;
    const double level = static_cast<double>(depth) - 0.5;  // where the value before gives way
    double last = 0.0;
    for (std::size_t n = 0; n < most; ++n) {
      const double here = static_cast<double>(below(behind ? first + size + n : first - 1 - n));
      if (here >= level) return as_double(n) - (here - level) / (here - last);
      last = here;
    }
    return std::nullopt;
  }
};

/// Without those at its end that are not valid.
std::size_t sound_samples_before_end(const ImpactSignal& signal) {
  std::size_t end = signal.values.size();
  while (!signal.valid.empty() && end > 0 && signal.valid[end - 1] == 0) --end;
  return end;
}

/// Whether a signal leaves its extreme at once as steeply as it goes on. What a contact's force
/// bends begins as t² or slower and takes 1.6 times as long over its first m steps as over the next
/// m; a rail that it crosses, once.
bool leaves_at_once(const LevelStretch& level, bool behind) {
  constexpr long fewest_steps = 4;
  constexpr double fewest_samples = 2.0;  // the stretch's own end is known to one
  const long m = std::max(fewest_steps, level.span / 12);
  const auto near = level.samples_to(1 + m, behind), far = level.samples_to(1 + 2 * m, behind);
  if (!near || !far || *near < fewest_samples) return false;
  return *near < 1.35 * (*far - *near) &&
         as_double(level.size) > 4.0 * std::max(*near, *far - *near) / static_cast<double>(m);
}

/// What a signal is to an observer who sees no more of it than its noise lets him: means of
/// neighbours, a fortieth of the contact, in steps that hold four standard deviations of their
/// noise to either side of the level it has at its extreme in the direction of `sign`. None where a
/// digitiser's steps hide the noise anyhow.
std::optional<ImpactSignal> in_steps_of_noise(const Impact& impact, const ImpactSignal& signal,
                                              double sign) {
  constexpr double part = 40.0, deviations = 4.0;
  if (!(signal.noise > 0.5 * signal.quantum)) return std::nullopt;
  const double contact = (impact.end - impact.start) / signal.interval;
  const auto width = static_cast<std::size_t>(std::clamp(contact / part, 1.0, 64.0));
  if (signal.values.size() < 4 * width) return std::nullopt;
  ImpactSignal coarse = signal;
  const std::size_t n = signal.values.size() - width + 1;
  coarse.values.assign(n, 0.0);
  double sum = 0.0;
  for (std::size_t i = 0; i < signal.values.size(); ++i) {
    sum += signal.values[i] - (i >= width ? signal.values[i - width] : 0.0);
    if (i + 1 >= width) coarse.values[i + 1 - width] = sum / as_double(width);
  }
  coarse.start += 0.5 * as_double(width - 1) * signal.interval;
  coarse.quantum = 2.0 * deviations * signal.noise *
                   std::sqrt(std::max(1.0, signal.noise_correlation) / as_double(width));
  double top = -INFINITY;
  for (const double value : coarse.values) top = std::max(top, sign * value);
  std::vector<double> near;
  for (const double value : coarse.values)
    if (sign * value > top - coarse.quantum) near.push_back(sign * value);
  const double level = median(std::move(near));
  for (double& value : coarse.values)
    value = sign * (level - coarse.quantum *
                                std::max(0.0, std::round((level - sign * value) / coarse.quantum)));
  return coarse;
}

}  // namespace

bool on_stepped_rail(const Impact& impact, const ImpactSignal& signal, double sign) {
  constexpr long least_span = 48;  // steps: fewer do not tell a curve from a line
  constexpr long crest_fall = 13;
  if (!(signal.quantum > 0.0)) return false;
  if (const std::size_t sound = sound_samples_before_end(signal); sound < signal.values.size()) {
    if (sound < 2 * fewest_level) return false;
    ImpactSignal before = signal;
    before.values.resize(sound);
    before.valid.resize(sound);
    return on_stepped_rail(impact, before, sign);
  }
  if (!signal.valid.empty() && std::ranges::count(signal.valid, 0) > 0) return false;
  const LevelStretch level(signal, sign);
  const bool begins = level.begins_inside(), ends = level.ends_inside();
  const double span = static_cast<double>(level.span);
  if (level.size < fewest_level || (begins && ends) ||
      std::abs(level.top) <= 1e-3 * span * signal.quantum)  // lost lasers show zero
    return false;
  if (!begins && !ends)
    return std::min(level.fall(level.size, false), level.fall(level.size, true)) > crest_fall &&
           leaves_at_once(level, false) && leaves_at_once(level, true);
  if (signal.quantity != Quantity::velocity || level.span < least_span) return false;
  const double edge = signal.time(begins ? level.size : level.first);
  const double little = 0.02 + 3.0 / span, late = 0.1 * (impact.end - impact.start);
  if (!impact.force || !(edge > impact.start + late) || !(edge < impact.end - late)) return false;
  const double done = impulse_until(impact, edge);
  return done > little && done < 1.0 - little && leaves_at_once(level, begins) &&
         is_cut_not_late(impact, {begins, edge, little});
}

bool on_noisy_rail(const Impact& impact, const ImpactSignal& velocity, double sign) {
  const auto coarse = in_steps_of_noise(impact, velocity, sign);
  return coarse && on_stepped_rail(impact, *coarse, sign);
}

}  // namespace impactrig::acquisition
