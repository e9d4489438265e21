// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "models/simulation.hpp"

namespace impactrig::models {

/// Tells a history what lines between the samples of the first stop's force miss of its impulse
/// where a contact begins, changes or ends: there a force may rise as the fourth root of time.
class MissedImpulse {
 public:
  /// The force changes its law at a time [s].
  void note_change(double time) {
    if (!changed_) time_ = time;
    changed_ = true;
  }

  /// The history has samples from this one on that it had not; up to it, and up to the last, the
  /// force has passed on these impulses [N s].
  void see_samples(std::size_t from, double impulse_there, double impulse_at_last,
                   History& history);

 private:
  bool changed_ = false;  // since the last sample
  double time_ = 0.0;     // when it did first [s]
  double impulse_ = 0.0;  // up to the last sample [N s]
};

}  // namespace impactrig::models
