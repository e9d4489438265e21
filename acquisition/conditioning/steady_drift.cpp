// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/steady_drift.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace impactrig::acquisition {

std::optional<QuietFit> steady_drift(const Trace& trace, double grain) {
  constexpr std::size_t fewest = 256, most = 4096;
  constexpr double matters = 0.05, like_noise = 1.5, hardly = 0.02, significant = 8.0;
  const std::vector<double>& y = trace.values;
  if (y.size() < fewest) return std::nullopt;
  // the course of a few samples first: most records have none
  const std::vector<double> few = evenly_spread(y, most);
  const QuietFit rough = fit_quiet(few, 0, few.size(), 1, 0.0);
  const double way = 2.0 * std::abs(rough.coefficients[1]);
  if (way <= significant * rough.sigma) return std::nullopt;
  const QuietFit line = fit_quiet(y, 0, y.size(), 1, grain, trace.valid);
  const double noise = std::max(step_noise(y, trace.valid), grain);
  if (line.sigma > std::max(like_noise * noise, hardly * way)) return std::nullopt;
  double highest = 0.0;
  for (std::size_t i = 0; i < y.size(); ++i)
    highest = std::max(highest, std::abs(y[i] - line.at(static_cast<double>(i))));
  return way > matters * highest ? std::optional(line) : std::nullopt;
}

}  // namespace impactrig::acquisition
