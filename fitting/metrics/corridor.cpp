// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/metrics/corridor.hpp"

#include <cmath>

namespace impactrig::fitting {

double corridor_score(const HistoryPair& pair) {
  require_comparable(pair);
  const double peak = peak_of(pair.measured);
  const double inner = 0.05 * peak, outer = 0.5 * peak;
  double sum = 0.0;
  for (std::size_t i = 0; i < pair.measured.size(); ++i) {
    const double away = std::abs(pair.computed[i] - pair.measured[i]);
    if (away < inner || away == 0.0) {
      sum += 1.0;
    } else if (away <= outer) {
      const double part = (outer - away) / (outer - inner);
      sum += part * part;
    }
  }
  return sum / static_cast<double>(pair.measured.size());
}

}  // namespace impactrig::fitting
