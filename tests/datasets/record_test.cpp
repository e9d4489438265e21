// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/record.hpp"

#include <gmock/gmock.h>

#include <cmath>

namespace {

using namespace impactrig::datasets;
using testing::ElementsAre;

Channel channel_named(std::string name) {
  Channel channel;
  channel.name = std::move(name);
  return channel;
}

TEST(SampleClock, IsUniformUntilTimesAreStated) {
  SampleClock clock{-1.0, 0.25, {}};
  EXPECT_TRUE(clock.uniform());
  EXPECT_DOUBLE_EQ(clock.time(8), 1.0);
  clock.times = {0.0, 0.1, 0.4};
  EXPECT_FALSE(clock.uniform());
  EXPECT_DOUBLE_EQ(clock.time(2), 0.4);
}

TEST(Channel, ScalesEverySampleType) {
  Channel channel;
  channel.scale = 0.5;
  channel.offset = 1.0;
  for (const RawSamples& raw :
       {RawSamples(std::vector<double>{-2.0, 4.0}), RawSamples(std::vector<float>{-2.0F, 4.0F}),
        RawSamples(std::vector<std::int16_t>{-2, 4}),
        RawSamples(std::vector<std::int32_t>{-2, 4})}) {
    channel.raw = raw;
    EXPECT_EQ(channel.size(), 2u);
    EXPECT_THAT(channel.values(), ElementsAre(0.0, 3.0));
    EXPECT_EQ(channel.value(1), 3.0);
  }
}

TEST(Channel, KeepsASignedZeroWhereNothingIsScaled) {
  Channel channel;
  channel.raw = std::vector<double>{-0.0};
  EXPECT_TRUE(std::signbit(channel.value(0)));
  EXPECT_TRUE(std::signbit(channel.values()[0]));
}

TEST(Channel, IsSoundWhereNothingElseIsSaid) {
  Channel channel;
  EXPECT_TRUE(channel.is_valid(0));
  channel.valid = {1, 0};
  EXPECT_FALSE(channel.is_valid(1));
}

TEST(Record, FindsAChannelByItsExactNameFirst) {
  Record record;
  for (const char* name : {"force", "Force", "1"}) record.channels.push_back(channel_named(name));
  EXPECT_EQ(record.find("Force"), &record.channels[1]);
  EXPECT_EQ(record.find("1"), &record.channels[2]);
}

TEST(Record, FindsAChannelWithoutRegardToCaseWhereOnlyOneMatches) {
  Record record;
  for (const char* name : {"force", "Force", "Velocity"})
    record.channels.push_back(channel_named(name));
  EXPECT_EQ(record.find("VELOCITY"), &record.channels[2]);
  EXPECT_EQ(record.find("FORCE"), nullptr);
}

TEST(Record, FindsAChannelOfAGroupByWhereItsNameEndsWhereOnlyOneDoes) {
  Record record;
  for (const char* name : {"/Force", "/a/speed", "/b/speed", "/a/Way"})
    record.channels.push_back(channel_named(name));
  EXPECT_EQ(record.find("force"), &record.channels[0]);
  EXPECT_EQ(record.find("Way"), &record.channels[3]);
  EXPECT_EQ(record.find("speed"), nullptr);
  EXPECT_EQ(record.find("a/speed"), nullptr);
}

TEST(Record, FindsAChannelByItsIndex) {
  Record record;
  for (const char* name : {"a", "b"}) record.channels.push_back(channel_named(name));
  EXPECT_EQ(record.find("0"), &record.channels[0]);
  EXPECT_EQ(record.find("1"), &record.channels[1]);
  for (const char* none : {"2", "-1", "1x", "", "99999999999999999999999"})
    EXPECT_EQ(record.find(none), nullptr) << none;
}

TEST(ProgramVersion, IsThatOfTheBuild) {
  EXPECT_THAT(program_version(), testing::MatchesRegex("impactrig [0-9]+\\.[0-9]+\\.[0-9]+"));
}

}  // namespace
