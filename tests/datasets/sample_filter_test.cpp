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

/// The same as a recorder has it, whose first sample is 1 ms before.
std::vector<double> recorded_pulse() {
  std::vector<double> values;
  for (int i = -1000; i < 2000; ++i) values.push_back(pulse(h * i));
  return values;
}

/// Samples 317 to 2755 of a record.
GridSamples stretch_of(const std::vector<double>& record) {
  return {317, {record.begin() + 317, record.begin() + 2756}};
}

// What the record's other samples change within a filter's reach of the ends is left out.
TEST(SampleFilter, MakesOfAStretchWhatALowPassMakesOfTheRecord) {
  for (const double cutoff : {20e3, 50e3, 200e3, 400e3}) {
    const SampleFilter filter{LowPass{cutoff, 4}, h};
    const std::vector<double> whole = zero_phase_low_pass(recorded_pulse(), h, {cutoff, 4});
    const GridSamples stretch = filter.of(stretch_of(recorded_pulse()));
    const auto reach = static_cast<std::size_t>(std::ceil(filter.reach() / h));
    ASSERT_EQ(stretch.first, 317);
    ASSERT_EQ(stretch.values.size(), 2439U);
    for (std::size_t k = reach; k + reach < 2439; ++k)
      ASSERT_NEAR(stretch.values[k], whole[317 + k], 1e-5) << cutoff << " " << k;
  }
}

TEST(SampleFilter, MakesOfAStretchWhatResamplingMakesOfTheRecord) {
  const std::vector<double> record = recorded_pulse();
  for (const double rate : {150e3, 200e3, 700e3, 1.7e6}) {
    const SampleFilter filter{Resample{rate}, h};
    const BandLimited whole(record, std::max(1.0, 1e6 / rate));
    const GridSamples stretch = filter.of(stretch_of(record));
    const auto first = static_cast<double>(stretch.first);
    EXPECT_NEAR(first, 317.0 * rate * h + 0.5, 0.5);
    EXPECT_NEAR(first + static_cast<double>(stretch.values.size()), 2755.0 * rate * h + 0.5, 0.5);
    for (std::size_t k = 0; k < stretch.values.size(); ++k) {
      const double place = (first + static_cast<double>(k)) / (rate * h);
      if (place < 317.0 + filter.reach() / h || place > 2755.0 - filter.reach() / h) continue;
      ASSERT_NEAR(stretch.values[k], whole(place), 1e-9) << rate << " " << k;
    }
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

// In a recording joined of two, each with a channel of that name.
TEST(SampleFilter, OfAnotherFilesChannelIsNotIts) {
  Edit other = low_passed, own = low_passed;
  other.channel = own.channel = "speed";
  other.parameters.emplace(recorded_in, "shot-1.uff");
  own.parameters.emplace(recorded_in, "shot-2.uff");
  own.parameters["cutoff"] = "20000 Hz";
  Record record = edited({other, own});
  record.channels[0].attributes.emplace(recorded_in, "shot-2.uff");
  const auto filters = filters_of(record, record.channels[0]);
  ASSERT_EQ(filters->size(), 1U);
  EXPECT_EQ(std::get<LowPass>(filters->at(0).action).cutoff, 20e3);
}

// By a map that is stated once, and then again.
TEST(SampleFilter, FollowsNamesThatAMapExchanges) {
  const auto named = [](const char* now, const char* before) {
    return Edit{"map channel", now, {{"map", "swap.toml"}, {"name in file", before}}};
  };
  const std::vector<Edit> swap = {named("way", "speed"), named("speed", "way")};
  const Record once = edited({low_passed, swap[0], swap[1]});
  EXPECT_EQ(filters_of(once, once.channels[0])->size(), 1U);
  const Record turned = edited({low_passed, swap[1], swap[0]});
  EXPECT_EQ(filters_of(turned, turned.channels[0])->size(), 1U);
  const Record twice = edited({low_passed, swap[0], swap[1], swap[0], swap[1]});
  EXPECT_EQ(filters_of(twice, twice.channels[0])->size(), 0U);
  EXPECT_EQ(edits_of(twice, twice.channels[0]).size(), 2U);
}

TEST(SampleFilter, IsNoneWithoutAnyAndWhereItCannotBeTold) {
  const Record plain = edited({{"remove baseline", "speed", {}}});
  EXPECT_EQ(filters_of(plain, plain.channels[0])->size(), 0U);
  const Record as_it_was =
      edited({{"resample", "speed", {{"from", "200000 Hz"}, {"to", "200000 Hz"}}}});
  EXPECT_EQ(filters_of(as_it_was, as_it_was.channels[0])->size(), 0U);
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
