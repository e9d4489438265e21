// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/contact/damping/damping_law_entry.hpp"

namespace impactrig::models {

/// f = f_0(δ): the contact gives back all that it takes.
struct NoDamping {
  static constexpr DampingLawText text{.name = "none",
                                       .description = "purely elastic contact",
                                       .formula = "f = f0",
                                       .validity = "every elastic contact",
                                       .source = "-",
                                       .speed = DampingSpeed::none};

  static double factor(double) { return 0.0; }
};

}  // namespace impactrig::models
