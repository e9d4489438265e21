// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/contact/damping/damping_law_entry.hpp"

namespace impactrig::models {

/// f = f_0(δ) (1 + (3/2) α δ̇),   α = (1 − e) / v_1
///
/// α is a constant of the pair [s/m], which e states at the speed v_1 of the first contact or at
/// `restitution_speed`; the restitution of other contacts is about 1 − α v. Simbody's and Drake's
/// dissipation is the same number up to the 3/2.
///
/// Source: [MarhefkaOrin1999].
struct MarhefkaOrin {
  static constexpr DampingLawText text{
      .name = "marhefka-orin",
      .description = "Hunt and Crossley's with one constant for all speeds",
      .formula = "f = f0 (1 + 3/2 alpha d'), alpha = (1-e)/v1",
      .validity = "e near 1; restitution falls with the speed, about 1 - alpha v",
      .source = "MarhefkaOrin1999",
      .speed = DampingSpeed::first};

  static double factor(double e) { return 1.5 * (1.0 - e); }
};

}  // namespace impactrig::models
