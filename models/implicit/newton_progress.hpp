// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

namespace impactrig::models {

/// Watches simplified Newton iterations, step after step, and tells when a step is solved. What one
/// step shows of the contraction holds for the next, less and less, so that a good step needs a
/// single iteration.
class NewtonProgress {
 public:
  explicit NewtonProgress(double tolerance) : tolerance_(tolerance) {}

  /// A step that is this part of the contact's time.
  void begin_step(double part) {
    allowed_ = tolerance_ * std::min(1.0, most_steps * part);
    iterations_ = 0;
    moved_ = 0.0;
    rounded_ = false;
    contraction_ = std::pow(std::max(contraction_, 1e-12), 0.9);
  }

  /// An iteration has moved the solution this far; less than `rounding` may be noise. False when
  /// the iterations lead nowhere.
  bool improved(double size, double rounding) {
    if (!std::isfinite(size)) return false;
    ++iterations_;
    if (iterations_ > 1 && moved_ > 0.0) contraction_ = size / moved_;
    moved_ = size;
    if (iterations_ < 3 || contraction_ < 0.3) return true;
    rounded_ = size <= rounding;
    return rounded_ || contraction_ < 0.9;
  }

  /// The contact has moved it further.
  void pressed(double size) { moved_ += size; }

  bool settled() const {
    const double left = std::min(1.0, contraction_ / std::max(1.0 - contraction_, 0.1)) * moved_;
    return rounded_ || left <= allowed_;
  }

  /// Whether the iterations of the step converged slower than the linear system behind them should
  /// let them: it is out of date.
  bool slow() const { return iterations_ > 1 && contraction_ > 0.01; }

 private:
  // With more steps to a contact, each may leave less: they leave it with the same sign.
  static constexpr double most_steps = 1000.0;

  double tolerance_;
  double allowed_ = 0.0;
  int iterations_ = 0;
  double moved_ = 0.0;
  double contraction_ = 1.0;
  bool rounded_ = false;
};

}  // namespace impactrig::models
