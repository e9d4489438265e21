// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/metrics/cora.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "fitting/metrics/corridor.hpp"

namespace impactrig::fitting {
namespace {

/// Sums over the overlap at a shift.
struct Overlap {
  double mm = 0.0, cc = 0.0, mc = 0.0;

  double correlation() const { return mm > 0.0 && cc > 0.0 ? mc / std::sqrt(mm * cc) : 0.0; }
};

Overlap overlap_at(const HistoryPair& pair, std::ptrdiff_t shift) {
  using Vector = Eigen::Map<const Eigen::VectorXd>;
  const std::ptrdiff_t away = std::abs(shift);
  const auto length = static_cast<Eigen::Index>(pair.measured.size()) - away;
  const Vector m(pair.measured.data() + (shift > 0 ? 0 : away), length);
  const Vector c(pair.computed.data() + (shift > 0 ? away : 0), length);
  return {m.squaredNorm(), c.squaredNorm(), m.dot(c)};
}

}  // namespace

Cora cora(const HistoryPair& pair) {
  require_comparable(pair, 2);
  constexpr double improvement = 1e-12, nan = std::numeric_limits<double>::quiet_NaN();
  Cora result;
  result.corridor = corridor_score(pair);
  Overlap best = overlap_at(pair, 0);
  if (!(best.mm > 0.0)) return {result.corridor, nan, nan, nan, nan, nan, 0};
  const auto farthest = static_cast<std::ptrdiff_t>(pair.measured.size() / 5);
  for (std::ptrdiff_t n = 1; n <= farthest; ++n)
    for (const std::ptrdiff_t shift : {n, -n}) {
      const Overlap found = overlap_at(pair, shift);
      if (!(found.correlation() > best.correlation() + improvement)) continue;
      best = found;
      result.shift = shift;
    }
  result.progression = std::pow(0.5 * (best.correlation() + 1.0), 10);
  const double part =
      static_cast<double>(std::abs(result.shift)) / static_cast<double>(pair.measured.size());
  result.phase = std::clamp((0.12 - part) / (0.12 - 0.01), 0.0, 1.0);
  result.size =
      best.mm > 0.0 && best.cc > 0.0 ? std::min(best.cc / best.mm, best.mm / best.cc) : 0.0;
  result.cross_correlation = 0.5 * result.progression + 0.25 * result.phase + 0.25 * result.size;
  result.rating = 0.5 * result.corridor + 0.5 * result.cross_correlation;
  return result;
}

}  // namespace impactrig::fitting
