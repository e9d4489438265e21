// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/metrics/comparison.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "fitting/metrics/inequality.hpp"

namespace impactrig::fitting {

Comparison compare_histories(const HistoryPair& pair, double start, double interval,
                             std::size_t rated) {
  require_comparable(pair, 2);
  if (!(interval > 0.0) || !std::isfinite(interval) || !std::isfinite(start))
    throw std::invalid_argument("a sample interval must be greater than zero");
  if (peak_of(pair.measured) == 0.0)
    throw std::invalid_argument(
        "the measured history is zero throughout, and nothing can be told in parts of it");
  Comparison result;
  result.samples = pair.measured.size();
  result.sprague_geers = sprague_geers(pair);
  result.geers_1984 = geers_1984(pair);
  result.russell = russell(pair);
  result.knowles_gear = knowles_gear(pair, interval);
  result.theil_u = theil_u(pair);
  result.whang = whang(pair);
  result.zilliacus = zilliacus(pair);
  result.rss_factor = rss_factor(pair);
  result.weighted_integrated_factor = weighted_integrated_factor(pair);
  result.correlation = correlation(pair);
  result.r_squared = r_squared(pair);
  result.error = root_mean_square_error(pair);
  result.residuals = residual_analysis(pair);
  if (result.samples <= rated) {
    result.iso18571 = iso18571(pair);
    result.cora = cora(pair);
  }
  result.measured = history_scalars(pair.measured, start, interval);
  result.computed = history_scalars(pair.computed, start, interval);
  return result;
}

double impulse_ratio(const HistoryPair& pair) {
  require_comparable(pair);
  double m_sum = 0.0, m_size = 0.0, c_sum = 0.0;
  for (std::size_t i = 0; i < pair.measured.size(); ++i) {
    m_sum += pair.measured[i];
    m_size += std::abs(pair.measured[i]);
    c_sum += pair.computed[i];
  }
  const double rounding =
      std::numeric_limits<double>::epsilon() * static_cast<double>(pair.measured.size()) * m_size;
  return std::abs(m_sum) > rounding ? c_sum / m_sum : std::numeric_limits<double>::quiet_NaN();
}

bool roadside_accepts(const MagnitudePhase& sprague_geers, const ResidualAnalysis& residuals) {
  return std::abs(sprague_geers.magnitude) <= 0.40 && sprague_geers.phase <= 0.40 &&
         sprague_geers.comprehensive <= 0.40 && std::abs(residuals.mean) <= 0.05 &&
         residuals.deviation <= 0.35;
}

}  // namespace impactrig::fitting
