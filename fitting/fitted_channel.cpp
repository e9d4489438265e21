// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/fitted_channel.hpp"

#include <algorithm>
#include <cmath>

#include "fitting/filtered_samples.hpp"
#include "fitting/quiet_noise.hpp"

namespace impactrig::fitting {

bool within_steps(const datasets::ImpactSignal& signal) {
  constexpr double reaching = 0.6;  // of a step
  return signal.noise < reaching * signal.quantum;
}

double least_noise(const datasets::ImpactSignal& signal) {
  constexpr double hidden = 0.25;  // of a step
  const double step = signal.quantum / std::sqrt(12.0);
  return within_steps(signal) ? std::hypot(step, hidden * signal.quantum) : step;
}

FittedChannel weigh(const datasets::Impact& impact, const datasets::ImpactSignal& signal,
                    double mains_frequency) {
  FittedChannel channel;
  channel.signal = &signal;
  channel.measured = signal.values;
  channel.sound = sound_samples(signal);
  channel.every = every_of(signal);
  double sigma = std::max(signal.noise, least_noise(signal));
  double largest = 0.0;
  for (const double value : signal.values)
    largest = std::max(largest, std::isfinite(value) ? std::abs(value) : 0.0);
  if (sigma > rounding_part * largest) {
    const double quiet_end =
        impact.start - std::max(5.0 * signal.interval, margin_part * (impact.end - impact.start));
    channel.noise = quiet_noise(signal, channel.sound, channel.every, quiet_end, mains_frequency,
                                sigma, least_noise(signal));
    if (channel.noise.unforetold() > rounding_unforetold * largest) return channel;
  }
  sigma = unseen_noise * (largest > 0.0 ? largest : 1.0);
  channel.noise = NoiseModel(sigma, 1.0);
  channel.noise_known = false;
  return channel;
}

void whiten(const FittedChannel& channel, std::span<double> of_used) {
  const NoiseModel noise = channel.one_by_one ? channel.noise.as_if_white() : channel.noise;
  std::size_t begin = 0;
  for (std::size_t i = 1; i <= channel.used.size(); ++i)
    if (i == channel.used.size() || channel.used[i] != channel.used[i - 1] + channel.every) {
      noise.whiten(of_used.subspan(begin, i - begin));
      begin = i;
    }
}

}  // namespace impactrig::fitting
