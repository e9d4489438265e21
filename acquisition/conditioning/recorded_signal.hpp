// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <vector>

#include "acquisition/conditioning/trace.hpp"
#include "datasets/record.hpp"
#include "datasets/sample_filter.hpp"

namespace impactrig::acquisition {

/// What find_impacts needs of a channel, computed once a record.
struct RecordedSignal {
  const datasets::Channel* channel;
  Trace trace;
  double range;                                      ///< [SI]; 0 unknown
  double quantum;                                    ///< digitiser step [SI]; 0 not seen
  double step_before = 0.0;                          ///< likewise, before its filters
  double low_cut = 0.0;                              ///< of first order [Hz]; 0 unknown
  std::vector<datasets::SampleFilter> filters = {};  ///< that it has been through, where told
};

/// Whether a value [SI] lies at the end of a known range; 0: not known.
inline bool at_range(double value, double range) {
  return range > 0.0 && std::abs(value) >= 0.999 * range;
}

/// The range of the first signal of a quantity [SI]; 0: not known, or there is none.
inline double known_range(const std::vector<const RecordedSignal*>& signals,
                          datasets::Quantity quantity) {
  for (const RecordedSignal* const signal : signals)
    if (signal->trace.quantity == quantity) return signal->range;
  return 0.0;
}

}  // namespace impactrig::acquisition
