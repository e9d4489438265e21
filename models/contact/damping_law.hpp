// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string_view>

namespace impactrig::models {

/// Damping in proportion to the elastic force, f = f_0(δ) (1 + μ δ̇), μ = d / v⁻, where v⁻ is the
/// approach speed at the start of the contact and d a function of the restitution e alone. A law is
/// such a function d(e).
///
/// In a free impact of rigid bodies every such law rebounds with the e_out of d (1 + e_out) = ln((1
/// + d) / (1 − e_out d)), whatever f_0, mass and speed are [GonthierEtAl2004]; only `exact` gives
/// e_out = e.
struct DampingLaw {
  std::string_view name;
  std::string_view description;
  std::string_view source;
  double smallest_restitution;           ///< below it d(e) is not defined or too large to integrate
  double (*factor)(double restitution);  ///< d [-]
};

/// One line each; a new law is one function, one line and one test.
std::span<const DampingLaw> damping_laws();

/// Throws std::invalid_argument on an unknown name (and lists the known ones).
const DampingLaw& damping_law(std::string_view name);

/// d of the exact-restitution law: the root of d (1 + e) = ln((1 + d) / (1 − e d)) in (0, 1/e), for
/// e in (0, 1]. Relative error below 1e-11; the quotient of two differences loses digits as e -> 1,
/// where a series takes over.
double exact_damping_factor(double restitution);

/// The e with which a free rigid impact rebounds at a damping factor d >= 0: the inverse of
/// exact_damping_factor().
double free_rebound_ratio(double factor);

}  // namespace impactrig::models
