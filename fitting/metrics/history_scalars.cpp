// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/metrics/history_scalars.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace impactrig::fitting {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Samples from where |x| rises to a threshold round the peak to where it falls to it again.
double width_at(std::span<const double> x, std::size_t peak, double threshold) {
  std::size_t first = peak, last = peak;
  while (first > 0 && std::abs(x[first - 1]) >= threshold) --first;
  while (last + 1 < x.size() && std::abs(x[last + 1]) >= threshold) ++last;
  if (first == 0 || last + 1 == x.size()) return nan;
  const auto outside = [&](std::size_t in, std::size_t out) {
    return (std::abs(x[in]) - threshold) / (std::abs(x[in]) - std::abs(x[out]));
  };
  return static_cast<double>(last - first) + outside(first, first - 1) + outside(last, last + 1);
}

}  // namespace

HistoryScalars history_scalars(std::span<const double> x, double start, double interval) {
  if (x.empty()) throw std::invalid_argument("a history without samples has no peak");
  constexpr double share = 0.05;
  const auto largest =
      std::ranges::max_element(x, {}, [](double value) { return std::abs(value); });
  const auto at = static_cast<std::size_t>(largest - x.begin());
  HistoryScalars result;
  result.peak = *largest;
  result.peak_time = start + interval * static_cast<double>(at);
  result.impulse = interval * std::accumulate(x.begin(), x.end(), 0.0);
  result.duration = *largest == 0.0 ? nan : interval * width_at(x, at, share * std::abs(*largest));
  return result;
}

}  // namespace impactrig::fitting
