// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/shot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "fitting/filtered_samples.hpp"

namespace impactrig::fitting {
namespace {

using datasets::Impact;
using datasets::ImpactFlag;
using datasets::ImpactSignal;

constexpr double margin_least = 20e-6;  // [s]

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
