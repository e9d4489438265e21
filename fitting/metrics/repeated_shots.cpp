// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/metrics/repeated_shots.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "fitting/metrics/residuals.hpp"

namespace impactrig::fitting {

BandCoverage band_coverage(std::span<const double> computed, std::span<const double> centre,
                           std::span<const double> half_width) {
  if (computed.empty() || computed.size() != centre.size() || computed.size() != half_width.size())
    throw std::invalid_argument("a band and what lies in it must be of one length");
  std::vector<double> parts;
  std::size_t inside = 0;
  for (std::size_t i = 0; i < computed.size(); ++i) {
    if (!(half_width[i] >= 0.0))
      throw std::invalid_argument("a band's half width must not be negative");
    const double away = computed[i] - centre[i];
    if (std::abs(away) <= half_width[i]) ++inside;
    if (half_width[i] > 0.0) parts.push_back(away / half_width[i]);
  }
  BandCoverage result;
  result.fraction = static_cast<double>(inside) / static_cast<double>(computed.size());
  result.effective_samples = effective_samples(parts);
  constexpr double z = 1.959963984540054;  // 97.5 % of the normal law
  const double n = result.effective_samples, p = result.fraction;
  const double middle = (p + z * z / (2.0 * n)) / (1.0 + z * z / n);
  const double half = z / (1.0 + z * z / n) * std::sqrt(p * (1.0 - p) / n + z * z / (4.0 * n * n));
  result.low = std::max(0.0, middle - half);  // rounding leaves a share of 0 or 1 by 1e-17
  result.high = std::min(1.0, middle + half);
  return result;
}

ShotScatter shot_scatter(const std::vector<std::vector<double>>& shots) {
  if (shots.size() < 2) throw std::invalid_argument("scatter needs at least two shots");
  const std::size_t samples = shots.front().size();
  for (const std::vector<double>& shot : shots)
    if (shot.size() != samples) throw std::invalid_argument("shots must be of one length");
  const double n = static_cast<double>(shots.size());
  ShotScatter scatter{std::vector<double>(samples, 0.0), std::vector<double>(samples, 0.0)};
  for (std::size_t i = 0; i < samples; ++i) {
    for (const std::vector<double>& shot : shots) scatter.mean[i] += shot[i] / n;
    double squares = 0.0;
    for (const std::vector<double>& shot : shots)
      squares += (shot[i] - scatter.mean[i]) * (shot[i] - scatter.mean[i]);
    scatter.deviation[i] = std::sqrt(squares / (n - 1.0));
  }
  return scatter;
}

double chi2_per_sample(std::span<const double> computed, const ShotScatter& scatter,
                       std::size_t shots) {
  if (computed.size() != scatter.mean.size())
    throw std::invalid_argument("a history and the shots' mean must be of one length");
  const double n = static_cast<double>(shots);
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < computed.size(); ++i) {
    if (!(scatter.deviation[i] > 0.0)) continue;
    const double part = (computed[i] - scatter.mean[i]) / scatter.deviation[i];
    sum += n * part * part;
    ++count;
  }
  return count > 0 ? sum / static_cast<double>(count) : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace impactrig::fitting
