// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/filtered_samples.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace impactrig::fitting {

using datasets::ImpactSignal;

namespace {

/// The lowest of all filters' [Hz].
double pass_band_of(const ImpactSignal& signal) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const datasets::SampleFilter& filter : signal.filters)
    lowest = std::min(lowest, filter.pass_band());
  return lowest;
}

}  // namespace

double reach_of(const ImpactSignal& signal) {
  double reach = 0.0;
  for (const datasets::SampleFilter& filter : signal.filters) reach += filter.reach();
  return reach;
}

std::vector<std::uint8_t> sound_samples(const ImpactSignal& signal) {
  const std::size_t count = signal.values.size();
  const double reach = reach_of(signal);
  const auto near = static_cast<std::size_t>(reach / signal.interval);
  std::vector<std::uint8_t> sound(count, 1);
  for (std::size_t k = 0; k < count; ++k) {
    const double t = signal.time(k);
    if (reach > 0.0 && (t < signal.recorded.begin + reach || t > signal.recorded.end - reach))
      sound[k] = 0;
    if ((signal.valid.empty() || signal.valid[k]) && std::isfinite(signal.values[k])) continue;
    const std::size_t first = k - std::min(k, near), last = std::min(count, k + near + 1);
    std::fill(sound.begin() + static_cast<std::ptrdiff_t>(first),
              sound.begin() + static_cast<std::ptrdiff_t>(last), std::uint8_t{0});
  }
  return sound;
}

std::size_t every_of(const ImpactSignal& signal) {
  const double every = std::ceil(0.5 / (pass_band_of(signal) * signal.interval) * (1.0 - 1e-9));
  return static_cast<std::size_t>(std::max(1.0, every));
}

std::string thinning_sentence(const ImpactSignal& signal) {
  return fmt::format(
      "in the fit: of {} one sample in {}, since what its filters pass, up to {:.4g} Hz, ties "
      "those "
      "between to these",
      signal.channel, every_of(signal), pass_band_of(signal));
}

}  // namespace impactrig::fitting
