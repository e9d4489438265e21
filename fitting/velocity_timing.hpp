// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "datasets/impact.hpp"
#include "fitting/rig_file.hpp"

namespace impactrig::fitting {

/// A sentence where the velocity keeps its course while the force already presses, or has left it
/// before the force rises; "" where it does neither, or that cannot be told.
///
/// Late: a struck point's speed changes at once: by the time half of the impulse has been given, by
/// a good part of all that it will change. Less than a twentieth of the largest departure from the
/// course before touch means that the two channels were not sampled together, or that a delay of
/// more than half of the contact is not stated. Early: within so long a time the velocity changes
/// by more before touch, where there is no force, than seven tenths of the most it changes
/// anywhere. No model enters.
///
/// Neither can be told without a force that was the trigger, with fewer than 16 velocity samples
/// before touch, where the velocity departs by less than 20 times its noise, does not go down to
/// 0 Hz or is filtered too slowly, or where its spot is so far from the struck point that bending
/// waves arrive late; nor the second with dropouts that nobody marked, of a stepped bar, or where
/// the force's noise hides what stops a light end.
std::string velocity_out_of_time(const datasets::Impact& impact, const RigFile& rig);

}  // namespace impactrig::fitting
