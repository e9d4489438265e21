// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/sample_filter.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>
#include <utility>

#include "datasets/band_limited.hpp"
#include "datasets/zero_phase_low_pass.hpp"

namespace impactrig::datasets {
namespace {

constexpr double forgotten = 11.5;  // time constants to 1e-5
constexpr double on_grid = 1e-6;    // of a sample: rounding of what lies on it

constexpr double same_rate = 1e-11;  // as the numbers in an edit tell it

/// How many of the old samples a new one stands for.
double stretch_of(const Resample& action, double interval) {
  return std::max(1.0, 1.0 / (action.rate * interval));
}

GridSamples filtered(const LowPass& action, double interval, GridSamples samples) {
  return {samples.first, zero_phase_low_pass(samples.values, interval, action)};
}

GridSamples filtered(const Resample& action, double interval, const GridSamples& samples) {
  const double ratio = 1.0 / (action.rate * interval);
  const auto begin = static_cast<double>(samples.first);
  const double end = begin + static_cast<double>(samples.values.size()) - 1.0;
  const double first = std::ceil(begin / ratio - on_grid);
  const BandLimited signal(samples.values, stretch_of(action, interval));
  GridSamples result{.first = static_cast<std::ptrdiff_t>(first), .values = {}};
  for (double k = first; k * ratio <= end + on_grid; ++k)
    result.values.push_back(signal(ratio * k - begin));
  return result;
}

/// The number in "50000 Hz".
std::optional<double> frequency_in(const std::map<std::string, std::string>& parameters,
                                   const std::string& key) {
  const auto found = parameters.find(key);
  if (found == parameters.end()) return std::nullopt;
  const char* const end = found->second.data() + found->second.size();
  double value = 0.0;
  const auto [rest, error] = std::from_chars(found->second.data(), end, value);
  if (error != std::errc{} || std::string(rest, end) != " Hz" || !(value > 0.0))
    return std::nullopt;
  return value;
}

std::optional<LowPass> low_pass_of(const Edit& edit, double interval) {
  const auto cutoff = frequency_in(edit.parameters, "cutoff");
  const auto order = edit.parameters.find("order");
  LowPass action;
  if (!cutoff || order == edit.parameters.end()) return std::nullopt;
  const std::string& text = order->second;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), action.order);
  const bool possible = action.order >= 1 && action.order <= 8 && *cutoff * interval < 0.5;
  if (read.ec != std::errc{} || !possible) return std::nullopt;
  action.cutoff = *cutoff;
  return action;
}

}  // namespace

double SampleFilter::reach() const {
  if (const auto* const low_pass = std::get_if<LowPass>(&action))
    return forgotten * interval * low_pass_memory(*low_pass, interval);
  return BandLimited::crossings / BandLimited::cutoff * interval *
         stretch_of(std::get<Resample>(action), interval);
}

double SampleFilter::pass_band() const {
  if (const auto* const low_pass = std::get_if<LowPass>(&action)) return low_pass->cutoff;
  return BandLimited::cutoff * 0.5 / (interval * stretch_of(std::get<Resample>(action), interval));
}

GridSamples SampleFilter::of(GridSamples samples) const {
  return std::visit([&](const auto& a) { return filtered(a, interval, std::move(samples)); },
                    action);
}

std::optional<std::vector<SampleFilter>> filters_of(const Record& record, const Channel& channel) {
  std::vector<SampleFilter> filters;
  double interval = channel.clock.interval;
  std::vector<const Edit*> edits = edits_of(record, channel);
  std::ranges::reverse(edits);  // from the channel's own interval back
  for (const Edit* const edit : edits) {
    if (edit->what == "low-pass, zero phase") {
      const auto action = low_pass_of(*edit, interval);
      if (!action) return std::nullopt;
      filters.push_back({*action, interval});
    } else if (edit->what == "resample") {
      const auto from = frequency_in(edit->parameters, "from");
      const auto to = frequency_in(edit->parameters, "to");
      if (!from || !to) return std::nullopt;
      interval = 1.0 / *from;
      if (std::abs(*to / *from - 1.0) < same_rate) continue;  // left as they were
      filters.push_back({Resample{*to}, interval});
    }
  }
  std::ranges::reverse(filters);
  return filters;
}

}  // namespace impactrig::datasets
