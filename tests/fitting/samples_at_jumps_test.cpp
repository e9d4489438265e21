// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/samples_at_jumps.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
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
  channel.used.resize(signal.values.size());
  std::iota(channel.used.begin(), channel.used.end(), 0);
  return channel;
}

double shown(const SamplesAtJumps& samples, const Shown::Curve& curve, std::size_t number) {
  return samples.values(curve, std::vector{number}).front();
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
  EXPECT_DOUBLE_EQ(shown(samples, late, 9), 0.0);
  EXPECT_DOUBLE_EQ(shown(samples, late, 10), 5.0);
  EXPECT_DOUBLE_EQ(shown(samples, late, 11), 5.0);
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
  EXPECT_DOUBLE_EQ(shown(samples, slope, 10), slope.at(10.0)[0]);
  slope.jumps = {{4.5, 0.0, 0.0}, {10.2, 0.0, 2.0}};
  EXPECT_DOUBLE_EQ(shown(samples, slope, 10), slope.at(10.0)[0]);
}

// A search that is far off has the jump between other samples; never one beyond a sample that is
// on the right side.
TEST(SamplesAtJumps, ShowAJumpElsewhereAsAWhole) {
  std::vector<double> measured(20, 0.0);
  for (std::size_t k = 10; k < measured.size(); ++k) measured[k] = 5.0;
  measured[13] = 0.0;
  for (const double time : {5.6, 8.5, 11.3, 15.9}) {
    const datasets::ImpactSignal signal = signal_of(measured);
    const FittedChannel channel = channel_of(signal);
    const Shown::Curve curve = step_at(time, 5.0);
    const SamplesAtJumps far(channel, {}, curve, true);
    for (std::size_t k = 0; k < 20; ++k)
      EXPECT_NEAR(shown(far, curve, k), k < 10 ? 0.0 : 5.0, 1e-9) << time << " " << k;
  }
}

/// A force that jumps and falls again, on a fine grid [s].
Shown::Curve jumping_curve() {
  Shown::Curve curve{.start = -1e-3, .interval = 0.25e-6, .values = {}, .jumps = {{0.0, 0.0, 5.0}}};
  for (int k = 0; k < 12000; ++k) {
    const double t = curve.start + 0.25e-6 * k;
    curve.values.push_back(k > 4000 ? 5.0 * std::cos(4e3 * t) : 0.0);
  }
  return curve;
}

/// What a recorder has of it that begins at 0, filtered afterwards; touch at a time of its samples,
/// to which side its sample there belongs.
datasets::ImpactSignal filtered_record(const std::vector<datasets::SampleFilter>& filters,
                                       double touch, double interval) {
  datasets::GridSamples taken;
  for (double k = 0.0; k < 2500.0; ++k) {
    const double t = 1e-6 * k - touch;
    taken.values.push_back(t < 0.0 ? 0.0 : 5.0 * std::cos(4e3 * t));
  }
  for (const datasets::SampleFilter& filter : filters) taken = filter.of(taken);
  datasets::ImpactSignal signal = signal_of(taken.values);
  signal.interval = interval;
  signal.filters = filters;
  signal.recorded = {0.0, signal.time(signal.values.size() - 1)};
  // the window begins later than the record
  signal.start = 100.0 * interval;
  signal.values.erase(signal.values.begin(), signal.values.begin() + 100);
  return signal;
}

// Whatever side of a sample the predicted jump is, the filtered samples show it where the recorder
// had it: prediction and record differ by what the predicted time is off, not by a sample's jump.
TEST(SamplesAtJumps, AreFilteredAsTheyWereTaken) {
  const std::vector<std::vector<datasets::SampleFilter>> kinds{
      {{datasets::LowPass{50e3, 4}, 1e-6}},
      {{datasets::LowPass{200e3, 2}, 1e-6}},
      {{datasets::Resample{270e3}, 1e-6}},
      {{datasets::LowPass{80e3, 4}, 1e-6}, {datasets::Resample{270e3}, 1e-6}}};
  const Shown::Curve curve = jumping_curve();
  for (std::size_t kind = 0; kind < kinds.size(); ++kind)
    for (const double late : {0.02e-6, 0.4e-6, 0.98e-6})
      for (const double off : {-0.3e-6, 0.0, 0.3e-6}) {
        SCOPED_TRACE(testing::Message() << kind << " " << late << " " << off);
        const datasets::ImpactSignal signal =
            filtered_record(kinds[kind], 1e-3 + late, kind < 2 ? 1e-6 : 1.0 / 270e3);
        FittedChannel channel = channel_of(signal);
        std::erase_if(channel.used, [&](std::size_t k) { return signal.time(k) > 2e-3; });
        const double touch = 1e-3 + late + off;
        const SamplesAtJumps samples(channel, {.gain = 1.0, .shift = touch}, curve, false);
        const std::vector<double> values = samples.values(curve, channel.used);
        const std::vector<double> slopes = samples.slopes(curve, channel.used);
        // the slope of the force is 80 kN/s at most
        for (std::size_t i = 0; i < values.size(); ++i) {
          if (signal.time(channel.used[i]) < 300e-6) continue;
          ASSERT_NEAR(values[i] + off * slopes[i], channel.measured[channel.used[i]], 1e-4) << i;
          ASSERT_LT(std::abs(slopes[i]), 30e3);
        }
      }
}

}  // namespace
}  // namespace impactrig::fitting
