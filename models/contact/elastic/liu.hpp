// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <limits>
#include <stdexcept>

#include "models/contact/elastic/contact_numbers.hpp"
#include "models/contact/elastic/elastic_law_entry.hpp"
#include "models/contact/elastic/elastic_state.hpp"
#include "models/contact/elastic/penetration_storing.hpp"
#include "models/contact/elastic/penetration_under.hpp"

namespace impactrig::models {

/// The internal contact of Liu, Zhang and Yang, from Winkler's foundation fitted to finite
/// elements.
///
///   f = c δ √(δ / (2 (ΔR + δ))),   c = π E* L / 2
///
/// δ [m], f [N, compression > 0], ΔR = R_2 − R_1 the clearance of the radii. f ~ δ^(3/2) while δ is
/// small against ΔR, linear far beyond.
///
/// Valid in a groove, also where the contact is wide; rises everywhere.
///
/// Source: [LiuEtAl2007].
template <typename T = double>
struct LiuContact {
  T factor{0.0};     ///< c [N/m], > 0
  T clearance{0.0};  ///< ΔR [m], > 0

  T limit_penetration() const { return T(std::numeric_limits<double>::infinity()); }

  T force(const T& penetration) const {
    using std::sqrt;
    if (!(penetration > 0.0)) return T(0.0);
    return factor * penetration * sqrt(penetration / (2.0 * (clearance + penetration)));
  }

  /// c ΔR² / √2 ∫ s^(3/2) (1 + s)^(−1/2) ds up to δ / ΔR [J]; by its series where the closed form
  /// would cancel.
  T energy(const T& penetration) const {
    using std::log;
    using std::sqrt;
    if (!(penetration > 0.0)) return T(0.0);
    const T s = penetration / clearance;
    const T scale = factor * clearance * clearance * std::sqrt(0.5);
    if (s > 0.2) {
      const T root = sqrt(s * (1.0 + s));
      const T area = log(T(sqrt(s)) + T(sqrt(1.0 + s)));  // asinh √s
      return scale * 0.25 * (root * (2.0 * s - 3.0) + 3.0 * area);
    }
    T sum = T(0.0), term = s * s * T(sqrt(s));
    for (int k = 0; k < 26; ++k) {
      sum += term / (k + 2.5);
      term *= -(k + 0.5) / (k + 1.0) * s;
    }
    return scale * sum;
  }

  /// df/dδ [N/m].
  T stiffness(const T& penetration) const { return force_and_stiffness(penetration).stiffness; }

  ForceAndStiffness<T> force_and_stiffness(const T& penetration) const {
    if (!(penetration > 0.0)) return {};
    const T f = force(penetration);
    return {f, f * (1.5 / penetration - 0.5 / (clearance + penetration))};
  }

  /// d²f/dδ² [N/m²].
  T curvature(const T& penetration) const {
    if (!(penetration > 0.0)) return T(0.0);
    const T part = clearance / (penetration * (clearance + penetration));
    return 0.75 * force(penetration) * part * part;
  }

  /// δ(f) [m]: the root of δ³ = p (ΔR + δ), p = 2 (f/c)², which is below √p + ∛(p ΔR).
  T penetration(const T& force) const {
    if (!(force > 0.0)) return T(0.0);
    const double ratio = value_of(force) / value_of(factor);
    const double p = 2.0 * ratio * ratio;
    return penetration_under(*this, force, std::sqrt(p) + std::cbrt(p * value_of(clearance)));
  }

  /// δ(U) [m].
  T penetration_storing(const T& energy) const {
    if (!(energy > 0.0)) return T(0.0);
    return models::penetration_storing(*this, energy, value_of(clearance));
  }

  LiuContact scaled(const T& by) const { return {factor * by, clearance}; }

  bool operator==(const LiuContact&) const = default;
};

struct LiuLaw {
  static constexpr ElasticLawText text{
      .name = "liu",
      .description = "pin in a groove, between the powers 3/2 and 1",
      .formula = "f = pi/2 E* L d sqrt(d / (2 (dR + d)))",
      .validity = "groove only; elastic, also where the contact is wide",
      .source = "LiuEtAl2007"};

  template <typename T>
  static LiuContact<T> make(const ContactNumbers<T>& c) {
    require_groove(text.name, c.counterface);
    return {0.5 * std::numbers::pi * c.effective_modulus() * c.length, c.radii()};
  }
};

}  // namespace impactrig::models
