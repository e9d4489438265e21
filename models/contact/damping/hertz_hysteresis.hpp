// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/contact/damping/exact.hpp"

#include "models/contact/damping/damping_law_entry.hpp"

namespace impactrig::models {

/// f = f_0 + χ δ^(3/2) δ̇,   χ = d K / v,   K = (4/3) E* √R_eq
///
/// with d of the exact law. Exact beside Hertz's own spring; beside a line contact the damping is
/// no longer in proportion to the force and the restitution is lost: 0.695 for e = 0.5 with the
/// paper's contact. Here for comparison with codes that do this.
///
/// Source: none; a common mistake.
struct HertzHysteresis {
  static constexpr DampingLawText text{
      .name = "hertz-hysteresis",
      .description = "exact factor, but with Hertz's d^(3/2) beside any elastic law",
      .formula = "f = f0 + d K d^(3/2) d'/v, K = 4/3 E* sqrt(Req)",
      .validity = "hertz-point: exact; beside goldsmith 0.695 for 0.5: e is lost",
      .source = "-, a common mistake",
      .form = DampingForm::hertzian,
      .smallest_restitution = 0.005};

  static double factor(double e) { return exact_damping_factor(e); }
};

}  // namespace impactrig::models
