// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/samples_at_jumps.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "fitting/filtered_samples.hpp"

namespace impactrig::fitting {
namespace {

using datasets::GridSamples;

// How far from a jump a sample may show either side of it, in samples; while a search is far off.
constexpr double beside_jump = 1.0, rough_beside_jump = 8.0;

}  // namespace

/// Looks where the jumps of a curve are, between which samples taken.
class SamplesAtJumps::JumpPlaces {
 public:
  JumpPlaces(SamplesAtJumps& samples, const Shown::Curve& curve, double gain, double near)
      : samples_(samples),
        curve_(curve),
        gain_(gain),
        near_(near),
        used_(samples.channel_.used) {
    const std::vector<double> shown = samples.values(curve, used_);
    for (std::size_t i = 0; i < used_.size(); ++i)
      off_.push_back(samples.channel_.measured[used_[i]] - gain * shown[i]);
  }

  void look_beside(std::size_t jump) {
    const double time = curve_.jumps[jump].time;
    const double place = (time + samples_.shift_ - samples_.origin_) / samples_.interval_;
    auto after = static_cast<std::ptrdiff_t>(std::ceil(place));
    while (samples_.time_of(after - 1) >= time) --after;  // rounding
    while (samples_.time_of(after) < time) ++after;
    const Trial later = best(jump, after, 1), earlier = best(jump, after - 1, -1);
    const Trial& trial = later.gain > earlier.gain ? later : earlier;
    if (!(trial.gain > 0.0)) return;
    for (std::size_t i = 0; i < trial.change.size(); ++i) off_[trial.first + i] -= trial.change[i];
    const std::ptrdiff_t step = &trial == &later ? 1 : -1;
    const std::size_t piece = step > 0 ? jump : jump + 1;
    for (std::size_t i = 0; i < trial.moved; ++i)
      samples_.elsewhere_[(step > 0 ? after : after - 1) + step * static_cast<std::ptrdiff_t>(i)] =
          piece;
  }

 private:
  /// So many samples on one side of a jump shown as if they were on the other.
  struct Trial {
    std::size_t moved = 0;
    std::size_t first = 0;            ///< number among those used of the first that changes
    std::vector<double> change = {};  ///< of what they show, in the channel's unit
    double gain = 0.0;                ///< by which the sum of squares is less
  };

  /// One after the other from the jump on.
  Trial best(std::size_t jump, std::ptrdiff_t from, std::ptrdiff_t step) const {
    const std::size_t here = step > 0 ? jump + 1 : jump, other = step > 0 ? jump : jump + 1;
    Trial best, trial;
    for (std::ptrdiff_t taken = from;; taken += step) {
      const double t = samples_.time_of(taken);
      if (std::abs(t - curve_.jumps[jump].time) > near_ || curve_.piece_at(t) != here) break;
      add(taken, gain_ * (curve_.at(t, other)[0] - curve_.at(t, here)[0]), trial);
      ++trial.moved;
      trial.gain = 0.0;
      for (std::size_t i = 0; i < trial.change.size(); ++i) {
        const double off = off_[trial.first + i], left = off - trial.change[i];
        trial.gain += off * off - left * left;
      }
      if (trial.gain > best.gain) best = trial;
    }
    return best;
  }

  /// What a change of one sample taken changes of those used.
  void add(std::ptrdiff_t taken, double change, Trial& trial) const {
    const datasets::ImpactSignal& signal = *samples_.channel_.signal;
    const double t = samples_.time_of(taken) + samples_.shift_;
    const double grace = 1e-6 * signal.interval;
    const auto time = [&](std::size_t number) { return signal.time(number); };
    const auto begin = std::ranges::lower_bound(used_, t - samples_.reach_ - grace, {}, time);
    const auto end = std::ranges::upper_bound(used_, t + samples_.reach_ + grace, {}, time);
    if (begin >= end) return;
    const auto first = static_cast<std::size_t>(begin - used_.begin());
    const std::span<const std::size_t> numbers(begin, end);
    const auto around =
        static_cast<std::ptrdiff_t>(std::ceil(samples_.reach_ / samples_.interval_));
    GridSamples pulse{taken - 2 * around,
                      std::vector<double>(static_cast<std::size_t>(4 * around + 1), 0.0)};
    pulse.values[static_cast<std::size_t>(2 * around)] = change;
    const std::vector<double> changes = samples_.filtered(std::move(pulse), numbers);
    if (trial.change.empty()) trial.first = first;
    if (first < trial.first) {
      trial.change.insert(trial.change.begin(), trial.first - first, 0.0);
      trial.first = first;
    }
    const std::size_t shift = first - trial.first;
    trial.change.resize(std::max(trial.change.size(), shift + changes.size()), 0.0);
    for (std::size_t i = 0; i < changes.size(); ++i) trial.change[shift + i] += changes[i];
  }

