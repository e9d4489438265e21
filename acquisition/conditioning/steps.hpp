// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "acquisition/conditioning/condition.hpp"
#include "datasets/conditioning.hpp"
#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// Does what is asked for, step by step in their order; each leaves an Edit in the provenance.
///
/// A step's channel is a name, else a pattern with * and ?, else a quantity ("force"); it is done
/// to every channel that is meant. Where a step needs to know what is quiet or where the impact is
/// and does not say it, that is what lies before first touch, as find_impacts sees the first impact
/// when the step is reached (5 % of it and 3 samples left out).
///
/// `sensors` say what a fit accounts for as filters: the delay of those is left in by AlignTo.
///
/// Throws datasets::InputError, with the recording as place and the step's number from 1, when a
/// channel is not there, the impact that a step needs is not found, or a step refuses the channel.
void apply_steps(std::span<const datasets::ConditioningStep> steps, datasets::Record& record,
                 const SensorSet& sensors = {});

/// The delay of a sensor's chain for slow signals: the slope of its phase at low frequency, of
/// resonance and high cut; a low cut has none [s].
double chain_delay(const datasets::Sensor& sensor);

}  // namespace impactrig::acquisition
