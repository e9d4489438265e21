// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/sample_filter.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "datasets/band_limited.hpp"
#include "datasets/zero_phase_low_pass.hpp"

namespace impactrig::datasets {
namespace {

constexpr double h = 1e-6;  // of the records [s]

/// A pulse of 200 us with a kink at either end, and vibration at 30 kHz after it; 1 at most or so.
double pulse(double t) {
  if (t < 0.0) return 0.0;
  const double x = std::numbers::pi * t / 200e-6;
  const double ring = 0.1 * std::sin(2.0 * std::numbers::pi * 30e3 * t) * std::exp(-t / 500e-6);
  return (t < 200e-6 ? std::pow(std::sin(x), 1.5) : 0.0) + ring;
}

SampledCurve fine_pulse() {
  SampledCurve curve{.start = -1e-3, .interval = 0.25e-6, .values = {}};
  for (int i = 0; i <= 12000; ++i) curve.values.push_back(pulse(curve.start + 0.25e-6 * i));
  return curve;
}

/// The same as a recorder has it whose samples lie `late` behind whole microseconds.
std::vector<double> recorded_pulse(double late) {
  std::vector<double> values;
  for (int i = -1000; i < 2000; ++i) values.push_back(pulse(h * i + late));
  return values;
}

// What interpolation leaves at the pulse's kinks: see grid_in_pass_band.
constexpr double tolerance = 3e-4;

TEST(SampleFilter, MakesOfACurveWhatALowPassMakesOfItsSamples) {
  for (const double cutoff : {20e3, 50e3, 200e3, 400e3})
    for (const double late : {0.0, 0.1e-6, 0.37e-6, 0.8e-6}) {
      const LowPass action{cutoff, 4};
      const SampledCurve curve = SampleFilter{action, h}.of(fine_pulse());
      const auto record = zero_phase_low_pass(recorded_pulse(late), h, action);
      for (std::size_t i = 500; i < 2500; ++i) {
        const double t = h * (static_cast<double>(i) - 1000.0) + late;
        ASSERT_NEAR(curve.at(t)[0], record[i], tolerance) << cutoff << " " << late << " " << t;
      }
    }
}

TEST(SampleFilter, MakesOfACurveWhatResamplingMakesOfItsSamples) {
  for (const double rate : {150e3, 200e3, 700e3})
    for (const double late : {0.0, 0.3e-6}) {
      const SampledCurve curve = SampleFilter{Resample{rate}, h}.of(fine_pulse());
      const auto record = recorded_pulse(late);
      const BandLimited signal(record, 1e6 / rate);
      for (double k = 100.0; k < 400.0; ++k) {
        const double place = k * 1e6 / rate;
        if (place > 2700.0) break;
        const double t = h * (place - 1000.0) + late;
        ASSERT_NEAR(curve.at(t)[0], signal(place), tolerance) << rate << " " << late << " " << t;
      }
    }
}

// A derivative by what moves a jump: the spike's area passes as a whole, where a low-pass is 1.
TEST(SampleFilter, PassesTheAreaOfASpike) {
  SampledCurve curve{.start = -1e-3, .interval = 0.25e-6, .values = std::vector<double>(8001, 0.0)};
  curve.spikes.push_back({.time = 3.3e-6, .area = 2.5});
  const std::vector<std::variant<LowPass, Resample>> actions{LowPass{50e3, 4}, Resample{200e3}};
  for (const auto& action : actions) {
    const SampledCurve passed = SampleFilter{action, h}.of(curve);
    double area = 0.0, moment = 0.0;
    for (std::size_t i = 0; i < passed.values.size(); ++i) {
      const double t = passed.start + passed.interval * static_cast<double>(i);
      area += passed.interval * passed.values[i];
      moment += passed.interval * passed.values[i] * t;
    }
    EXPECT_NEAR(area, 2.5, 1e-6);
    EXPECT_NEAR(moment / area, 3.3e-6, 1e-10);
    EXPECT_TRUE(passed.jumps.empty());
  }
}

// 1 at one sample: further away than the reach less than 1e-5 of all is left, closer it is more.
TEST(SampleFilter, KnowsHowFarItReaches) {
  for (const double cutoff : {5e3, 50e3, 200e3, 400e3})
    for (const int order : {1, 2, 4, 8}) {
      const SampleFilter filter{LowPass{cutoff, order}, h};
      std::vector<double> record(40001, 0.0);
      record[20000] = 1.0;
      record = zero_phase_low_pass(record, h, {cutoff, order});
      const auto reach = static_cast<std::size_t>(std::ceil(filter.reach() / h));
      double beyond = 0.0, half_way = 0.0;
      for (std::size_t i = 20000 + reach / 2; i < 40000; ++i)
        (i < 20000 + reach ? half_way : beyond) += std::abs(record[i]);
      EXPECT_LT(beyond, 1e-5) << cutoff << " " << order;
      EXPECT_GT(half_way, 1e-5) << cutoff << " " << order;
    }
  const SampleFilter slower{Resample{200e3}, h};
  EXPECT_NEAR(slower.reach(), 32.0 / 0.9 * 5e-6, 1e-12);
  EXPECT_NEAR(slower.pass_band(), 90e3, 1e-6);
  const SampleFilter faster{Resample{3e6}, h};
  EXPECT_NEAR(faster.reach(), 32.0 / 0.9 * h, 1e-12);
  EXPECT_NEAR(faster.pass_band(), 450e3, 1e-6);
}

Record edited(std::vector<Edit> edits) {
  Record record;
  Channel channel;
  channel.name = "speed";
  channel.clock.interval = 5e-6;
  record.channels.push_back(channel);
  record.provenance.edits = std::move(edits);
  return record;
}

const Edit low_passed{"low-pass, zero phase",
                      "way",
                      {{"cutoff", "50000 Hz"}, {"order", "3, forwards and backwards"}}};
const Edit resampled{"resample", "Velocity", {{"from", "1000000 Hz"}, {"to", "200000 Hz"}}};

// Renamed on the way, and made of another channel that was filtered at its own rate.
TEST(SampleFilter, IsToldByTheEditsOfARecord) {
  const Record record =
      edited({low_passed,
              {"low-pass, zero phase", "other", {{"cutoff", "7 Hz"}, {"order", "1, forwards"}}},
              {"differentiate", "way", {{"result", "Velocity"}}},
              resampled,
              {"map channel", "speed", {{"name in file", "Velocity"}}}});
  const auto filters = filters_of(record, record.channels[0]);
  ASSERT_TRUE(filters);
  ASSERT_EQ(filters->size(), 2U);
  const auto& first = std::get<LowPass>(filters->at(0).action);
  EXPECT_EQ(first.cutoff, 50e3);
  EXPECT_EQ(first.order, 3);
  EXPECT_DOUBLE_EQ(filters->at(0).interval, 1e-6);
  EXPECT_EQ(std::get<Resample>(filters->at(1).action).rate, 200e3);
  EXPECT_DOUBLE_EQ(filters->at(1).interval, 1e-6);
}

TEST(SampleFilter, IsNoneWithoutAnyAndWhereItCannotBeTold) {
  const Record plain = edited({{"remove baseline", "speed", {}}});
  EXPECT_EQ(filters_of(plain, plain.channels[0])->size(), 0U);
  for (const Edit& edit :
       {Edit{"resample", "speed", {{"from", "uneven times, joined"}, {"to", "200000 Hz"}}},
        Edit{"low-pass, zero phase", "speed", {{"order", "4, forwards and backwards"}}},
        Edit{"low-pass, zero phase", "speed", {{"cutoff", "50 kHz"}, {"order", "4"}}},
        Edit{"low-pass, zero phase", "speed", {{"cutoff", "150000 Hz"}, {"order", "4"}}},
        Edit{"low-pass, zero phase", "speed", {{"cutoff", "50 Hz"}, {"order", "9"}}}}) {
    const Record record = edited({edit});
    EXPECT_FALSE(filters_of(record, record.channels[0])) << edit.what;
  }
}

}  // namespace
}  // namespace impactrig::datasets
