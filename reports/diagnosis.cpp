// SPDX-License-Identifier: BSD-3-Clause
#include "reports/diagnosis.hpp"

#include <cmath>

#include <fmt/format.h>

#include "reports/numbers.hpp"

namespace impactrig::reports {

namespace {

/// How far beyond noise: the largest level of a phase.
double worst_ratio(const fitting::ChannelDiagnostics& diagnostics) {
  double out = 0.0;
  for (const fitting::PhaseLevel& level : diagnostics.phases) out = std::max(out, level.ratio);
  return out;
}

}  // namespace

std::string discrepancy_sentence(const fitting::ChannelFit& channel) {
  if (!channel.diagnostics || !channel.diagnostics->judged || channel.diagnostics->coarse)
    return "";
  const fitting::Discrepancy& found = channel.diagnostics->discrepancy;
  if (!found.significant)
    return fmt::format(
        "No smooth part of the {} that the model leaves out stands out of the noise.",
        channel.quantity);
  const RoundedValue largest = rounded(found.largest, found.largest_error, channel.unit);
  return fmt::format(
      "The model leaves out of the {} up to {}{} {}, {} after touch, and {} (rms) over the fitted "
      "time; what is left out changes within some {}.",
      channel.quantity, largest.value, largest.error.empty() ? "" : " ± " + largest.error,
      largest.unit, quantity(found.largest_time, "s"), quantity(found.rms, channel.unit, 2),
      quantity(found.length, "s", 2));
}

bool any_unsound(const fitting::Fit& fit) {
  for (const fitting::ChannelFit& channel : fit.channels)
    if (channel.diagnostics && channel.diagnostics->judged && !channel.diagnostics->sound)
      return true;
  return false;
}

std::string diagnosis_summary(const fitting::Fit& fit) {
  const fitting::ChannelFit* worst = nullptr;
  std::size_t judged = 0;
  for (const fitting::ChannelFit& channel : fit.channels) {
    if (!channel.diagnostics || !channel.diagnostics->judged) continue;
    ++judged;
    if (channel.diagnostics->sound) continue;
    if (worst == nullptr || worst_ratio(*channel.diagnostics) > worst_ratio(*worst->diagnostics))
      worst = &channel;
  }
  if (worst != nullptr) return worst->diagnostics->sentence;
  if (judged == 0 || judged < fit.channels.size()) return "";
  return "What is left of every channel is what its noise before touch leads to expect.";
}

}  // namespace impactrig::reports
