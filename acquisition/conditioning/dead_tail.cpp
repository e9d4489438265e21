// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/dead_tail.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "acquisition/conditioning/background.hpp"

namespace impactrig::acquisition {

namespace {

constexpr std::size_t fewest = 64;   // equal samples
constexpr std::size_t further = 16;  // of a stretch before one that is dead
constexpr std::size_t alive = 64;    // samples that show noise

/// Of up to 2^16 fourth differences, of which a smooth course leaves hardly anything.
double white_noise(std::span<const double> y) {
  constexpr std::size_t most = std::size_t{1} << 16;
  const std::size_t stride = 1 + y.size() / most;
  std::vector<double> sizes;
  for (std::size_t i = 4; i < y.size(); i += stride)
    sizes.push_back(std::abs(y[i] - 4.0 * y[i - 1] + 6.0 * y[i - 2] - 4.0 * y[i - 3] + y[i - 4]));
  return normal_mad * median(std::move(sizes)) / std::sqrt(70.0);
}

/// Where the samples before `end` that have the last one's value begin.
std::size_t begin_of_run(std::span<const double> y, std::size_t end) {
  std::size_t begin = end - 1;
  while (begin > 0 && y[begin - 1] == y[end - 1]) --begin;
  return begin;
}

}  // namespace

void mark_dead_tail(double quantum, Trace& trace) {
  constexpr double of_span = 1e-3, least_noise = 1e-6;
  const std::span<const double> y(trace.values);
  if (y.size() < fewest + alive) return;
  const auto [least, most] = std::ranges::minmax(y);
  const auto on_rail = [&, low = least, high = most](double value) {
    return (value == low || value == high) && std::abs(value) > of_span * (high - low);
  };
  std::size_t dead = y.size();
  for (std::size_t count = fewest; dead > 0; count = further) {
    const std::size_t begin = begin_of_run(y, dead);
    if (dead - begin < count || on_rail(y[begin])) break;
    dead = begin;
  }
  if (dead == y.size() || dead < alive) return;
  if (!(white_noise(y.first(dead)) > std::max(0.75 * quantum, least_noise * (most - least))))
    return;
  if (trace.valid.empty()) trace.valid.assign(y.size(), 1);
  std::fill(trace.valid.begin() + static_cast<std::ptrdiff_t>(dead), trace.valid.end(), 0);
  bridge_invalid(trace.values, trace.valid);
}

}  // namespace impactrig::acquisition
