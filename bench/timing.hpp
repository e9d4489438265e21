// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <ctime>
#include <limits>

namespace impactrig::bench {

/// Processor time of all threads since the program began [s]: what else the machine does matters
/// little.
inline double processor_seconds() {
  std::timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Processor time [s] of the quickest of `calls` calls at least, and of as many as `spent` [s]
/// hold.
template <typename Call>
double quickest(const Call& call, int calls, double spent) {
  double best = std::numeric_limits<double>::infinity();
  const double begun = processor_seconds();
  for (int k = 0; k < calls || processor_seconds() - begun < spent; ++k) {
    const double started = processor_seconds();
    call();
    best = std::min(best, processor_seconds() - started);
  }
  return best;
}

}  // namespace impactrig::bench
