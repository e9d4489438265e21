// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "models/simulation.hpp"

namespace impactrig::models {

/// Tells a history what the first stop's force passes on from sample to sample where a contact
/// begins, changes or ends: there lines between samples miss much of a force that rises as the
/// fourth root of time. The same of its derivatives.
class SampleImpulses {
 public:
  /// The force changes its law at a time [s].
  void note_change(double time) {
    if (!changed_) time_ = time;
    changed_ = true;
  }

  /// Whether it did since the last sample.
  bool changed() const { return changed_; }

  /// The history has samples from this one on that it had not; up to it, and up to the last, the
  /// force has passed on these impulses [N s].
  void see_samples(std::size_t from, double impulse_there, double impulse_at_last,
                   History& history) {
    if (changed_) history.impulses.push_back({time_, from, impulse_there - impulse_});
    changed_ = false;
    impulse_ = impulse_at_last;
  }

 private:
  bool changed_ = false;
  double time_ = 0.0;     // when it did first [s]
  double impulse_ = 0.0;  // up to the last sample [N s]
};

}  // namespace impactrig::models
