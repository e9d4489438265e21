// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/recording_reader.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <vector>

#include "datasets/record.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Channel;
using datasets::Record;

/// One channel of 0, 1, 2, ... at these times.
Record sampled_at(std::vector<double> times) {
  Record record;
  Channel channel;
  channel.name = "Force";
  channel.unit = "N";
  std::vector<double> values;
  for (std::size_t i = 0; i < times.size(); ++i) values.push_back(static_cast<double>(i));
  channel.raw = std::move(values);
  channel.clock = {times.front(), 1e-3, std::move(times)};
  record.channels.push_back(std::move(channel));
  return record;
}

Selection between(double from, double to) {
  Selection wanted;
  wanted.from = from;
  wanted.to = to;
  return wanted;
}

/// Every millisecond, but for 10 s between sample 100 and 101.
std::vector<double> with_gap() {
  std::vector<double> times;
  for (int i = 0; i < 200; ++i) times.push_back(1e-3 * i + (i > 100 ? 10.0 : 0.0));
  return times;
}

TEST(Window, WithoutTheGapIsEven) {
  const auto reader = reader_of(sampled_at(with_gap()));
  const Record part = read_into_memory(*reader, between(10.15, 20.0));
  ASSERT_EQ(part.channels[0].size(), 50U);
  EXPECT_TRUE(part.channels[0].clock.uniform());
  EXPECT_DOUBLE_EQ(part.channels[0].clock.start, 10.15);
  EXPECT_EQ(part.channels[0].clock.interval, 1e-3);
  EXPECT_EQ(part.channels[0].value(0), 150.0);
  EXPECT_EQ(part.warnings,
            std::vector<std::string>{"the samples between 10.15 and 10.199 s are evenly spaced, "
                                     "and a step of 0.001 s stands for their times"});
}

TEST(Window, WithTheGapKeepsItsTimes) {
  const auto reader = reader_of(sampled_at(with_gap()));
  const Record part = read_into_memory(*reader, between(0.05, 10.15));
  ASSERT_EQ(part.channels[0].size(), 101U);
  ASSERT_EQ(part.channels[0].clock.times.size(), 101U);
  EXPECT_EQ(part.channels[0].clock.times[51], 10.101);
  EXPECT_TRUE(part.warnings.empty());
}

// No step can be told of one sample, nor of several at one time; two show nothing of evenness.
TEST(Window, WithoutAStepKeepsItsTimes) {
  std::vector<double> times = with_gap();
  const auto one = reader_of(sampled_at(times));
  for (const double last : {0.0505, 0.0515})
    EXPECT_FALSE(read_into_memory(*one, between(0.0495, last)).channels[0].clock.uniform());
  times[50] = times[49] = times[51];
  const auto same = reader_of(sampled_at(times));
  const Record part = read_into_memory(*same, between(0.0505, 0.0515));
  ASSERT_EQ(part.channels[0].size(), 3U);
  EXPECT_EQ(part.channels[0].clock.times, std::vector<double>(3, times[51]));
}

TEST(Window, OfAllThatThereIsKeepsItsTimes) {
  std::vector<double> times = with_gap();
  const auto reader = reader_of(sampled_at(times));
  EXPECT_EQ(read_into_memory(*reader).channels[0].clock.times, times);
}

// Channels that share their times are told of once, others by themselves.
TEST(Window, IsJudgedForEachChannel) {
  Record record = sampled_at(with_gap());
  record.channels.push_back(record.channels[0]);
  std::vector<double> twice = with_gap();
  for (double& time : twice) time *= 2.0;
  record.channels.push_back(sampled_at(twice).channels[0]);
  twice[10] += 1e-3;
  record.channels.push_back(sampled_at(twice).channels[0]);
  const Record part = read_into_memory(*reader_of(record), between(0.0, 0.09));
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(part.channels[i].clock.uniform(), i < 3) << i;
  EXPECT_EQ(part.channels[1].clock.interval, 1e-3);
  EXPECT_EQ(part.channels[2].clock.interval, 2e-3);
  EXPECT_EQ(part.channels[3].clock.times.size(), part.channels[3].size());
  EXPECT_EQ(part.warnings.size(), 2U);
}

}  // namespace
}  // namespace impactrig::acquisition
