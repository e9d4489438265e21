// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/contact/damping/critical_share.hpp"

#include "models/contact/damping/damping_law_entry.hpp"

namespace impactrig::models {

/// f = f_0 + 2 ζ √m f_0 / √(2 U) δ̇,   ζ = −ln e / √(π² + ln² e)
///
/// U(δ) is the elastic energy, m the effective mass. Beside Hertz's spring this is Tsuji's √5 ζ √(m
/// K) δ^(1/4), beside a linear one the dashpot. With z = √(2 U), p = √m δ̇ and the time scaled by
/// f_0 / √(2 U m) the motion is that of a linear oscillator of damping ζ whatever f_0: the rebound
/// is e for every elastic law and speed when the contact may pull, exp(−2 ζ arccos ζ / √(1 − ζ²))
/// when it may not.
///
/// Source: [TsujiEtAl1992], ζ [AntypovElliott2011]; for any f_0 ours.
struct Tsuji {
  static constexpr DampingLawText text{
      .name = "tsuji",
      .description = "as much damping at every depth, as a linear dashpot has",
      .formula = "f = f0 + 2 zeta sqrt(m) f0/sqrt(2U) d'",
      .validity = "tension allowed: exact for every elastic law; kept at zero: 0.550 for 0.5",
      .source = "TsujiEtAl1992, AntypovElliott2011",
      .form = DampingForm::natural,
      .speed = DampingSpeed::none,
      .smallest_restitution = 0.005};

  static double factor(double e) { return critical_share(e); }
};

}  // namespace impactrig::models
