// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/trace.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "datasets/input_error.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::InputError;

void refuse_unusable_clock(const Channel& channel, const std::string& file) {
  const auto refuse = [&](const std::string& problem) {
    throw InputError(whole_file(file), fmt::format("channel '{}' {}", channel.name, problem));
  };
  if (channel.complex())
    refuse("holds complex numbers, so it is a spectrum; choose a channel that is a time history");
  if (channel.size() == 0) refuse("has no samples; choose another channel");
  if (!channel.clock.uniform()) {
    const std::vector<double>& times = channel.clock.times;
    double shortest = channel.clock.interval, longest = channel.clock.interval;
    for (std::size_t i = 1; i < times.size(); ++i) {
      shortest = std::min(shortest, times[i] - times[i - 1]);
      longest = std::max(longest, times[i] - times[i - 1]);
    }
    refuse(
        fmt::format("is sampled at uneven times (steps from {:.6g} s to {:.6g} s); resample it "
                    "(step = \"resample\" in a map for `impactrig import`), or state the sample "
                    "rate when importing",
                    shortest, longest));
  }
  if (!(channel.clock.interval > 0.0) || !std::isfinite(channel.clock.interval))
    refuse(fmt::format("has a sample interval of {:.12g} s; state the sample rate when importing",
                       channel.clock.interval));
}

void bridge_invalid(std::vector<double>& values, const std::vector<std::uint8_t>& valid) {
  if (valid.empty()) return;
  const std::size_t n = values.size();
  for (std::size_t i = 0; i < n; ++i) {
    if (valid[i] != 0) continue;
    std::size_t end = i;
    while (end < n && valid[end] == 0) ++end;
    const double left = i > 0 ? values[i - 1] : values[end];
    const double right = end < n ? values[end] : left;
    const double steps = static_cast<double>(end - i + 1);
    for (std::size_t k = i; k < end; ++k)
      values[k] = left + (right - left) * static_cast<double>(k - i + 1) / steps;
    i = end;
  }
}

bool has_sound_sample(const Channel& channel) {
  for (std::size_t i = 0; i < channel.size(); ++i)
    if (channel.is_valid(i) && std::isfinite(channel.value(i))) return true;
  return false;
}

Trace trace_of(const Channel& channel, const std::string& file) {
  refuse_unusable_clock(channel, file);
  const auto to_si = datasets::conversion(channel.unit, si_unit(channel.quantity));
  if (!to_si)
    throw InputError(whole_file(file),
                     fmt::format("channel '{}' is in '{}', which is no unit of {}; "
                                 "state its unit when importing",
                                 channel.name, channel.unit, name(channel.quantity)));
  Trace trace;
  trace.quantity = channel.quantity;
  trace.start = channel.clock.start;
  trace.interval = channel.clock.interval;
  trace.values = channel.values();
  trace.valid = channel.valid;
  bool any_sound = false;
  for (std::size_t i = 0; i < trace.values.size(); ++i) {
    double& value = trace.values[i];
    value = to_si->factor * value + to_si->offset;
    if (!std::isfinite(value)) {
      if (trace.valid.empty()) trace.valid.assign(trace.values.size(), 1);
      trace.valid[i] = 0;
    }
    any_sound = any_sound || trace.is_valid(i);
  }
  if (!any_sound)
    throw InputError(
        whole_file(file),
        fmt::format("channel '{}' has no sound sample; choose another channel", channel.name));
  bridge_invalid(trace.values, trace.valid);
  return trace;
}

}  // namespace impactrig::acquisition
