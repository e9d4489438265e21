// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/simulation.hpp"

namespace impactrig::models {

/// Which of the lasers that a history knows.
enum class Laser { velocity, displacement };

/// How a history that was asked for with spot_slopes changes with the place of a laser's spot: what
/// that laser shows does, all else stays.
History spot_sensitivity(const History& history, Laser laser);

}  // namespace impactrig::models
