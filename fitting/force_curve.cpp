// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/force_curve.hpp"

namespace impactrig::fitting {

datasets::SampledCurve force_curve(const models::History& history) {
  datasets::SampledCurve curve{
      .start = history.start, .interval = history.interval, .values = history.seen_force()};
  for (const models::ForceJump& jump : history.jumps)
    curve.jumps.push_back({jump.time, jump.before, jump.after});
  for (const models::SampleImpulse& known : history.impulses)
    datasets::add_missed(curve, known.time, known.sample, known.impulse);
  return curve;
}

}  // namespace impactrig::fitting
