// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <limits>

#include "models/sensitivities/motion_slope.hpp"

namespace impactrig::models {

/// How the iteration that solves a step of a MotionSlope goes, from one improvement to the next.
class SlopeProgress {
 public:
  enum class State { goes_on, settled, leads_nowhere };

  /// `accuracy`: of the run.
  explicit SlopeProgress(double accuracy) : tolerance_(share * accuracy) {}

  void begin_step() {
    before_ = std::numeric_limits<double>::infinity();
    iterations_ = 0;
  }

  /// After an improvement, and what answering forces changed by besides.
  State improved(const MotionSlope::Change& change, double answered = 0.0) {
    const double size = change.size + answered;
    if (iterations_ > 0) rate_ = std::clamp(size / before_, fastest_rate, 1.0);
    const double left = rate_ * size;  // that the next iteration would change
    const double scale = std::max(1.0, change.of);
    if (left <= tolerance_ * scale) return State::settled;
    // what may be rounding is, once it does not become less: in a short step it may be all there is
    const bool stays = iterations_ > 0 && size > slow * before_;
    if (stays && size <= change.rounding * scale) return State::settled;
    if (!(size < 1e3 * before_)) return State::leads_nowhere;
    before_ = size;
    if (++iterations_ < most_iterations) return State::goes_on;
    rate_ = 1.0;
    return State::leads_nowhere;
  }

 private:
  // Of the accuracy asked for, what the iteration may leave of a slope.
  static constexpr double share = 0.01;
  static constexpr int most_iterations = 50;
  // No iteration is trusted to leave less than this of a change.
  static constexpr double fastest_rate = 0.01;
  static constexpr double slow = 0.3;

  double tolerance_;
  double rate_ = 1.0;  // at which it converges, from step to step
  double before_ = 0.0;
  int iterations_ = 0;
};

}  // namespace impactrig::models
