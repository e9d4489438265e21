// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
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
/// `sensors` are those whose filters a fit accounts for: AlignTo passes each channel through the
/// other's, so that what it takes off is the delay beside them.
///
/// Impacts that are clipped before the first step keep that flag (note_clipped).
///
/// `detection` says how that impact is looked for. `done` is called after each step.
///
/// Throws datasets::InputError, with the recording as place and the step's number from 1, when a
/// channel is not there, the impact that a step needs is not found, or a step refuses the channel.
void apply_steps(std::span<const datasets::ConditioningStep> steps, datasets::Record& record,
                 const SensorSet& sensors = {}, const DetectionOptions& detection = {},
                 const std::function<void()>& done = {});

}  // namespace impactrig::acquisition
