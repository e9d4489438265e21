// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "acquisition/conditioning/condition.hpp"
#include "acquisition/conditioning/trace.hpp"

namespace impactrig::acquisition {

/// Whether force and velocity look exchanged: what is called velocity is a pulse that begins and
/// ends at zero, and what is called force has a level before it to which it does not come back. No
/// struck bar makes either: a force rests where it rested before, and a bar that comes with some
/// speed is thrown back.
bool look_swapped(const Trace& force, const Trace& velocity, const DetectionOptions& options);

}  // namespace impactrig::acquisition
