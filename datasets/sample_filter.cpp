// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/sample_filter.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>

#include "datasets/band_limited.hpp"
#include "datasets/zero_phase_low_pass.hpp"

namespace impactrig::datasets {
namespace {

constexpr double forgotten = 11.5;  // time constants to 1e-5
// Instants a period of the highest frequency that passes: cubics between them are off by 6e-4 of
// its amplitude, and by the fourth power less of lower ones.
constexpr double grid_in_pass_band = 16.0;

/// How many of the old samples a new one stands for.
double stretch_of(const Resample& action, double interval) {
  return std::max(1.0, 1.0 / (action.rate * interval));
}

/// Values every `interval` from the curve's start on; spikes as plateaus over `width` of them.
std::vector<double> resolved(const SampledCurve& curve, double interval, double width) {
  const double length = curve.interval * (static_cast<double>(curve.values.size()) - 1.0);
  std::vector<double> values(static_cast<std::size_t>(length / interval * (1.0 + 1e-12)) + 1);
  const auto count = static_cast<double>(values.size());
  for (double k = 0.0; k < count; ++k)
    values[static_cast<std::size_t>(k)] = curve.at(curve.start + interval * k)[0];
  for (const CurveSpike& spike : curve.spikes) {
    const double middle = (spike.time - curve.start) / interval;
    const double low = middle - 0.5 * width, high = middle + 0.5 * width;
    for (double k = std::max(0.0, std::ceil(low - 0.5)); k < std::min(count, high + 0.5); ++k) {
      const double share = std::min(k + 0.5, high) - std::max(k - 0.5, low);
      values[static_cast<std::size_t>(k)] += share * spike.area / (interval * width);
    }
  }
  return values;
}

std::vector<double> filtered(const LowPass& action, double interval,
                             const std::vector<double>& record) {
  return zero_phase_low_pass(record, interval, action);
}

/// At the old instants.
std::vector<double> filtered(const Resample& action, double interval,
                             const std::vector<double>& record) {
  return BandLimited(record, stretch_of(action, interval)).at_samples();
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

SampledCurve SampleFilter::of(const SampledCurve& curve) const {
  // A jump is where the samples show it, to a step of the grid; all else is as slow as the filter.
  const double slow = curve.jumps.empty() ? 1.0 / (grid_in_pass_band * pass_band()) : 0.0;
  const double parts =
      std::max(1.0, std::ceil(interval / std::max(curve.interval, slow) * (1.0 - 1e-9)));
  const auto phases = static_cast<std::size_t>(parts);
  std::vector<double> values = resolved(curve, interval / parts, parts);
  for (std::size_t phase = 0; phase < std::min(phases, values.size()); ++phase) {
    std::vector<double> record;
    for (std::size_t k = phase; k < values.size(); k += phases) record.push_back(values[k]);
    record = std::visit([&](const auto& a) { return filtered(a, interval, record); }, action);
    for (std::size_t i = 0; i < record.size(); ++i) values[phase + i * phases] = record[i];
  }
  return {curve.start, interval / parts, std::move(values)};
}

std::optional<std::vector<SampleFilter>> filters_of(const Record& record, const Channel& channel) {
  std::vector<SampleFilter> filters;
  std::string name = channel.name;
  double interval = channel.clock.interval;
  for (auto edit = record.provenance.edits.rbegin(); edit != record.provenance.edits.rend();
       ++edit) {
    const auto made = edit->parameters.find("result");
    if (made != edit->parameters.end() && made->second == name) name = edit->channel;
    if (edit->channel != name) continue;
    if (edit->what == "low-pass, zero phase") {
      const auto action = low_pass_of(*edit, interval);
      if (!action) return std::nullopt;
      filters.push_back({*action, interval});
    } else if (edit->what == "resample") {
      const auto from = frequency_in(edit->parameters, "from");
      const auto to = frequency_in(edit->parameters, "to");
      if (!from || !to) return std::nullopt;
      interval = 1.0 / *from;
      filters.push_back({Resample{*to}, interval});
    } else if (const auto old = edit->parameters.find("name in file");
               edit->what == "map channel" && old != edit->parameters.end()) {
      name = old->second;
    }
  }
  std::ranges::reverse(filters);
  return filters;
}

}  // namespace impactrig::datasets
