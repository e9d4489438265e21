// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <ctime>

namespace impactrig::models {

/// Processor time the calling thread may take from now on.
class TimeLimit {
  using Wall = std::chrono::steady_clock;
  using WallSeconds = std::chrono::duration<double>;

 public:
  explicit TimeLimit(double seconds)
      : end_(processor_time() + seconds),
        earliest_(Wall::now() + WallSeconds(seconds)) {}

  /// Whether over() should be asked after so many attempts.
  static bool is_to_be_asked(long attempts) {
    constexpr long attempts_per_look = 16;
    return attempts % attempts_per_look == 0;
  }

  /// A thread's clock takes about as long to read as a short step, the wall's, which no thread is
  /// ahead of, a tenth of that.
  bool over() const { return WallSeconds(Wall::now() - earliest_).count() > 0.0 && left() < 0.0; }

  double left() const { return end_ - processor_time(); }  ///< [s], negative when it is over

 private:
  static double processor_time() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
  }

  double end_;  // [s]
  std::chrono::time_point<Wall, WallSeconds> earliest_;
};

}  // namespace impactrig::models
