// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "models/contact/force_and_stiffness.hpp"

namespace impactrig::models {

/// Goldsmith's line contact, inverted in closed form.
///
///   δ = A f (1 + ln(f* / f)),   A = (h_i + h_j) / L,   h_l = (1 − ν_l²) / (π E_l),
///   f* = Lᵐ ΔR / (R_1 R_2 (h_i + h_j))
///
/// δ is the penetration [m], f the elastic force [N, compression > 0], L the contact length, ΔR =
/// R_2 − R_1 in a groove, R_1 + R_2 against a cylinder; against a plane ΔR / R_2 = 1. m = 1 is Shen
/// et al. (31) as printed: its logarithm is not dimensionless and stands for lengths in metres. m =
/// 3 is the consistent law (Dubowsky and Freudenstein 1971).
///
/// The inverse is f = δ / (A u) with u = −W₋₁(−δ / (e A f*)), the lower branch of the Lambert W
/// function, found here from u = 1 − ln y + ln u, y = δ / (A f*), by Fritsch's iteration.
///
/// Valid for 0 <= f < f*: at f* the compliance A ln(f*/f) reaches zero. Beyond δ(0.9 f*) the force
/// goes on along its tangent, so that an integrator's trial step stays finite; limit_penetration()
/// tells where that begins.
///
/// Source: [Goldsmith1960] as given in Shen et al. (31); [DubowskyFreudenstein1971]; inverse
/// [Corless1996], iteration [FritschEtAl1973].
struct Goldsmith {
  static constexpr const char* name = "goldsmith";

  double compliance = 0.0;   ///< A [m/N], > 0
  double limit_force = 0.0;  ///< f* [N], > 0

  /// δ at which the law is no longer used, f = 0.9 f* [m].
  double limit_penetration() const { return compliance * 0.9 * limit_force * limit_bracket(); }

  /// u = 1 + ln(f*/f) at a penetration in (0, limit_penetration()].
  double bracket(double penetration) const {
    const double log_y = std::log(penetration / (compliance * limit_force));
    double u = 1.0 - log_y + std::log(1.0 - log_y);
    // Fourth order: two steps reach rounding for f < 0.5 f*; the rest is for the neighbourhood of
    // f*, where the root is nearly double.
    for (int i = 0; i < 40; ++i) {
      const double z = log_y - 1.0 - std::log(u) + u;
      const double near = 1.0 - u;
      const double q = 2.0 * near * (near + z * (2.0 / 3.0));
      const double part = z / near * (q - z) / (q - 2.0 * z);
      u += u * part;
      if (!(std::abs(part) > 5e-4 * std::min(1.0, near * near))) break;
    }
    return u;
  }

  double force(double penetration) const {
    if (penetration <= 0.0) return 0.0;
    const double limit = limit_penetration();
    if (penetration <= limit) return penetration / (compliance * bracket(penetration));
    return 0.9 * limit_force + (penetration - limit) / (compliance * (limit_bracket() - 1.0));
  }

  /// Elastic energy ∫ f dδ = A f² (2u − 1) / 4 [J].
  double energy(double penetration) const {
    if (penetration <= 0.0) return 0.0;
    const double limit = limit_penetration();
    const double inside = penetration < limit ? penetration : limit;
    const double u = bracket(inside);
    const double f = inside / (compliance * u);
    const double beyond = penetration - inside;
    return compliance * f * f * (2.0 * u - 1.0) / 4.0 +
           beyond * (f + 0.5 * beyond / (compliance * (limit_bracket() - 1.0)));
  }

  /// df/dδ [N/m]; falls to 0 like 1 / |ln δ| at first touch.
  double stiffness(double penetration) const {
    if (penetration <= 0.0) return 0.0;
    if (penetration > limit_penetration()) return 1.0 / (compliance * (limit_bracket() - 1.0));
    return 1.0 / (compliance * (bracket(penetration) - 1.0));
  }

  /// Force and stiffness at the cost of one of them.
  ForceAndStiffness force_and_stiffness(double penetration) const {
    if (penetration <= 0.0) return {0.0, 0.0};
    if (penetration > limit_penetration()) return {force(penetration), stiffness(penetration)};
    const double u = bracket(penetration);
    return {penetration / (compliance * u), 1.0 / (compliance * (u - 1.0))};
  }

  /// The same contact with `factor` times the force at equal penetration.
  Goldsmith scaled(double factor) const { return {compliance / factor, limit_force * factor}; }

 private:
  static double limit_bracket() { return 1.0 - std::log(0.9); }
};

}  // namespace impactrig::models
