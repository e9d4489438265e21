// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/contact/damping/critical_share.hpp"

#include "models/contact/damping/damping_law_entry.hpp"

namespace impactrig::models {

/// f = f_0(δ) + c δ̇,   c = 2 ζ √(m k),   ζ = −ln e / √(π² + ln² e)
///
/// m is the effective mass; k the stiffness, for elastic laws other than the linear one that of the
/// spring that takes the energy m v² / 2 in the same way. `viscous` states c itself. The force
/// jumps to c v at touch and pulls before the bodies part: with a linear spring the rebound is e
/// when that is allowed, exp(−2 ζ arccos ζ / √(1 − ζ²)) when it is not.
///
/// Source: [Anagnostopoulos1988]; constant γ beside Hertz's spring: Ristow, Schäfer.
struct Viscous {
  static constexpr DampingLawText text{
      .name = "viscous",
      .description = "dashpot of constant coefficient",
      .formula = "f = f0 + c d', c = 2 zeta sqrt(m k)",
      .validity = "linear spring, tension allowed: exact; kept at zero instead: 0.550 for 0.5",
      .source = "Anagnostopoulos1988",
      .form = DampingForm::constant,
      .speed = DampingSpeed::first,
      .smallest_restitution = 0.005};

  static double factor(double e) { return critical_share(e); }
};

}  // namespace impactrig::models
