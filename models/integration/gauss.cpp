// SPDX-License-Identifier: BSD-3-Clause
#include "models/integration/gauss.hpp"

#include <cmath>
#include <map>
#include <mutex>
#include <numbers>
#include <stdexcept>

namespace impactrig::models {
namespace {

struct Legendre {
  double value, slope;
};

/// P_n and its derivative inside (-1, 1).
Legendre legendre(int n, double x) {
  double previous = 1.0;
  double value = x;
  for (int k = 2; k <= n; ++k) {
    const double next = ((2 * k - 1) * x * value - (k - 1) * previous) / k;
    previous = value;
    value = next;
  }
  return {value, n * (x * value - previous) / (x * x - 1.0)};
}

GaussRule make_rule(int n) {
  GaussRule rule;
  rule.points.resize(static_cast<std::size_t>(n));
  rule.weights.resize(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) {
    double x = std::cos(std::numbers::pi * (i + 0.75) / (n + 0.5));
    for (int iteration = 0; iteration < 100; ++iteration) {
      const auto [value, slope] = legendre(n, x);
      x -= value / slope;
      if (std::abs(value / slope) < 1e-10) break;  // the next step would be its square
    }
    const double slope = legendre(n, x).slope;
    rule.points[static_cast<std::size_t>(i)] = 0.5 * (1.0 - x);
    rule.weights[static_cast<std::size_t>(i)] = 1.0 / ((1.0 - x * x) * slope * slope);
  }
  return rule;
}

}  // namespace

const GaussRule& gauss_legendre(int n) {
  if (n < 1) throw std::invalid_argument("gauss_legendre: needs at least one point");
  static std::mutex mutex;
  static std::map<int, GaussRule> rules;
  const std::lock_guard lock(mutex);
  const auto found = rules.find(n);
  return found != rules.end() ? found->second : rules.emplace(n, make_rule(n)).first->second;
}

}  // namespace impactrig::models
