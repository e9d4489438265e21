// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>

#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "models/contact/elastic/contact_numbers.hpp"
#include "models/contact/elastic/elastic_law_entry.hpp"
#include "models/contact/elastic/elastic_state.hpp"
#include "models/contact/elastic/penetration_storing.hpp"
#include "models/contact/elastic/penetration_under.hpp"

namespace impactrig::models {

/// Persson's conformal contact of a pin in a groove of the same material, with the half angle ε of
/// rigid overlap.
///
///   f = E* L ΔR · 2π x (1 + x) / (2 − ln(1 + x) − 2x²),   x = b² = tan²(ε/2) = δ / (2 ΔR + δ)
///
/// δ [m], f [N, compression > 0], ΔR = R_2 − R_1. The first equation is Persson's, plane strain
/// without friction; he gives no approach: cos ε = ΔR / (ΔR + δ) is the assumption that multibody
/// codes add. Near touch f = π E* L δ / 2, linear.
///
/// Valid for ε up to 84.8° (b = 0.9136), where the denominator ends; it goes on along its tangent
/// from x = 0.75, δ = 6.04 ΔR, which limit_penetration() tells.
///
/// Source: [Persson1964]; the load as in [CiavarellaDecuzzi2001].
template <typename T = double>
struct PerssonContact {
  T factor{0.0};     ///< E* L ΔR [N], > 0
  T clearance{0.0};  ///< ΔR [m], > 0

  T limit_penetration() const { return clearance * (2.0 * last_square / (1.0 - last_square)); }

  T force(const T& penetration) const { return force_and_stiffness(penetration).force; }

  T stiffness(const T& penetration) const { return force_and_stiffness(penetration).stiffness; }

  ForceAndStiffness<T> force_and_stiffness(const T& penetration) const {
    if (!(penetration > 0.0)) return {};
    const T limit = limit_penetration();
    const T inside = penetration < limit ? penetration : limit;
    const T span = 2.0 * clearance + inside;
    const Load load = load_at(inside / span);
    const T stiffness = factor * load.slope * (2.0 * clearance) / (span * span);
    return {factor * load.value + stiffness * (penetration - inside), stiffness};
  }

  /// d²f/dδ² [N/m²].
  T curvature(const T& penetration) const {
    if (!(penetration > 0.0) || penetration > limit_penetration()) return T(0.0);
    const T span = 2.0 * clearance + penetration;
    const Load load = load_at(penetration / span);
    const T turn = 2.0 * clearance / (span * span);
    return factor * (load.curvature * turn * turn - load.slope * 2.0 * turn / span);
  }

  /// ∫ f dδ = E* L ΔR ∫ load · 2 ΔR / (1 − x)² dx [J], by a rule exact to rounding in this range.
  T energy(const T& penetration) const {
    if (!(penetration > 0.0)) return T(0.0);
    using Rule = boost::math::quadrature::gauss<double, 30>;
    const T limit = limit_penetration();
    const T inside = penetration < limit ? penetration : limit;
    const T half = 0.5 * inside / (2.0 * clearance + inside);
    T sum = T(0.0);
    for (std::size_t i = 0; i < Rule::abscissa().size(); ++i)
      for (const double side : {-1.0, 1.0}) {
        const T x = half * (1.0 + side * Rule::abscissa()[i]);
        sum += Rule::weights()[i] * load_at(x).value / ((1.0 - x) * (1.0 - x));
      }
    const T beyond = penetration - inside;
    const ForceAndStiffness<T> last = force_and_stiffness(inside);
    return factor * 2.0 * clearance * half * sum +
           beyond * (last.force + 0.5 * beyond * last.stiffness);
  }

  /// δ(f) [m].
  T penetration(const T& force) const {
    if (!(force > 0.0)) return T(0.0);
    // f is convex and starts with a slope
    double guess =
        2.0 * value_of(force) / (std::numbers::pi * value_of(factor)) * value_of(clearance);
    const double limit = value_of(limit_penetration());
    if (guess > limit && value_of(this->force(T(limit))) > value_of(force)) guess = limit;
    return penetration_under(*this, force, guess);
  }

  /// δ(U) [m].
  T penetration_storing(const T& energy) const {
    if (!(energy > 0.0)) return T(0.0);
    return models::penetration_storing(*this, energy, value_of(clearance));
  }

  PerssonContact scaled(const T& by) const { return {factor * by, clearance}; }

  bool operator==(const PerssonContact&) const = default;

 private:
  static constexpr double last_square = 0.9 * 0.8346152454776572;  // of b at the end of the range

  struct Load {
    T value, slope, curvature;  // f / (E* L ΔR) and its derivatives by x
  };

  static Load load_at(const T& x) {
    using std::log;
    constexpr double two_pi = 2.0 * std::numbers::pi;
    const T below = 2.0 - log(1.0 + x) - 2.0 * x * x;
    const T below_slope = -1.0 / (1.0 + x) - 4.0 * x;
    const T below_curvature = 1.0 / ((1.0 + x) * (1.0 + x)) - 4.0;
    const T value = two_pi * x * (1.0 + x) / below;
    const T slope = (two_pi * (1.0 + 2.0 * x) - value * below_slope) / below;
    const T curvature =
        (2.0 * two_pi - 2.0 * slope * below_slope - value * below_curvature) / below;
    return {value, slope, curvature};
  }
};

struct PerssonLaw {
  static constexpr ElasticLawText text{
      .name = "persson",
      .description = "conformal pin in a groove, Persson's load on the angle of rigid overlap",
      .formula = "f = E* L dR 2 pi x (1+x) / (2 - ln(1+x) - 2 x^2), x = d/(2 dR + d)",
      .validity = "groove only; same material; half angle up to 84.8 deg, used to d = 6.04 dR",
      .source = "Persson1964, CiavarellaDecuzzi2001"};

  template <typename T>
  static PerssonContact<T> make(const ContactNumbers<T>& c) {
    require_groove(text.name, c.counterface);
    return {c.effective_modulus() * c.length * c.radii(), c.radii()};
  }

  static void limits(const ContactNumbers<>& c, double, double, std::vector<std::string>& beyond) {
    if (c.modulus != c.counter_modulus || c.poisson_ratio != c.counter_poisson_ratio)
      beyond.push_back(fmt::format(
          "the law 'persson' is for one material; here bar and groove have {:.4g} and {:.4g} GPa, "
          "{:g} and {:g}",
          1e-9 * c.modulus, 1e-9 * c.counter_modulus, c.poisson_ratio, c.counter_poisson_ratio));
  }
};

}  // namespace impactrig::models
