// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "datasets/impact.hpp"

namespace impactrig::acquisition {

/// A level stretch with which the velocity of an impact begins or ends.
struct LevelEnd {
  bool begins = true;   ///< the window begins on it; else it ends on it
  double edge = 0.0;    ///< where it ends, or begins [s]
  double little = 0.0;  ///< of the contact's impulse: too small a part to be seen on the level
};

/// The part of the contact's impulse up to a time; needs a force whose impulse is not zero.
double impulse_until(const datasets::Impact& impact, double time);

/// Whether a velocity that is level up to an edge within the contact was cut there. A channel that
/// is shown late (or early) against the force is level that long too, and leaves at once where the
/// force begins (or ends) with a jump. What lies beside the level tells: it follows the force, as
///   v(t) = a + b J(t - d) + c ∫J dt (t - d),
/// the impulse J so far on a bar whose mobility changes evenly with time. Of all delays d the one
/// that fits best has to leave some of the impulse for the level, and those that leave none have to
/// fit with twice its mean square at least: bars of which that is not true are not told from late
/// channels.
bool is_cut_not_late(const datasets::Impact& impact, const LevelEnd& level);

}  // namespace impactrig::acquisition
