// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <limits>

#include "models/contact/elastic/elastic_state.hpp"

namespace impactrig::models {

/// The family of power laws, f = K δⁿ for δ > 0, n >= 1. Each law says how K and n come about.
template <typename T = double>
struct PowerContact {
  T factor{0.0};  ///< K [N/mⁿ], > 0
  T power{1.0};   ///< n [-], >= 1

  T limit_penetration() const { return T(std::numeric_limits<double>::infinity()); }

  T force(const T& penetration) const {
    if (!(penetration > 0.0)) return T(0.0);
    return factor * raised(penetration);
  }

  /// Elastic energy f δ / (n + 1) [J].
  T energy(const T& penetration) const { return force(penetration) * penetration / (power + 1.0); }

  /// df/dδ = n f / δ [N/m].
  T stiffness(const T& penetration) const {
    if (!(penetration > 0.0)) return T(0.0);
    return power * force(penetration) / penetration;
  }

  ForceAndStiffness<T> force_and_stiffness(const T& penetration) const {
    if (!(penetration > 0.0)) return {};
    const T f = force(penetration);
    return {f, power * f / penetration};
  }

  /// d²f/dδ² [N/m²].
  T curvature(const T& penetration) const {
    if (!(penetration > 0.0)) return T(0.0);
    return power * (power - 1.0) * force(penetration) / (penetration * penetration);
  }

  /// δ(f) [m].
  T penetration(const T& force) const {
    using std::pow;
    if (!(force > 0.0)) return T(0.0);
    return pow(force / factor, 1.0 / power);
  }

  /// δ(U) [m].
  T penetration_storing(const T& energy) const {
    using std::pow;
    if (!(energy > 0.0)) return T(0.0);
    return pow((power + 1.0) * energy / factor, 1.0 / (power + 1.0));
  }

  PowerContact scaled(const T& by) const { return {factor * by, power}; }

  bool operator==(const PowerContact&) const = default;

 private:
  T raised(const T& penetration) const {
    using std::exp;
    using std::log;
    using std::sqrt;
    if constexpr (std::is_floating_point_v<T>) {
      if (power == 1.5) return penetration * sqrt(penetration);
      if (power == 1.0) return penetration;
      return std::pow(penetration, power);
    } else {
      return exp(power * log(penetration));
    }
  }
};

}  // namespace impactrig::models
