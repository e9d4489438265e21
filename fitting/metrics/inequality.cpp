// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/metrics/inequality.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace impactrig::fitting {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

double ratio(double above, double below) {
  return below > 0.0 ? above / below : nan;
}

/// Σ|x|, Σ|y| and Σ|y − x|.
struct AbsoluteSums {
  double measured = 0.0, computed = 0.0, difference = 0.0;
};

AbsoluteSums absolute_sums(const HistoryPair& pair) {
  AbsoluteSums sums;
  for (std::size_t i = 0; i < pair.measured.size(); ++i) {
    sums.measured += std::abs(pair.measured[i]);
    sums.computed += std::abs(pair.computed[i]);
    sums.difference += std::abs(pair.computed[i] - pair.measured[i]);
  }
  return sums;
}

}  // namespace

double theil_u(const HistoryPair& pair) {
  require_comparable(pair);
  return ratio(norm_of_difference(pair), norm_of(pair.measured) + norm_of(pair.computed));
}

double whang(const HistoryPair& pair) {
  require_comparable(pair);
  const AbsoluteSums sums = absolute_sums(pair);
  return ratio(sums.difference, sums.computed + sums.measured);
}

double zilliacus(const HistoryPair& pair) {
  require_comparable(pair);
  const AbsoluteSums sums = absolute_sums(pair);
  return ratio(sums.difference, sums.measured);
}

double rss_factor(const HistoryPair& pair) {
  require_comparable(pair);
  return ratio(norm_of_difference(pair), norm_of(pair.measured));
}

double weighted_integrated_factor(const HistoryPair& pair) {
  require_comparable(pair);
  const double scale = std::max(peak_of(pair.measured), peak_of(pair.computed));
  double error = 0.0, size = 0.0;
  for (std::size_t i = 0; i < pair.measured.size(); ++i) {
    const double m = pair.measured[i] / scale, c = pair.computed[i] / scale;
    const double larger = std::max(m * m, c * c);
    if (!(larger > 0.0)) continue;
    const double factor = 1.0 - std::max(0.0, m * c) / larger;
    error += larger * factor * factor;
    size += larger;
  }
  return std::sqrt(ratio(error, size));
}

}  // namespace impactrig::fitting
