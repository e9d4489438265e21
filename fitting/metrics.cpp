// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/metrics.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace impactrig::fitting {

std::map<std::string, double> metrics(std::span<const double> measured,
                                      std::span<const double> computed) {
  const double n = static_cast<double>(measured.size());
  double mm = 0.0, cc = 0.0, mc = 0.0, m_sum = 0.0, c_sum = 0.0, squares = 0.0, peak = 0.0;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const double m = measured[i];
    const double c = computed[i];
    mm += m * m;
    cc += c * c;
    mc += m * c;
    m_sum += m;
    c_sum += c;
    squares += (c - m) * (c - m);
    peak = std::max(peak, std::abs(m));
  }
  if (measured.empty() || peak == 0.0) return {};
  const double m_variance = mm - m_sum * m_sum / n;
  const double c_variance = cc - c_sum * c_sum / n;
  const double covariance = mc - m_sum * c_sum / n;
  const double magnitude = std::sqrt(cc / mm) - 1.0;
  const double cosine = cc > 0.0 ? std::clamp(mc / std::sqrt(mm * cc), -1.0, 1.0) : 0.0;
  const double phase = std::acos(cosine) / std::numbers::pi;
  const bool vary = m_variance > 0.0 && c_variance > 0.0;
  return {{"nrmse", std::sqrt(squares / n) / peak},
          {"correlation", vary ? covariance / std::sqrt(m_variance * c_variance) : 0.0},
          {"sprague_geers_magnitude", magnitude},
          {"sprague_geers_phase", phase},
          {"sprague_geers_comprehensive", std::hypot(magnitude, phase)}};
}

}  // namespace impactrig::fitting
