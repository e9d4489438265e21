// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ctime>

namespace impactrig::models {

/// Processor time the calling thread may take from now on.
class TimeLimit {
 public:
  explicit TimeLimit(double seconds) : end_(processor_time() + seconds) {}

  /// Looks at the clock, which takes about as long as a short step, now and then only.
  bool over(long attempts) const {
    constexpr long attempts_per_look = 16;
    return attempts % attempts_per_look == 0 && processor_time() > end_;
  }

  double left() const { return end_ - processor_time(); }  ///< [s], negative when it is over

 private:
  static double processor_time() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
  }

  double end_;  // [s]
};

}  // namespace impactrig::models
