// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/math/special_functions/ellint_1.hpp>
#include <boost/math/special_functions/ellint_2.hpp>
#include <cmath>
#include <numbers>

namespace impactrig::tests {

/// Of the tip of a cantilever of unit length; `shortening` is along the undeformed bar.
struct TipDeflection {
  double across = 0.0;      // [-]
  double shortening = 0.0;  // [-]
};

/// Inextensible cantilever under a dead load P across its tip, α = P L² / EI. Source:
/// [BisshoppDrucker1945].
struct Elastica {
  explicit Elastica(double load) {
    using boost::math::ellint_1;
    using boost::math::ellint_2;
    const auto load_of = [](double slope) {
      const double k = std::sqrt(0.5 * (1.0 + std::sin(slope)));
      const double amplitude = std::asin(std::numbers::sqrt2 / (2.0 * k));
      return std::pow(ellint_1(k) - ellint_1(k, amplitude), 2);
    };
    double low = 0.0, high = 0.5 * std::numbers::pi;
    for (int i = 0; i < 60; ++i) {
      tip_slope = 0.5 * (low + high);
      (load_of(tip_slope) < load ? low : high) = tip_slope;
    }
    const double k = std::sqrt(0.5 * (1.0 + std::sin(tip_slope)));
    const double amplitude = std::asin(std::numbers::sqrt2 / (2.0 * k));
    tip.across = 1.0 - 2.0 / std::sqrt(load) * (ellint_2(k) - ellint_2(k, amplitude));
    tip.shortening = 1.0 - std::sqrt(2.0 * std::sin(tip_slope) / load);
  }

  double tip_slope = 0.0;  // angle to the undeformed bar [rad]
  TipDeflection tip;
};

}  // namespace impactrig::tests
