// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/sampled_curve.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

namespace {

using namespace impactrig::datasets;
using std::numbers::pi;

using Function = std::function<double(double)>;

/// Of one function up to a time, of another beyond it; 40 samples a time unit apart from -10 on.
SampledCurve joined(const Function& before, const Function& after, double time) {
  SampledCurve curve{.start = -10.0, .interval = 1.0, .values = {}};
  for (int k = 0; k < 40; ++k) {
    const double t = -10.0 + k;
    curve.values.push_back(t <= time ? before(t) : after(t));
  }
  curve.jumps = {{time, before(time), after(time)}};
  return curve;
}

const Function cubic = [](double t) { return 2.0 + t * (0.5 - t * (0.01 + 3e-3 * t)); };
const Function other = [](double t) { return 7.0 - t * (1.5 - t * (0.02 - 1e-3 * t)); };

TEST(SampledCurve, IsExactOfCubicsToBothSidesOfAJump) {
  for (const double time : {0.0, 0.02, 0.3, 0.5, 0.97, -6.6, 24.3}) {
    SCOPED_TRACE(time);
    const SampledCurve curve = joined(cubic, other, time);
    for (double t = -9.0; t < 28.0; t += 0.0371) {
      const Function& there = t < time ? cubic : other;
      const double h = 1e-3;
      EXPECT_NEAR(curve.at(t)[0], there(t), 1e-9) << t;
      EXPECT_NEAR(curve.at(t)[1], (there(t + h) - there(t - h)) / (2.0 * h), 1e-6) << t;
    }
    EXPECT_NEAR(curve.at(time)[0], other(time), 1e-9);
    EXPECT_NEAR(curve.at(time + 0.8, 0)[0], cubic(time + 0.8), 1e-9);  // either piece goes on
    EXPECT_NEAR(curve.at(time - 0.8, 1)[0], other(time - 0.8), 1e-9);
  }
}

TEST(SampledCurve, StandsStillBeyondItsEnds) {
  const SampledCurve curve = joined(cubic, other, 0.3);
  EXPECT_EQ(curve.at(-50.0)[0], curve.values.front());
  EXPECT_EQ(curve.at(-50.0)[1], 0.0);
  EXPECT_EQ(curve.at(50.0)[0], curve.values.back());
}

TEST(SampledCurve, KnowsPiecesBetweenJumpsThatHoldFewSamples) {
  SampledCurve curve{.start = 0.0, .interval = 1.0, .values = {0, 0, 0, 0, 5, 1, 1, 1, 1}};
  curve.jumps = {{3.5, 0.0, 5.0}, {4.4, 5.0, 1.0}, {4.6, 1.0, 2.0}, {4.7, 2.0, 1.0}};
  EXPECT_NEAR(curve.at(3.4)[0], 0.0, 1e-12);
  EXPECT_NEAR(curve.at(3.6)[0], 5.0, 1e-12);
  EXPECT_NEAR(curve.at(4.5)[0], 1.0, 1e-12);
  EXPECT_NEAR(curve.at(4.65)[0], 2.0, 1e-12);
  EXPECT_NEAR(curve.at(5.5)[0], 1.0, 1e-12);
}

SampledCurve step(double time, double size) {
  return joined([](double) { return 0.0; }, [=](double) { return size; }, time);
}

// Closed form 1 - exp(-w t) of a first-order low-pass, cos and sine of a damped resonance.
TEST(SampledCurve, StepsGoThroughASensorsChainExactlyWhereverTheyAre) {
  Sensor low;
  low.high_cut = BandLimit{0.02, 1};
  Sensor ringing;
  ringing.resonance = Resonance{0.07, 4.0};
  const double w = 2.0 * pi * 0.02, w0 = 2.0 * pi * 0.07, zeta = 1.0 / 8.0;
  const double wd = w0 * std::sqrt(1.0 - zeta * zeta);
  const auto rings = [&](double t) {
    return 1.0 - std::exp(-zeta * w0 * t) * (std::cos(wd * t) + zeta * w0 / wd * std::sin(wd * t));
  };
  for (const double time : {0.0, 1e-5, 0.3, 0.999}) {
    SCOPED_TRACE(time);
    const SampledCurve after_low = sensor_response(low, step(time, 3.0));
    const SampledCurve after_ringing = sensor_response(ringing, step(time, 3.0));
    for (int k = 0; k < 40; ++k) {
      const double t = -10.0 + k - time;
      const auto sample = static_cast<std::size_t>(k);
      EXPECT_NEAR(after_low.values[sample], t > 0.0 ? 3.0 * (1.0 - std::exp(-w * t)) : 0.0, 1e-12);
      EXPECT_NEAR(after_ringing.values[sample], t > 0.0 ? 3.0 * rings(t) : 0.0, 1e-12);
    }
    EXPECT_NEAR(after_low.at(time + 0.2)[0], 3.0 * (1.0 - std::exp(-0.2 * w)), 1e-4);
    EXPECT_NEAR(after_low.jumps[0].after, 0.0, 1e-12);
  }
}

TEST(SampledCurve, AHighPassLetsAStepThrough) {
  Sensor sensor;
  sensor.low_cut = BandLimit{0.01, 1};
  const double w = 2.0 * pi * 0.01;
  const SampledCurve shown = sensor_response(sensor, step(0.3, 3.0));
  EXPECT_NEAR(shown.jumps[0].before, 0.0, 1e-12);
  EXPECT_NEAR(shown.jumps[0].after, 3.0, 1e-12);
  EXPECT_NEAR(shown.at(0.5)[0], 3.0 * std::exp(-0.2 * w), 1e-6);
  EXPECT_NEAR(shown.values[20], 3.0 * std::exp(-9.7 * w), 1e-12);
}

// What a step's response changes by when the step moves: a spike's.
TEST(SampledCurve, SpikesAreDerivativesOfStepsThatMove) {
  Sensor sensor;
  sensor.resonance = Resonance{0.07, 4.0};
  sensor.low_cut = BandLimit{0.004, 2};
  sensor.high_cut = BandLimit{0.2, 3};
  const double size = 3.0, time = 0.3, h = 1e-4;
  SampledCurve spike = step(time, 0.0);
  spike.spikes = {{time, -size}};
  const SampledCurve shown = sensor_response(sensor, spike);
  const SampledCurve quotient =
      difference_quotient(sensor_response(sensor, step(time + h, size)),
                          sensor_response(sensor, step(time - h, size)), 2.0 * h);
  for (std::size_t k = 0; k < 40; ++k) EXPECT_NEAR(shown.values[k], quotient.values[k], 1e-6) << k;
}

// Closed form w exp(-w t) of a first-order low-pass; what is shown on a sample is before it.
TEST(SampledCurve, SpikesGoThroughASensorsChainWhereverTheyAre) {
  Sensor sensor;
  sensor.high_cut = BandLimit{0.02, 1};
  const double w = 2.0 * pi * 0.02;
  for (const double time : {0.0, 1e-8, 0.3, 0.999}) {
    SCOPED_TRACE(time);
    SampledCurve curve = step(0.5, 0.0);
    curve.spikes = {{time, 2.0}, {time + 0.1, 1.0}, {5.0, -0.5}};
    const SampledCurve shown = sensor_response(sensor, curve);
    EXPECT_TRUE(shown.spikes.empty());
    const auto after = [&](double t) { return t > 1e-6 ? w * std::exp(-w * t) : 0.0; };
    for (std::size_t k = 0; k < 40; ++k) {
      const double t = -10.0 + static_cast<double>(k);
      EXPECT_NEAR(shown.values[k],
                  2.0 * after(t - time) + after(t - time - 0.1) - 0.5 * after(t - 5.0), 1e-9)
          << k;
    }
  }
}

// They part an interval, over which the input is still a line.
TEST(SampledCurve, SpikesOfNoAreaChangeNothing) {
  Sensor sensor;
  sensor.resonance = Resonance{0.07, 4.0};
  SampledCurve curve = step(0.6, 3.0);
  for (std::size_t k = 0; k < curve.values.size(); ++k)
    curve.values[k] += std::sin(0.4 * static_cast<double>(k));
  SampledCurve parted = curve;
  parted.spikes = {{-3.3, 0.0}, {0.2, 0.0}, {0.6, 0.0}, {0.9, 0.0}, {4.0, 0.0}};
  const SampledCurve whole = sensor_response(sensor, curve);
  parted = sensor_response(sensor, parted);
  for (std::size_t k = 0; k < 40; ++k) EXPECT_NEAR(whole.values[k], parted.values[k], 1e-12) << k;
  EXPECT_NEAR(whole.jumps[0].after, parted.jumps[0].after, 1e-12);
}

TEST(SampledCurve, SpikesMakeUpForWhatLinesMiss) {
  SampledCurve curve{.start = -1.0, .interval = 0.5, .values = {0.0, 0.0, 2.0, 3.0, 3.0}};
  curve.jumps = {{-0.5, 0.0, 1.0}, {-0.1, 1.5, 0.5}, {0.0, 2.0, 4.0}};
  curve.spikes = {{-0.1, 0.25}, {0.7, 1.0}};
  // of value 2: 0.4 (1 + 1.5) / 2, 0.1 (0.5 + 2) / 2 and the spike
  add_missed(curve, -0.3, 2, 2.0);
  ASSERT_EQ(curve.spikes.size(), 3u);
  EXPECT_EQ(curve.spikes[0].time, -0.3);
  EXPECT_NEAR(curve.spikes[0].area, 2.0 - 0.5 - 0.125 - 0.25, 1e-15);
  EXPECT_EQ(curve.spikes[2].time, 0.7);
  // of value 3: from the jump's other side
  add_missed(curve, 0.2, 3, 2.0);
  EXPECT_NEAR(curve.spikes[2].area, 2.0 - 0.5 * 0.5 * (4.0 + 3.0), 1e-15);
}

TEST(SampledCurve, QuotientsLeaveNoSpikeWhereAJumpPassedASample) {
  const double rate = 0.25;
  const auto moved = [&](double by) {
    return joined([=](double t) { return cubic(t) + rate * by; },
                  [=](double t) { return other(t) - rate * by; }, 0.0 + by);
  };
  const SampledCurve quotient = difference_quotient(moved(0.01), moved(-0.01), 0.02);
  for (double t = -5.0; t < 5.0; t += 0.093)
    EXPECT_NEAR(quotient.at(t)[0], t < 0.0 ? rate : -rate, 1e-8) << t;
}

}  // namespace
