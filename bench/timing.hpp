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

/// Processor time [s] of the quickest of several calls: three at least, then for a tenth of a
/// second; none is begun after a second.
template <typename Call>
double quickest(const Call& call) {
  double best = std::numeric_limits<double>::infinity();
  const double begun = processor_seconds();
  double spent = 0.0;
  for (int k = 0; k == 0 || (spent < 1.0 && (k < 3 || spent < 0.1)); ++k) {
    const double started = processor_seconds();
    call();
    const double ended = processor_seconds();
    best = std::min(best, ended - started);
    spent = ended - begun;
  }
  return best;
}

}  // namespace impactrig::bench
