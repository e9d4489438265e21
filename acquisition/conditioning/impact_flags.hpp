// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <vector>

#include "acquisition/conditioning/condition.hpp"
#include "acquisition/conditioning/contact_search.hpp"
#include "acquisition/conditioning/trace.hpp"
#include "datasets/impact.hpp"

namespace impactrig::acquisition {

/// What find_impacts needs of a channel, computed once a record.
struct RecordedSignal {
  const datasets::Channel* channel;
  Trace trace;
  double range;                                      ///< [SI]; 0 unknown
  double quantum;                                    ///< digitiser step [SI]; 0 not seen
  std::vector<datasets::SampleFilter> filters = {};  ///< that it has been through, where told
};

/// Whether a value [SI] lies at the end of a known range; 0: not known.
inline bool at_range(double value, double range) {
  return range > 0.0 && std::abs(value) >= 0.999 * range;
}

/// What is wrong with an impact as it was recorded: every ImpactFlag but no_hit, swapped and
/// implausible. The first of `signals` is the trigger, in which `contact` was found; nothing before
/// `floor` [s] is quiet. The impact's signals and its approach velocity must be there.
std::vector<datasets::ImpactFlag> flags_of(const datasets::Impact& impact, const Contact& contact,
                                           const std::vector<const RecordedSignal*>& signals,
                                           double floor, const DetectionOptions& options);

}  // namespace impactrig::acquisition
