// SPDX-License-Identifier: BSD-3-Clause
#include "models/collocation/missed_impulse.hpp"

namespace impactrig::models {
namespace {

// Of an interval: a jump as near to a sample is on it.
constexpr double on_sample = 1e-6;

/// Of lines from the sample before to this one, and from one side of a jump to the other's [N s].
double impulse_of_lines(const History& history, std::size_t sample) {
  const double end = history.start + history.interval * static_cast<double>(sample);
  double time = end - history.interval, force = history.force[sample - 1], impulse = 0.0;
  for (const ForceJump& jump : history.jumps) {
    if (jump.time < time - on_sample * history.interval) continue;
    impulse += 0.5 * (force + jump.before) * (jump.time - time);
    time = jump.time;
    force = jump.after;
  }
  return impulse + 0.5 * (force + history.force[sample]) * (end - time);
}

}  // namespace

void MissedImpulse::see_samples(std::size_t from, double impulse_there, double impulse_at_last,
                                History& history) {
  if (changed_)
    history.missed.push_back({time_, impulse_there - impulse_ - impulse_of_lines(history, from)});
  changed_ = false;
  impulse_ = impulse_at_last;
}

}  // namespace impactrig::models
