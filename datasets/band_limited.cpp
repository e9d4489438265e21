// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/band_limited.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace impactrig::datasets {
namespace {

constexpr int crossings = BandLimited::crossings;
constexpr double beta = BandLimited::beta;
constexpr int table_step = 4096;  // values a zero crossing

/// sinc(x) under its window, x in zero crossings, 0 <= x <= crossings.
double windowed_sinc(double x) {
  const double part = x / crossings;
  const double window = std::cyl_bessel_i(0.0, beta * std::sqrt(std::max(0.0, 1.0 - part * part))) /
                        std::cyl_bessel_i(0.0, beta);
  const double angle = std::numbers::pi * x;
  return window * (x == 0.0 ? 1.0 : std::sin(angle) / angle);
}

/// One side.
std::vector<double> kernel_table() {
  std::vector<double> table;
  table.reserve(crossings * table_step + 2);
  for (int i = 0; i <= crossings * table_step; ++i)
    table.push_back(windowed_sinc(static_cast<double>(i) / table_step));
  table.push_back(0.0);
  return table;
}

/// The kernel so many crossings from its middle.
double weight_at(double distance) {
  static const std::vector<double> kernel = kernel_table();
  const double place = distance * table_step;
  const auto k = static_cast<std::size_t>(place);
  const double part = place - static_cast<double>(k);
  return kernel[k] + part * (kernel[k + 1] - kernel[k]);
}

}  // namespace

BandLimited::BandLimited(std::span<const double> values, double stretch)
    : values_(values),
      stretch_(stretch / cutoff) {}

double BandLimited::sample(std::ptrdiff_t i) const {
  const auto n = static_cast<std::ptrdiff_t>(values_.size());
  if (i >= 0 && i < n) return values_[static_cast<std::size_t>(i)];
  if (n == 1) return values_.front();
  // Two reflections move the record by twice its length, and its values by twice its rise.
  const std::ptrdiff_t period = 2 * (n - 1);
  const std::ptrdiff_t turns = i >= 0 ? i / period : -((period - 1 - i) / period);
  const std::ptrdiff_t inner = i - turns * period;
  const double rise = 2.0 * static_cast<double>(turns) * (values_.back() - values_.front());
  if (inner < n) return values_[static_cast<std::size_t>(inner)] + rise;
  return 2.0 * values_.back() - values_[static_cast<std::size_t>(period - inner)] + rise;
}

double BandLimited::operator()(double index) const {
  const double reach = crossings * stretch_;
  const auto first = static_cast<std::ptrdiff_t>(std::ceil(index - reach));
  const auto last = static_cast<std::ptrdiff_t>(std::floor(index + reach));
  double sum = 0.0, weights = 0.0;
  for (std::ptrdiff_t i = first; i <= last; ++i) {
    const double weight = weight_at(std::abs(static_cast<double>(i) - index) / stretch_);
    sum += weight * sample(i);
    weights += weight;
  }
  return sum / weights;  // a constant stays what it is
}

std::vector<double> BandLimited::at_samples() const {
  const auto count = static_cast<std::ptrdiff_t>(values_.size());
  const auto reach = static_cast<std::ptrdiff_t>(std::floor(crossings * stretch_));
  std::vector<double> prolonged;
  prolonged.reserve(static_cast<std::size_t>(count + 2 * reach));
  for (std::ptrdiff_t i = -reach; i < count + reach; ++i) prolonged.push_back(sample(i));
  std::vector<double> result(values_.size(), 0.0);
  double weights = 0.0;
  // Of each sum the same terms in the same order as above, all sums side by side.
  for (std::ptrdiff_t k = -reach; k <= reach; ++k) {
    const double weight = weight_at(std::abs(static_cast<double>(k)) / stretch_);
    const double* const shifted = prolonged.data() + k + reach;
    for (std::ptrdiff_t i = 0; i < count; ++i)
      result[static_cast<std::size_t>(i)] += weight * shifted[i];
    weights += weight;
  }
  for (double& value : result) value /= weights;
  return result;
}

}  // namespace impactrig::datasets
