// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/contact/damping/damping_law_entry.hpp"

namespace impactrig::models {

/// f = f_0 / (1 − d δ̇ / v),   d = 3 (1 − e²) / 4
///
/// The other reading of Shen et al. (32), the total force in the damping's product. A free rigid
/// impact rebounds with the root of d = (3/2) (1 − e) / (1 − e + e²): 0.703 for e = 0.5. Nothing is
/// said where δ̇ reaches v / d.
///
/// Source: [ShenEtAl2007] (32).
struct LankaraniNikraveshImplicit {
  static constexpr DampingLawText text{
      .name = "lankarani-nikravesh-implicit",
      .description = "the paper's factor with the total force in the damping",
      .formula = "f = f0 / (1 - d d'/v), d = 3 (1-e^2) / 4",
      .validity = "rebounds with 0.913 for 0.9, 0.703 for 0.5",
      .source = "ShenEtAl2007 (32), read implicitly",
      .form = DampingForm::implicit};

  static double factor(double e) { return 0.75 * (1.0 - e * e); }
};

}  // namespace impactrig::models
