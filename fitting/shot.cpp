// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/shot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "fitting/filtered_samples.hpp"

namespace impactrig::fitting {
namespace {

using datasets::Impact;
using datasets::ImpactFlag;
using datasets::ImpactSignal;

constexpr double margin_least = 20e-6;  // [s]

/// Where the noise does not reach from one step of the digitiser to the next, samples that stay on
/// a step say the same, that the signal is somewhere on it: of so many or more in a row the middle
/// one is taken for all.
constexpr std::size_t least_on_a_step = 4;

void take_steps_once(FittedChannel& channel) {
  const ImpactSignal& signal = *channel.signal;
  if (!within_steps(signal) || channel.every > 1) return;
  std::vector<std::size_t> taken;
  const std::vector<std::size_t>& used = channel.used;
  for (std::size_t begin = 0, end = 0; begin < used.size(); begin = end) {
    while (end < used.size() && used[end] - used[begin] == end - begin &&
           std::abs(channel.measured[used[end]] - channel.measured[used[begin]]) <
               0.5 * signal.quantum)
      ++end;
    if (end - begin < least_on_a_step)
      taken.insert(taken.end(), used.begin() + static_cast<std::ptrdiff_t>(begin),
                   used.begin() + static_cast<std::ptrdiff_t>(end));
    else
      taken.push_back(used[(begin + end) / 2]);
  }
  channel.used = std::move(taken);
}

double ceiling_of(const Impact& impact, const ImpactSignal& signal) {
  const bool told_by_flag_alone = impact.has(ImpactFlag::clipped) && signal.valid.empty() &&
                                  signal.quantity == datasets::Quantity::force;
  if (!told_by_flag_alone) return std::numeric_limits<double>::infinity();
  return 0.999 * *std::ranges::max_element(signal.values);
}

}  // namespace

double margin_of(const Shot& shot) {
  return std::max(margin_least, margin_part * shot.contact) + shot.reach;
}

void choose_samples(Shot& shot, double contacts, bool one_by_one) {
  const double window = std::min(shot.window, contacts * shot.contact);
  shot.model->set_end(window + margin_of(shot));
  for (FittedChannel& channel : shot.channels) {
    const ImpactSignal& signal = *channel.signal;
    const double ceiling = ceiling_of(*shot.impact, signal);
    channel.one_by_one = one_by_one;
    channel.used.clear();
    const bool clipped = shot.impact->has(ImpactFlag::clipped);
    for (std::size_t k = 0; k < signal.values.size(); k += channel.every)
      if (signal.time(k) <= shot.impact->start + window && channel.sound[k] &&
          (signal.values[k] < ceiling || !clipped))
        channel.used.push_back(k);
    take_steps_once(channel);
  }
}

void refuse_all_made_up(const Shot& shot) {
  for (const FittedChannel& channel : shot.channels) {
    const ImpactSignal& signal = *channel.signal;
    bool any = signal.filters.empty();
    for (std::size_t k = 0; k < signal.values.size() && !any; k += channel.every)
      any = channel.sound[k] && signal.time(k) > shot.impact->start &&
            signal.time(k) <= shot.impact->start + shot.window;
    if (any) continue;
    throw std::invalid_argument(fmt::format(
        "{} of {} went through a filter that reaches {:.3g} s to either side, over an end of the "
        "record or to a sample that is not valid from everywhere in the fitted window: what it "
        "made of those is no measurement. Filter at a higher cutoff, or leave the step out",
        signal.channel, shot.impact->recording, reach_of(signal)));
  }
}

}  // namespace impactrig::fitting
