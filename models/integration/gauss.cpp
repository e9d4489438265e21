// SPDX-License-Identifier: BSD-3-Clause
#include "models/integration/gauss.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace impactrig::models {

GaussRule gauss_legendre(int n) {
  if (n < 1) throw std::invalid_argument("gauss_legendre: needs at least one point");
  GaussRule rule;
  rule.points.resize(static_cast<std::size_t>(n));
  rule.weights.resize(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) {
    double x = std::cos(std::numbers::pi * (i + 0.75) / (n + 0.5));
    double derivative = 1.0;
    for (int iteration = 0; iteration < 100; ++iteration) {
      double previous = 1.0;
      double value = x;
      for (int k = 2; k <= n; ++k) {
        const double next = ((2 * k - 1) * x * value - (k - 1) * previous) / k;
        previous = value;
        value = next;
      }
      derivative = n * (x * value - previous) / (x * x - 1.0);
      const double step = value / derivative;
      x -= step;
      if (std::abs(step) < 1e-16) break;
    }
    rule.points[static_cast<std::size_t>(i)] = 0.5 * (1.0 - x);
    rule.weights[static_cast<std::size_t>(i)] = 1.0 / ((1.0 - x * x) * derivative * derivative);
  }
  return rule;
}

}  // namespace impactrig::models
