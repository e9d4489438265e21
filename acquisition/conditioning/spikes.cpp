// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/spikes.hpp"

#include <algorithm>
#include <cmath>

#include "acquisition/conditioning/background.hpp"

namespace impactrig::acquisition {

namespace {

constexpr double foot = 0.1, edge = 0.7;  // of a spike's height
constexpr std::size_t longest_square = 16;
constexpr std::size_t neighbours = 6;

/// Whether samples [begin, end) stand alone: they begin and end near their height, with all
/// neighbours at one level.
bool stand_alone(const Trace& trace, IndexRange spike, double level, double height) {
  const std::vector<double>& y = trace.values;
  if (spike.begin < neighbours || spike.end + neighbours > y.size()) return false;
  double highest = 0.0;
  for (std::size_t i = spike.begin; i < spike.end; ++i)
    highest = std::max(highest, (y[i] - level) / height);
  const auto is_high = [&](std::size_t i) { return (y[i] - level) / height > edge * highest; };
  const auto is_low = [&](std::size_t i) {
    return trace.is_valid(i) && std::abs(y[i] - level) < foot * highest * std::abs(height);
  };
  bool alone = is_high(spike.begin) && is_high(spike.end - 1);
  for (std::size_t k = 0; alone && k < neighbours; ++k)
    alone = is_low(spike.begin - 1 - k) && is_low(spike.end + k);
  return alone;
}

}  // namespace

std::optional<IndexRange> spike_among(const Trace& trace, const std::vector<Contact>& contacts) {
  constexpr std::size_t longest = 3;  // what a sample of noise becomes in a recorder's filter
  const std::size_t n = trace.values.size();
  for (const Contact& contact : contacts) {
    const auto part = [&](std::size_t i) {
      return (trace.values[i] - contact.baseline) / contact.peak;
    };
    IndexRange spike{contact.peak_index, contact.peak_index + 1};
    const auto grows = [&] { return spike.size() <= longest_square; };
    while (grows() && spike.begin > 0 && std::abs(part(spike.begin - 1)) >= foot) --spike.begin;
    while (grows() && spike.end < n && std::abs(part(spike.end)) >= foot) ++spike.end;
    const bool square = grows() && part(spike.begin) > edge && part(spike.end - 1) > edge;
    if ((spike.size() <= longest || square) && spike.begin > 0 && spike.end < n) return spike;
  }
  return std::nullopt;
}

std::optional<IndexRange> spike_after(const Trace& trace, const std::vector<Contact>& contacts,
                                      const DetectionOptions& options) {
  constexpr double of_peak = 0.05, of_noise = 12.0;
  const std::vector<double>& y = trace.values;
  if (y.size() < 4 * neighbours) return std::nullopt;
  const double noise = step_noise(y, trace.valid);
  const auto post = static_cast<std::size_t>(options.post_trigger / trace.interval);
  for (const Contact& contact : contacts) {
    const double least = std::max(of_peak * std::abs(contact.peak), of_noise * noise);
    const auto begin = std::max(static_cast<std::size_t>(contact.end) + 1, neighbours);
    const std::size_t end =
        std::min(static_cast<std::size_t>(contact.onset) + post + 1, y.size() - neighbours);
    for (std::size_t i = begin; i < end; ++i) {
      if (std::abs(y[i] - y[i - 1]) <= least) continue;
      const auto before = y.begin() + static_cast<std::ptrdiff_t>(i - neighbours);
      const double level = median({before, before + static_cast<std::ptrdiff_t>(neighbours)});
      const double height = y[i] - level;
      if (std::abs(height) <= least) continue;
      IndexRange spike{i, i + 1};
      while (spike.size() <= longest_square && spike.end < end &&
             (y[spike.end] - level) / height > 0.5)
        ++spike.end;
      if (spike.size() <= longest_square && stand_alone(trace, spike, level, height)) return spike;
    }
  }
  return std::nullopt;
}

}  // namespace impactrig::acquisition
