// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <chrono>
#include <ctime>

namespace impactrig::models {

/// After which of a run's attempts at a step its time is looked at: after each where they are long,
/// else after ever more, up to sixteen, since a clock takes a part of a short one to read.
class Looks {
  using Wall = std::chrono::steady_clock;

 public:
  /// Called after each attempt.
  bool due() {
    constexpr long most = 16;
    constexpr double short_one = 1e-4;  // [s]
    if (++attempts_ < until_look_) return false;
    const Wall::time_point now = Wall::now();
    const double taken = std::chrono::duration<double>(now - last_).count();
    const bool short_ones = taken < short_one * static_cast<double>(attempts_);
    until_look_ = short_ones ? std::min(2 * until_look_, most) : 1;
    last_ = now;
    attempts_ = 0;
    return true;
  }

 private:
  Wall::time_point last_ = Wall::now();
  long attempts_ = 0, until_look_ = 1;
};

/// Processor time the calling thread may take from now on.
class TimeLimit {
  using Wall = std::chrono::steady_clock;
  using WallSeconds = std::chrono::duration<double>;

 public:
  explicit TimeLimit(double seconds)
      : end_(processor_time() + seconds),
        earliest_(Wall::now() + WallSeconds(seconds)) {}

  /// A thread's clock takes about as long to read as a short step, the wall's, which no thread is
  /// ahead of, a tenth of that.
  bool over() const { return WallSeconds(Wall::now() - earliest_).count() > 0.0 && left() < 0.0; }

  /// One that is over so much before [s].
  TimeLimit sooner(double seconds) const {
    TimeLimit limit = *this;
    limit.end_ -= seconds;
    limit.earliest_ -= WallSeconds(seconds);
    return limit;
  }

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
