// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "models/simulation.hpp"

namespace impactrig::models {

/// Samples of a history before that at first touch.
long samples_before_touch(const HistoryRequest& wanted);

/// Begins a history as asked for, up to first touch: a rigid swing, continued backwards. Speeds of
/// the struck point, the velocity laser's spot and the displacement laser's at touch [m/s].
void begin_history(const Rig& rig, const HistoryRequest& wanted, double struck_speed,
                   double velocity_speed, double displacement_speed, History& history);

/// Samples up to `duration` after first touch [s], 2^20 of them at most.
std::size_t expected_samples(const History& begun, double duration);

/// Makes room for so many samples in what a history shows, without changing it.
void make_room(std::size_t samples, History& history);

}  // namespace impactrig::models
