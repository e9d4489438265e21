// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/fit_diagnostics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "fitting/diagnostics/diagnose.hpp"

namespace impactrig::fitting {
namespace {

constexpr double family_level = 0.05;

ImpactPhases phases_of(const models::Simulation& prediction) {
  ImpactPhases out;
  if (prediction.episodes.empty()) return out;
  const models::Episode& first = prediction.episodes.front();
  out.end = first.end;
  out.deepest = first.peak_time;
  const models::History& history = prediction.history;
  double deepest = 0.0;
  for (std::size_t i = 0; i < history.penetration.size() && first.stop == 0; ++i) {
    const double t = history.start + history.interval * static_cast<double>(i);
    if (t > first.end || !(history.penetration[i] > deepest)) continue;
    deepest = history.penetration[i];
    out.deepest = t;
  }
  for (std::size_t i = 1; i < prediction.episodes.size(); ++i)
    out.later.push_back({prediction.episodes[i].start, prediction.episodes[i].end});
  return out;
}

double quantum_of(const datasets::Impact& impact, const std::string& quantity) {
  for (const auto* signal : {&impact.force, &impact.velocity, &impact.displacement})
    if (*signal && datasets::name((*signal)->quantity) == quantity) return (*signal)->quantum;
  return 0.0;
}

/// From the first to the last fitted sample.
ChannelResiduals residuals_of(const ChannelFit& channel) {
  ChannelResiduals out;
  out.quantity = channel.quantity;
  out.unit = channel.unit;
  out.noise_known = channel.noise > 0.0;
  const auto is_used = [](std::uint8_t used) { return used != 0; };
  const auto first = std::ranges::find_if(channel.used, is_used);
  if (first == channel.used.end() || channel.time.size() < 2) return out;
  const auto last = std::find_if(channel.used.rbegin(), channel.used.rend(), is_used);
  const auto from = static_cast<std::size_t>(first - channel.used.begin());
  const auto to = static_cast<std::size_t>(channel.used.rend() - last);
  out.start = channel.time[from];
  out.interval = (channel.time.back() - channel.time.front()) /
                 static_cast<double>(channel.time.size() - 1) * static_cast<double>(channel.every);
  for (std::size_t i = from; i < to; i += channel.every) {
    out.residual.push_back(channel.used[i] != 0 ? channel.measured[i] - channel.model[i]
                                                : std::numeric_limits<double>::quiet_NaN());
    out.model.push_back(channel.model[i]);
  }
  return out;
}

}  // namespace

ChannelDiagnostics diagnostics_of(const Fit& fit, const ChannelFit& channel) {
  const double level =
      family_level / static_cast<double>(std::max<std::size_t>(1, fit.channels.size()));
  const auto recording = static_cast<std::size_t>(channel.recording);
  ChannelResiduals residuals = residuals_of(channel);
  residuals.quantum = quantum_of(fit.impacts.at(recording), channel.quantity);
  residuals.phases = phases_of(fit.predictions.at(recording));
  return diagnose(residuals, level);
}

}  // namespace impactrig::fitting
