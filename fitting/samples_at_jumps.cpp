// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/samples_at_jumps.hpp"

#include <algorithm>
#include <cmath>

namespace impactrig::fitting {
namespace {

// How far from a jump a sample may show either side of it, in samples; while a search is far off.
constexpr double beside_jump = 1.0, rough_beside_jump = 8.0;

}  // namespace

SamplesAtJumps::SamplesAtJumps(const FittedChannel& channel, const Measurement& measurement,
                               const Shown::Curve& curve, bool rough)
    : channel_(channel),
      shift_(measurement.shift),
      jumps_(curve.jumps.size()) {
  const double near = (rough ? rough_beside_jump : beside_jump) * channel.signal->interval;
  for (std::size_t jump = 0; jump < curve.jumps.size(); ++jump)
    look_beside(jump, measurement.gain, curve, near);
}

void SamplesAtJumps::look_beside(std::size_t jump, double gain, const Shown::Curve& curve,
                                 double near) {
  const datasets::ImpactSignal& signal = *channel_.signal;
  const double time = curve.jumps[jump].time;
  const double first = (time + shift_ - near - signal.start) / signal.interval;
  const auto end = static_cast<double>(signal.values.size());
  for (double k = std::max(0.0, std::ceil(first)); k < end; ++k) {
    const auto sample = static_cast<std::size_t>(k);
    const double t = signal.time(sample) - shift_;
    if (t > time + near) break;
    const auto off = [&](std::size_t piece) {
      return std::abs(channel_.measured[sample] - gain * curve.at(t, piece)[0]);
    };
    const std::size_t here = curve.piece_at(t);
    if (here != jump && here != jump + 1) continue;
    const std::size_t other = here == jump ? jump + 1 : jump;
    if (off(other) < off(here)) elsewhere_.push_back({sample, other});
  }
}

std::array<double, 2> SamplesAtJumps::at(const Shown::Curve& curve, std::size_t sample) const {
  const double t = channel_.signal->time(sample) - shift_;
  if (curve.jumps.size() != jumps_) return curve.at(t);
  for (const auto& [number, piece] : elsewhere_)
    if (number == sample) return curve.at(t, piece);
  return curve.at(t);
}

}  // namespace impactrig::fitting
