// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "datasets/impact.hpp"
#include "fitting/rig_file.hpp"

namespace impactrig::fitting {

/// What impulse and approach speed say of each other.
struct MomentumBalance {
  double measured = 0.0;  ///< impulse of the force over the first contact [N s]
  double expected = 0.0;  ///< of the rig at the measured approach speed, else at its own [N s]
  double ratio = 1.0;     ///< measured over expected
  bool plausible = true;
  bool times = false;      ///< the times are in another unit
  std::string sentence{};  ///< what is off, by what factor, which unit that may be; else empty
};

/// Whether the force's impulse is what this rig needs to stop the bar and throw it back.
///
/// The rig is simulated once in 7 modes at its own approach speed; an impulse is nearly
/// proportional to that speed. Restitution between 0 and 1 changes it by a factor of 2 at most, so
/// a ratio beyond 2.5 either way is a wrong unit, sensitivity, gain or rig; beyond 10 where no
/// velocity was recorded, or one that does not go down to 0 Hz. A laser spot elsewhere on the bar
/// is taken into account. Where the rig states its approach speed, what of the two records is off
/// by itself is named, and both where they fit each other at more than 30 times that speed, or less
/// than a 30th. So is a velocity that shows nothing but noise where the impulse needs 20 times as
/// much.
///
/// Where the contact's duration is off by a factor of 1e3 or 1e6, too, against a rigid bar's (4
/// either way), the times are named and not the force.
///
/// None when the impact has no force, the rig no contact, or cannot be simulated.
std::optional<MomentumBalance> momentum_balance(const datasets::Impact& impact, const RigFile& rig);

}  // namespace impactrig::fitting
