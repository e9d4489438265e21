// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "acquisition/conditioning/condition.hpp"
#include "acquisition/conditioning/contact_search.hpp"
#include "acquisition/conditioning/recorded_signal.hpp"
#include "datasets/impact.hpp"

namespace impactrig::acquisition {

/// What is wrong with an impact as it was recorded: every ImpactFlag but no_hit, swapped and
/// implausible. The first of `signals` is the trigger, in which `contact` was found; nothing before
/// `floor` [s] is quiet. The impact's signals and its approach velocity must be there.
std::vector<datasets::ImpactFlag> flags_of(const datasets::Impact& impact, const Contact& contact,
                                           const std::vector<const RecordedSignal*>& signals,
                                           double floor, const DetectionOptions& options);

}  // namespace impactrig::acquisition
