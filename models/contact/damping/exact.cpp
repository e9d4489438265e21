// SPDX-License-Identifier: BSD-3-Clause
#include "models/contact/damping/exact.hpp"

#include <fmt/format.h>

#include <boost/math/special_functions/log1p.hpp>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace impactrig::models {

double exact_damping_factor(double e) {
  if (!(e > 0.0 && e <= 1.0))
    throw std::invalid_argument(fmt::format("exact_damping_factor: e = {} is outside (0, 1]", e));
  if (const double loss = 1.0 - e; loss < 1e-3)  // relative error loss^4
    return 1.5 * loss / (1.0 - e + e * e) * (1.0 + 0.9 * loss * loss * (1.0 + loss));
  if (e < 0.2) {
    // Near d = 1/e the logarithm of 1 − e d loses all digits, and below e = 0.14 Newton's start
    // lies left of the maximum of f and leaves for the root d = 0; this fixed point contracts by
    // 0.1 at e = 0.2 and like d exp(−d) below.
    double d = 1.0 / e;
    for (int i = 0; i < 60; ++i) {
      const double next = (1.0 - (1.0 + d) * std::exp(-d * (1.0 + e))) / e;
      if (std::abs(next - d) <= 2e-16 * d) return next;
      d = next;
    }
    return d;
  }
  double d = 1.5 * (1.0 - e) * (11.0 - e) / (1.0 + 9.0 * e);  // [CarvalhoMartins2019], e d < 1 here
  for (int i = 0; i < 60; ++i) {
    const double f = boost::math::log1pmx(-e * d) - boost::math::log1pmx(d);
    const double slope = (1.0 + e) - 1.0 / (1.0 + d) - e / (1.0 - e * d);
    double next = d - f / slope;
    if (next * e >= 1.0) next = 0.5 * (d + 1.0 / e);
    if (std::abs(next - d) <= 4e-16 * d) return next;
    d = next;
  }
  return d;
}

double free_rebound_ratio(double d) {
  if (!(d >= 0.0))
    throw std::invalid_argument(fmt::format("free_rebound_ratio: d = {} is negative", d));
  if (d == 0.0) return 1.0;
  // With x = e d: −x − ln(1 − x) = d − ln(1 + d), x in (0, min(1, d)); Newton inside a shrinking
  // bracket. Both sides are squares near 0: log1pmx(x) = ln(1 + x) − x keeps their digits.
  const double target = -boost::math::log1pmx(d);
  double low = 0.0;
  double high = d < 1.0 ? d : 1.0;
  double x = 0.5 * high;
  for (int i = 0; i < 200 && high - low > 1e-16 * high; ++i) {
    const double value =
        x < 1.0 ? -boost::math::log1pmx(-x) : std::numeric_limits<double>::infinity();
    (value < target ? low : high) = x;
    const double newton = x - (value - target) * (1.0 - x) / x;
    const double next = newton > low && newton < high ? newton : 0.5 * (low + high);
    if (std::abs(next - x) <= 1e-16 * x) break;
    x = next;
  }
  return x / d;
}

}  // namespace impactrig::models
