// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/metrics/history_pair.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace impactrig::fitting {

void require_comparable(const HistoryPair& pair, std::size_t fewest) {
  if (pair.measured.size() != pair.computed.size())
    throw std::invalid_argument(
        fmt::format("histories to be compared must be of one length, found {} and {} samples",
                    pair.measured.size(), pair.computed.size()));
  if (pair.measured.size() < fewest)
    throw std::invalid_argument(
        fmt::format("at least {} samples are needed, found {}", fewest, pair.measured.size()));
  const auto finite = [](double x) { return std::isfinite(x); };
  if (!std::ranges::all_of(pair.measured, finite) || !std::ranges::all_of(pair.computed, finite))
    throw std::invalid_argument("histories to be compared must be finite");
}

double peak_of(std::span<const double> x) {
  double peak = 0.0;
  for (const double value : x) peak = std::max(peak, std::abs(value));
  return peak;
}

double norm_of(std::span<const double> x) {
  const double peak = peak_of(x);
  if (peak == 0.0) return 0.0;
  double sum = 0.0;
  for (const double value : x) sum += (value / peak) * (value / peak);
  return peak * std::sqrt(sum);
}

double norm_of_difference(const HistoryPair& pair) {
  std::vector<double> difference(pair.measured.size());
  for (std::size_t i = 0; i < difference.size(); ++i)
    difference[i] = pair.computed[i] - pair.measured[i];
  return norm_of(difference);
}

}  // namespace impactrig::fitting
