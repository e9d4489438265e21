// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/swapped_channels.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "acquisition/conditioning/background.hpp"
#include "acquisition/conditioning/contact_search.hpp"

namespace impactrig::acquisition {

namespace {

// An offset or a drift is a few percent of a signal, and so is ringing after a contact; a bar has a
// speed of the order of what it spans.
constexpr double at_rest = 0.05;  ///< of the span: a signal is at zero
constexpr double away = 0.1;      ///< of the span: a signal is off a level

/// The samples between two times, both included.
std::vector<double> between(const Trace& trace, double from, double to) {
  const double last = static_cast<double>(trace.values.size());
  const double first = std::clamp(std::ceil(trace.index(from)), 0.0, last);
  const double end = std::clamp(std::floor(trace.index(to)) + 1.0, first, last);
  return {trace.values.begin() + static_cast<std::ptrdiff_t>(first),
          trace.values.begin() + static_cast<std::ptrdiff_t>(end)};
}

double span_of(const Trace& trace) {
  const auto [least, most] = std::ranges::minmax(trace.values);
  return most - least;
}

}  // namespace

bool look_swapped(const Trace& force, const Trace& velocity, const DetectionOptions& options) {
  constexpr std::size_t fewest = 8;
  const double force_span = span_of(force), velocity_span = span_of(velocity);
  if (!(force_span > 0.0) || !(velocity_span > 0.0)) return false;
  // What begins as it should is not searched.
  const std::size_t head = std::max(fewest, velocity.values.size() / 20);
  if (velocity.values.size() < 4 * head) return false;
  const std::vector<double> first(velocity.values.begin(),
                                  velocity.values.begin() + static_cast<std::ptrdiff_t>(head));
  if (std::abs(median(first)) > at_rest * velocity_span) return false;

  const std::vector<Contact> pulses = find_pulses(velocity, options);
  if (pulses.empty()) return false;
  const Contact& pulse = pulses.front();
  if (pulse.begins_inside || pulse.ends_inside ||
      std::abs(pulse.baseline) > at_rest * std::abs(pulse.peak))
    return false;
  const double begin = velocity.time(pulse.onset), end = velocity.time(pulse.end);
  const double width = pulse.width * velocity.interval;
  const std::vector<double> before = between(force, begin - options.before(), begin - width / 4);
  const std::vector<double> after = between(force, end, end + 3.0 * width);
  if (before.size() < fewest || after.size() < fewest) return false;
  const double level = median(before);
  const auto off = static_cast<std::size_t>(std::ranges::count_if(
      after, [&](double value) { return std::abs(value - level) > away * force_span; }));
  return std::abs(level) > away * force_span && 2 * off > after.size();
}

}  // namespace impactrig::acquisition
