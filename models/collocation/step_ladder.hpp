// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

namespace impactrig::models {

/// The lengths a step may have, so that what depends on the length alone can be kept: each level is
/// shorter than the one before by √2.
struct StepLadder {
  double longest = 1.0;  ///< [s]

  /// Damping that sets in with a force of its own may stop what it meets, as a light head, within
  /// 1e-12 s, and where the law is singular at touch its first step is a millionth of that.
  static constexpr int levels = 200;

  /// Of a step as a multiple of the one before, by its error.
  static constexpr double largest_growth = 6.0;

  double length_of(int level) const { return longest * std::pow(std::numbers::sqrt2, -level); }

  /// The longest level not longer than h.
  int level_below(double h) const {
    const double level = std::ceil(2.0 * std::log2(longest / h) - 1e-9);
    return static_cast<int>(std::clamp(level, 0.0, levels - 1.0));
  }
};

/// Levels worth a try. Vibration lets a step pass and refuses the same length a moment later: one
/// that was refused is tried again after a step, refused again after two, after four, ...
class RefusedLevel {
 public:
  void refuse(int level) {
    wait_ = level == level_ ? std::min(2 * wait_, longest_wait) : 1;
    level_ = level;
    left_ = wait_;
  }

  /// After a step of `taken`, the level for the next one, `wanted` by its error.
  int after(int taken, int wanted) {
    if (taken <= level_) forget();
    if (wanted > level_ || left_ == 0) return wanted;
    --left_;
    return level_ + 1;
  }

  void forget() { *this = {}; }

 private:
  static constexpr int longest_wait = 32;

  int level_ = -1, wait_ = 1, left_ = 0;
};

}  // namespace impactrig::models