  SamplesAtJumps& samples_;
  const Shown::Curve& curve_;
  double gain_, near_;
  const std::vector<std::size_t>& used_;
  std::vector<double> off_;  // measured less shown (n_used)
};

SamplesAtJumps::SamplesAtJumps(const FittedChannel& channel, const Measurement& measurement,
                               const Shown::Curve& curve, bool rough)
    : channel_(channel),
      shift_(measurement.shift),
      origin_(channel.signal->start),
      interval_(channel.signal->interval),
      reach_(reach_of(*channel.signal)),
      offset_(0),
      jumps_(curve.jumps.size()) {
  const datasets::ImpactSignal& signal = *channel.signal;
  if (!signal.filters.empty()) {
    origin_ = signal.recorded.begin;
    interval_ = signal.filters.front().interval;
    offset_ = std::lround((signal.start - origin_) / signal.interval);
  }
  if (jumps_ == 0) return;
  JumpPlaces places(*this, curve, measurement.gain,
                    (rough ? rough_beside_jump : beside_jump) * interval_);
  for (std::size_t jump = 0; jump < jumps_; ++jump) places.look_beside(jump);
}

double SamplesAtJumps::time_of(std::ptrdiff_t taken) const {
  return origin_ + interval_ * static_cast<double>(taken) - shift_;
}

GridSamples SamplesAtJumps::taken(const Shown::Curve& curve, std::size_t order,
                                  std::span<const std::size_t> numbers) const {
  const datasets::ImpactSignal& signal = *channel_.signal;
  const double begin = signal.time(numbers.front()) - reach_ - origin_;
  const double end = signal.time(numbers.back()) + reach_ - origin_;
  GridSamples samples{static_cast<std::ptrdiff_t>(std::floor(begin / interval_)), {}};
  const auto last = static_cast<std::ptrdiff_t>(std::ceil(end / interval_));
  samples.values.reserve(static_cast<std::size_t>(last - samples.first + 1));
  for (std::ptrdiff_t k = samples.first; k <= last; ++k)
    samples.values.push_back(curve.at(time_of(k))[order]);
  if (curve.jumps.size() != jumps_) return samples;
  for (auto k = elsewhere_.lower_bound(samples.first); k != elsewhere_.upper_bound(last); ++k)
    samples.values[static_cast<std::size_t>(k->first - samples.first)] =
        curve.at(time_of(k->first), k->second)[order];
  return samples;
}

std::vector<double> SamplesAtJumps::filtered(GridSamples samples,
                                             std::span<const std::size_t> numbers) const {
  for (const datasets::SampleFilter& filter : channel_.signal->filters)
    samples = filter.of(std::move(samples));
  std::vector<double> result;
  for (const std::size_t number : numbers) {
    const auto place = static_cast<std::ptrdiff_t>(number) + offset_ - samples.first;
    result.push_back(samples.values.at(static_cast<std::size_t>(place)));
  }
  return result;
}

std::vector<double> SamplesAtJumps::values(const Shown::Curve& curve,
                                           std::span<const std::size_t> numbers) const {
  if (numbers.empty()) return {};
  return filtered(taken(curve, 0, numbers), numbers);
}

std::vector<double> SamplesAtJumps::slopes(const Shown::Curve& curve,
                                           std::span<const std::size_t> numbers) const {
  if (numbers.empty()) return {};
  return filtered(taken(curve, 1, numbers), numbers);
}

}  // namespace impactrig::fitting
