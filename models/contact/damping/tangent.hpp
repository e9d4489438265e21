// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/contact/damping/critical_share.hpp"

#include "models/contact/damping/damping_law_entry.hpp"

namespace impactrig::models {

/// f = f_0 + 2 ζ √(m f_0') δ̇,   ζ = −ln e / √(π² + ln² e)
///
/// The dashpot of a linear spring, made of the tangent stiffness. A free rigid impact that may pull
/// rebounds with 0.495 for e = 0.5 beside Goldsmith's law, with 0.466 beside Hertz's sphere; exact
/// beside a linear spring.
///
/// Source: none of its own; common in particle codes.
struct TangentDamping {
  static constexpr DampingLawText text{
      .name = "tangent",
      .description = "critical share of the tangent stiffness",
      .formula = "f = f0 + 2 zeta sqrt(m f0') d'",
      .validity = "tension allowed: 0.495 for 0.5 with goldsmith, 0.466 with hertz-point",
      .source = "-, common in particle codes",
      .form = DampingForm::tangent,
      .speed = DampingSpeed::none,
      .smallest_restitution = 0.005};

  static double factor(double e) { return critical_share(e); }
};

}  // namespace impactrig::models
