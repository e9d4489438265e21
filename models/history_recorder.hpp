// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/simulation.hpp"

namespace impactrig::models {

/// Samples of a history before that at first touch.
long samples_before_touch(const HistoryRequest& wanted);

/// Begins a history as asked for, up to first touch: a rigid swing, continued backwards. Speeds of
/// the struck point, the velocity laser's spot and the displacement laser's at touch [m/s].
void begin_history(const Rig& rig, const HistoryRequest& wanted, double struck_speed,
                   double velocity_speed, double displacement_speed, History& history);

}  // namespace impactrig::models
