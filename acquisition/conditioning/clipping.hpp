// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "acquisition/conditioning/condition.hpp"
#include "acquisition/conditioning/contact_search.hpp"
#include "acquisition/conditioning/recorded_signal.hpp"
#include "datasets/impact.hpp"

namespace impactrig::acquisition {

/// A contact that reaches the known range of the trigger, or whose top the recorder marked; of a
/// pulse, a flat top that no smooth crest makes too.
bool trigger_clipped(const RecordedSignal& trigger, const Contact& contact,
                     const DetectionOptions& options);

/// A motion that reaches its range, or a rail that is not stated, anywhere in the window, as its
/// approach counts too.
bool motion_clipped(const datasets::Impact& impact, const Contact& contact,
                    const std::vector<const RecordedSignal*>& signals);

}  // namespace impactrig::acquisition
