// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "models/simulation.hpp"

namespace impactrig::models {

/// Tells a history what the first stop's force passes on from sample to sample where a contact
/// begins, changes or ends, and on to the next: there lines between samples miss much of a force
/// that rises as the fourth root of time. The same of its derivatives, which may rise without
/// bounds.
class SampleImpulses {
 public:
  /// The force changes its law at a time [s].
  void note_change(double time) {
    if (wanted_ < told) time_ = time;
    wanted_ = told;
  }

  /// Whether the next sample is to be seen. The last of several in a row is in any case.
  bool wants() const { return wanted_ > 0; }

  /// The history has this sample now, up to which the force has passed on an impulse [N s].
  void see(std::size_t sample, double impulse, History& history) {
    if (wanted_ > 0) history.impulses.push_back({time_, sample, impulse - impulse_});
    if (wanted_ > 0) --wanted_;
    time_ = history.start + history.interval * static_cast<double>(sample);
    impulse_ = impulse;
  }

 private:
  static constexpr int told = 2;  // intervals after a change

  int wanted_ = 0;
  double time_ =
      0.0;  // of the change in the interval that the next sample ends, or its beginning [s]
  double impulse_ = 0.0;  // up to the last sample [N s]
};

}  // namespace impactrig::models
