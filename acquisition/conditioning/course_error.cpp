// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/course_error.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "acquisition/conditioning/background.hpp"

namespace impactrig::acquisition {

namespace {

constexpr double least_left = 0.1;
constexpr double window = 5.0;  // autocorrelation times, as correlation_time() sums them

/// b²; 0 without steps.
double hidden_by_steps(const QuietResiduals& of) {
  const double step = of.quantum * of.quantum, variance = of.scatter * of.scatter;
  if (step == 0.0) return 0.0;
  if (of.rise < of.quantum) return std::max(0.0, (0.25 * step - variance) / 3.0);
  const double pi = std::numbers::pi;
  const double noise = std::max(0.0, variance / step - 1.0 / 12.0);  // σ²/q²
  return step / 12.0 * std::exp(-4.0 * pi * pi * noise);
}

}  // namespace

double slow_variance(QuietResiduals of) {
  const double band = std::max(4.0 * of.scatter, 1.6 * of.quantum);
  const auto counting =
      of.residuals.size() - static_cast<std::size_t>(std::ranges::count_if(
                                of.residuals, [](double r) { return std::isnan(r); }));
  for (double& residual : of.residuals)
    if (!(std::abs(residual) <= band)) residual = 0.0;
  const double time = correlation_time(of.residuals);
  const auto n = static_cast<double>(counting);
  const double lags = std::min(2.0 * std::ceil(window * time) + 1.0, n);
  const double left = std::max(least_left, 1.0 - of.terms * lags / n);
  const double steps = of.quantum > 0.0 ? std::max(1.0, of.rise / of.quantum) : 1.0;
  return of.scatter * of.scatter * time / left + hidden_by_steps(of) * n / steps;
}

}  // namespace impactrig::acquisition
