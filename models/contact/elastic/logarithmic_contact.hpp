// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "models/contact/elastic/elastic_state.hpp"

namespace impactrig::models {

/// The family of line contacts whose approach grows with the force's logarithm, inverted in closed
/// form.
///
///   δ = A f u,   u = 1 + ln(f* / f)
///
/// δ is the penetration [m], f the elastic force [N, compression > 0]. The laws of the family share
/// A = (σ_1 + σ_2) / L and differ in f*.
///
/// The inverse is f = δ / (A u) with u = −W₋₁(−y / e), y = δ / (A f*), the lower branch of the
/// Lambert W function, found here from u − ln u = 1 − ln y by Fritsch's iteration. The energy is
/// A f² (2u − 1) / 4, and 2u − 1 = −W₋₁(−4U / (e A f*²)) leads back from it.
///
/// Valid for 0 <= f < f*: at f* the compliance A ln(f*/f) reaches zero. Beyond δ(0.9 f*) the force
/// goes on along its tangent, so that an integrator's trial step stays finite; limit_penetration()
/// tells where that begins. Error: some 4 units in the last place times the condition number
/// u / (u − 1).
///
/// Source: Lambert W [Corless1996], iteration [FritschEtAl1973].
template <typename T = double>
struct LogarithmicContact {
  T compliance{0.0};   ///< A [m/N], > 0
  T limit_force{0.0};  ///< f* [N], > 0

  /// δ at which the law is no longer used, f = 0.9 f* [m].
  T limit_penetration() const { return compliance * (0.9 * limit_bracket()) * limit_force; }

  /// u = 1 + ln(f*/f) at a penetration in (0, limit_penetration()].
  T bracket(const T& penetration) const {
    using std::log;
    const T log_y = log(penetration / (compliance * limit_force));
    return lower_branch(log_y);
  }

  T force(const T& penetration) const {
    if (!(penetration > 0.0)) return T(0.0);
    const T limit = limit_penetration();
    if (penetration <= limit) return penetration / (compliance * bracket(penetration));
    return 0.9 * limit_force + (penetration - limit) / (compliance * (limit_bracket() - 1.0));
  }

  /// Elastic energy ∫ f dδ = A f² (2u − 1) / 4 [J].
  T energy(const T& penetration) const {
    if (!(penetration > 0.0)) return T(0.0);
    const T limit = limit_penetration();
    const T inside = penetration < limit ? penetration : limit;
    const T u = bracket(inside);
    const T f = inside / (compliance * u);
    const T beyond = penetration - inside;
    return compliance * f * f * (2.0 * u - 1.0) / 4.0 +
           beyond * (f + 0.5 * beyond / (compliance * (limit_bracket() - 1.0)));
  }

  /// df/dδ [N/m]; falls to 0 like 1 / |ln δ| at first touch.
  T stiffness(const T& penetration) const {
    if (!(penetration > 0.0)) return T(0.0);
    if (penetration > limit_penetration()) return 1.0 / (compliance * (limit_bracket() - 1.0));
    return 1.0 / (compliance * (bracket(penetration) - 1.0));
  }

  /// Force and stiffness at the cost of one of them.
  ForceAndStiffness<T> force_and_stiffness(const T& penetration) const {
    if (!(penetration > 0.0)) return {};
    if (penetration > limit_penetration()) return {force(penetration), stiffness(penetration)};
    const T u = bracket(penetration);
    return {penetration / (compliance * u), 1.0 / (compliance * (u - 1.0))};
  }

  /// d²f/dδ² [N/m²]; beyond all bounds at first touch.
  T curvature(const T& penetration) const {
    if (!(penetration > 0.0) || penetration > limit_penetration()) return T(0.0);
    const T u = bracket(penetration);
    const T v = u - 1.0;
    return u / (compliance * v * v * v * penetration);
  }

  /// δ(f) [m].
  T penetration(const T& force) const {
    using std::log;
    if (!(force > 0.0)) return T(0.0);
    if (force <= 0.9 * limit_force) return compliance * force * (1.0 + log(limit_force / force));
    return limit_penetration() +
           (force - 0.9 * limit_force) * (compliance * (limit_bracket() - 1.0));
  }

  /// δ(U) [m].
  T penetration_storing(const T& energy) const {
    using std::log;
    using std::sqrt;
    if (!(energy > 0.0)) return T(0.0);
    const T most = compliance * limit_force * limit_force;
    const T beyond = energy - most * (0.9 * 0.9 / 4.0 * (2.0 * limit_bracket() - 1.0));
    if (beyond > 0.0) {
      const T force = 0.9 * limit_force;
      const T slope = compliance * (limit_bracket() - 1.0);
      return limit_penetration() + slope * (sqrt(force * force + 2.0 * beyond / slope) - force);
    }
    const T v = lower_branch(log(4.0 * energy / most));  // 2u − 1
    return sqrt(compliance * energy / v) * (v + 1.0);
  }

  /// The same contact with `factor` times the force at equal penetration.
  LogarithmicContact scaled(const T& factor) const {
    return {compliance / factor, limit_force * factor};
  }

  bool operator==(const LogarithmicContact&) const = default;

 private:
  static double limit_bracket() { return 1.0 - std::log(0.9); }

  /// u > 1 of u − ln u = 1 − ln y.
  static T lower_branch(const T& log_y) {
    if constexpr (std::is_floating_point_v<T>) {
      return solve_branch(log_y);
    } else {
      // a step of Newton's method from the root carries its derivatives
      const double root = solve_branch(value_of(log_y));
      return T(root) - (log_y - (1.0 - root + std::log(root))) * (root / (root - 1.0));
    }
  }

  template <typename Real>
  static Real solve_branch(Real log_y) {
    using std::abs;
    using std::log;
    // a step this long leaves its fourth power; towards f*, where the root is nearly double, less
    // is gained by a step
    const Real short_enough = 4.0 * std::sqrt(std::sqrt(std::numeric_limits<Real>::epsilon()));
    const Real shorter = std::sqrt(std::numeric_limits<Real>::epsilon());
    Real u = 1.0 - log_y + log(1.0 - log_y);
    // two steps reach rounding for f < 0.08 f*
    for (int i = 0; i < 40; ++i) {
      const Real z = log_y - 1.0 - log(u) + u;
      const Real near = 1.0 - u;
      const Real q = 2.0 * near * (near + z * (2.0 / 3.0));
      const Real part = z / near * (q - z) / (q - 2.0 * z);
      u += u * part;
      if (!(abs(part) > (near < -2.5 ? short_enough : shorter * near * near))) break;
    }
    return u;
  }
};

}  // namespace impactrig::models
