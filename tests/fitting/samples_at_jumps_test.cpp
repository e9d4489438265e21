// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/samples_at_jumps.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace impactrig::fitting {
namespace {

datasets::ImpactSignal signal_of(const std::vector<double>& values) {
  datasets::ImpactSignal signal;
  signal.quantity = datasets::Quantity::force;
  signal.interval = 1.0;
  signal.values = values;
  return signal;
}

FittedChannel channel_of(const datasets::ImpactSignal& signal) {
  FittedChannel channel;
  channel.signal = &signal;
  channel.measured = signal.values;
  return channel;
}

Shown::Curve step_at(double time, double height) {
  Shown::Curve curve{.start = 0.0, .interval = 1.0, .values = {}, .jumps = {{time, 0.0, height}}};
  for (int k = 0; k < 20; ++k) curve.values.push_back(k > time ? height : 0.0);
  return curve;
}

TEST(SamplesAtJumps, ShowTheSideThatIsNearerToWhatWasMeasured) {
  std::vector<double> measured(20, 0.0);
  for (std::size_t k = 10; k < measured.size(); ++k) measured[k] = 5.0;
  const datasets::ImpactSignal signal = signal_of(measured);
  const FittedChannel channel = channel_of(signal);
  const Shown::Curve late = step_at(10.4, 5.0);
  const SamplesAtJumps samples(channel, {}, late, false);
  EXPECT_DOUBLE_EQ(samples.at(late, 9)[0], 0.0);
  EXPECT_DOUBLE_EQ(samples.at(late, 10)[0], 5.0);
  EXPECT_DOUBLE_EQ(samples.at(late, 11)[0], 5.0);
}

// A slope from simulations to both sides has no jumps where these have not as many.
TEST(SamplesAtJumps, TakeACurveWithOtherJumpsAsItIs) {
  std::vector<double> measured(20, 0.0);
  for (std::size_t k = 10; k < measured.size(); ++k) measured[k] = 5.0;
  const datasets::ImpactSignal signal = signal_of(measured);
  const FittedChannel channel = channel_of(signal);
  const SamplesAtJumps samples(channel, {}, step_at(10.4, 5.0), false);
  Shown::Curve slope = step_at(10.4, 2.0);
  slope.jumps.clear();
  EXPECT_DOUBLE_EQ(samples.at(slope, 10)[0], slope.at(10.0)[0]);
  slope.jumps = {{4.5, 0.0, 0.0}, {10.2, 0.0, 2.0}};
  EXPECT_DOUBLE_EQ(samples.at(slope, 10)[0], slope.at(10.0)[0]);
}

}  // namespace
}  // namespace impactrig::fitting
