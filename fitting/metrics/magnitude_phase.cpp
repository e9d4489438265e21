// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/metrics/magnitude_phase.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace impactrig::fitting {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Two histories as vectors: how long one is beside the other, and the angle between them.
struct Angle {
  double ratio = nan;      ///< |c| / |m|
  double radians = nan;    ///< in [0, π]
  double one_minus = nan;  ///< 1 − cos
};

Angle angle_between(const HistoryPair& pair) {
  const double m_norm = norm_of(pair.measured), c_norm = norm_of(pair.computed);
  if (m_norm == 0.0) return {};
  if (c_norm == 0.0) return {0.0, 0.5 * std::numbers::pi, 1.0};
  double difference = 0.0, sum = 0.0;  // |a − b|², |a + b|²
  for (std::size_t i = 0; i < pair.measured.size(); ++i) {
    const double a = pair.measured[i] / m_norm, b = pair.computed[i] / c_norm;
    difference += (a - b) * (a - b);
    sum += (a + b) * (a + b);
  }
  return {c_norm / m_norm, 2.0 * std::atan2(std::sqrt(difference), std::sqrt(sum)),
          0.5 * difference};
}

/// Where |x| first reaches a share of its largest value, in samples; none for zeros.
std::optional<double> arrival(std::span<const double> x, double share) {
  const double threshold = share * peak_of(x);
  if (threshold == 0.0) return std::nullopt;
  const auto first =
      std::ranges::find_if(x, [&](double value) { return std::abs(value) >= threshold; });
  const auto i = static_cast<std::size_t>(first - x.begin());
  if (i == 0) return 0.0;
  const double before = std::abs(x[i - 1]), after = std::abs(x[i]);
  return static_cast<double>(i) - (after - threshold) / (after - before);
}

/// x at a place between samples; none outside.
std::optional<double> interpolated(std::span<const double> x, double index) {
  const double last = static_cast<double>(x.size() - 1);
  if (!(index >= 0.0) || index > last) return std::nullopt;
  const double below = std::min(std::floor(index), std::max(0.0, last - 1.0));
  const auto i = static_cast<std::size_t>(below);
  if (i + 1 >= x.size()) return x[i];
  const double part = index - below;
  return (1.0 - part) * x[i] + part * x[i + 1];
}

}  // namespace

MagnitudePhase sprague_geers(const HistoryPair& pair) {
  require_comparable(pair);
  const Angle angle = angle_between(pair);
  const double magnitude = angle.ratio - 1.0, phase = angle.radians / std::numbers::pi;
  return {magnitude, phase, std::hypot(magnitude, phase)};
}

MagnitudePhase geers_1984(const HistoryPair& pair) {
  require_comparable(pair);
  const Angle angle = angle_between(pair);
  const double magnitude = angle.ratio - 1.0;
  return {magnitude, angle.one_minus, std::hypot(magnitude, angle.one_minus)};
}

MagnitudePhase russell(const HistoryPair& pair) {
  require_comparable(pair);
  const Angle angle = angle_between(pair);
  const double phase = angle.radians / std::numbers::pi;
  if (!(angle.ratio > 0.0)) return {nan, phase, nan};
  const double q = angle.ratio - 1.0 / angle.ratio;
  const double magnitude = std::copysign(std::log1p(std::abs(q)) / std::numbers::ln10, q);
  return {magnitude, phase, std::sqrt(0.25 * std::numbers::pi) * std::hypot(magnitude, phase)};
}

KnowlesGear knowles_gear(const HistoryPair& pair, double interval) {
  require_comparable(pair);
  constexpr double arrived = 0.05;
  const auto m_arrival = arrival(pair.measured, arrived);
  const auto c_arrival = arrival(pair.computed, arrived);
  KnowlesGear result{nan, nan, nan, nan, nan};
  if (m_arrival) result.arrival_measured = *m_arrival * interval;
  if (c_arrival) result.arrival_computed = *c_arrival * interval;
  if (!m_arrival || !c_arrival) return result;
  const double shift = *c_arrival - *m_arrival;
  const double peak = peak_of(pair.measured);
  double error = 0.0, size = 0.0;
  for (std::size_t i = 0; i < pair.measured.size(); ++i) {
    const auto moved = interpolated(pair.computed, static_cast<double>(i) + shift);
    if (!moved) continue;
    const double m = pair.measured[i] / peak, c = *moved / peak;
    error += std::abs(m) * (c - m) * (c - m);  // equal steps cancel
    size += std::abs(m) * m * m;
  }
  if (size > 0.0) result.magnitude = std::sqrt(error / size);
  if (*m_arrival > 0.0) result.phase = std::abs(shift) / *m_arrival;
  result.comprehensive = std::sqrt(
      (10.0 * result.magnitude * result.magnitude + 2.0 * result.phase * result.phase) / 12.0);
  return result;
}

}  // namespace impactrig::fitting
