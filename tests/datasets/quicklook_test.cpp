// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/quicklook.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

namespace {

using namespace impactrig::datasets;
using testing::DoubleEq;
using testing::ElementsAre;
using testing::NanSensitiveDoubleEq;

TEST(Quicklook, ShowsAFewSamplesAsTheyAreInSiUnits) {
  Channel channel;
  channel.quantity = Quantity::velocity;
  channel.unit = "mm/s";
  channel.clock = {1.0, 0.5, {}};
  channel.raw = std::vector<std::int16_t>{1, 2, 3};
  channel.scale = 10.0;
  channel.valid = {1, 0, 1};
  const Quicklook look = quicklook_of(channel, 10);
  EXPECT_EQ(look.unit, "m/s");
  EXPECT_THAT(look.time, ElementsAre(1.0, 1.5, 2.0));
  EXPECT_THAT(look.values,
              ElementsAre(DoubleEq(0.01), NanSensitiveDoubleEq(std::nan("")), DoubleEq(0.03)));
  EXPECT_TRUE(look.imaginary.empty());
}

TEST(Quicklook, KeepsTheUnitItCannotConvert) {
  Channel channel;
  channel.quantity = Quantity::other;
  channel.unit = "FS";
  channel.raw = std::vector<double>{1.0};
  channel.imaginary = {2.0};
  const Quicklook look = quicklook_of(channel, 10);
  EXPECT_EQ(look.unit, "FS");
  EXPECT_THAT(look.values, ElementsAre(1.0));
  EXPECT_THAT(look.imaginary, ElementsAre(2.0));
}

TEST(Quicklook, KeepsThePeakOfAShortImpactAndTheOrderOfTime) {
  Channel channel;
  channel.clock = {0.0, 1.0, {}};
  std::vector<double> values(100003, 0.0);
  values[77777] = 5.0;
  values[77778] = -7.0;
  channel.raw = values;
  const Quicklook look = quicklook_of(channel, 1000);
  EXPECT_LE(look.values.size(), 1000u);
  EXPECT_GE(look.values.size(), 500u);
  EXPECT_TRUE(std::ranges::is_sorted(look.time));
  EXPECT_EQ(look.time.front(), 0.0);
  const auto peak = std::ranges::find(look.values, 5.0);
  ASSERT_NE(peak, look.values.end());
  EXPECT_EQ(look.time[static_cast<std::size_t>(peak - look.values.begin())], 77777.0);
  EXPECT_EQ(*std::next(peak), -7.0);
}

TEST(Quicklook, LeavesOutInvalidSamplesWhereThereAreOthers) {
  Channel channel;
  channel.raw = std::vector<double>{9.0, 1.0, 2.0, 9.0, 9.0, 9.0};
  channel.valid = {0, 1, 1, 0, 0, 0};
  channel.clock.interval = 1.0;
  EXPECT_THAT(quicklook_of(channel, 4).values,
              ElementsAre(1.0, 2.0, NanSensitiveDoubleEq(std::nan(""))));
}

}  // namespace
