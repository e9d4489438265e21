// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/quiet_noise.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace impactrig::fitting {
namespace {

constexpr std::size_t fewest = 40;
constexpr double hum_periods = 0.5;  // a shorter stretch takes hum for its line

/// The last stretch of sound samples, one in `every`, before an instant.
std::vector<double> last_sound(const datasets::ImpactSignal& signal,
                               std::span<const std::uint8_t> sound, std::size_t every,
                               double until) {
  std::vector<double> stretch;
  for (std::size_t k = 0; k < signal.values.size() && signal.time(k) < until; k += every) {
    if (!sound[k])
      stretch.clear();
    else
      stretch.push_back(signal.values[k]);
  }
  return stretch;
}

}  // namespace

NoiseModel quiet_noise(const datasets::ImpactSignal& signal, std::span<const std::uint8_t> sound,
                       std::size_t every, double until, double mains_frequency, double sigma,
                       double least) {
  const double steps = static_cast<double>(every);
  const NoiseModel white(std::max(sigma, least), std::max(1.0, signal.noise_correlation / steps));
  const std::vector<double> stretch = last_sound(signal, sound, every, until);
  if (stretch.size() < fewest)
    return white.known_from(static_cast<double>(stretch.size()) / white.correlation_time() - 2.0);
  const auto count = static_cast<Eigen::Index>(stretch.size());
  const double length = steps * signal.interval * static_cast<double>(stretch.size());
  const double turns = length * mains_frequency;
  const int degree = signal.quantity == datasets::Quantity::displacement ? 2 : 1;
  const int hums = turns >= hum_periods ? 4 : 0;
  Eigen::MatrixXd trends(count, degree + 1 + hums);
  for (Eigen::Index i = 0; i < count; ++i) {
    const double part = static_cast<double>(i) / static_cast<double>(count);
    for (int k = 0; k <= degree; ++k) trends(i, k) = std::pow(2.0 * part - 1.0, k);
    for (int k = 0; k < hums; ++k) {
      const double angle = 2.0 * std::numbers::pi * turns * part * (k < 2 ? 1.0 : 3.0);
      trends(i, degree + 1 + k) = k % 2 == 0 ? std::sin(angle) : std::cos(angle);
    }
  }
  const Eigen::Map<const Eigen::VectorXd> values(stretch.data(), count);
  return NoiseModel::estimate(values, trends).at_least(least);
}

}  // namespace impactrig::fitting
