// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/date_time.hpp"

#include <gmock/gmock.h>

namespace impactrig::acquisition {
namespace {

using testing::Optional;

std::optional<double> seconds(std::string_view from, std::string_view to) {
  const auto first = date_time_in(from);
  const auto second = date_time_in(to);
  EXPECT_TRUE(first) << from;
  EXPECT_TRUE(second) << to;
  if (!first || !second) return std::nullopt;
  return seconds_between(*first, *second);
}

struct Spelling {
  const char* text;
  const char* iso;
};

class DateTimeSpelling : public testing::TestWithParam<Spelling> {};

TEST_P(DateTimeSpelling, IsRead) {
  const auto found = date_time_in(GetParam().text);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->iso(), GetParam().iso);
}

INSTANTIATE_TEST_SUITE_P(
    Spellings, DateTimeSpelling,
    testing::Values(Spelling{"2024-03-01 12:00:00.5", "2024-03-01T12:00:00.5"},
                    Spelling{"2024-03-01T12:00:00.123456789Z", "2024-03-01T12:00:00.123456789Z"},
                    Spelling{"2024-03-01T00:30:00,25+01:00", "2024-03-01T00:30:00.25+01:00"},
                    Spelling{"2024-03-01T23:30:00-0530", "2024-03-01T23:30:00-05:30"},
                    Spelling{"2024/3/1 7:05:09", "2024-03-01T07:05:09"},
                    Spelling{"01.03.2024 12:00:00,5", "2024-03-01T12:00:00.5"},
                    Spelling{"1.3.24;12:00:00", "2024-03-01T12:00:00"},
                    Spelling{"13/02/2024 12:00:00", "2024-02-13T12:00:00"},
                    Spelling{"02/13/2024 12:00:00", "2024-02-13T12:00:00"},
                    Spelling{"2/13/2024 12:00:00 AM", "2024-02-13T00:00:00"},
                    Spelling{"2/13/2024,1:02:03.5 p.m.", "2024-02-13T13:02:03.5"},
                    Spelling{"01-Mar-2024 12:00:00", "2024-03-01T12:00:00"},
                    Spelling{"1 March 2024 12:00:00:250", "2024-03-01T12:00:00.25"},
                    Spelling{"2024-03-01 12:00:00:000250", "2024-03-01T12:00:00.00025"},
                    Spelling{"2024-03-01 12:00:00:000000250", "2024-03-01T12:00:00.00000025"},
                    Spelling{"Mar 1, 2024 12:00:00", "2024-03-01T12:00:00"},
                    Spelling{"29-feb-24 23:59:60", "2024-02-29T24:00:00"},
                    Spelling{"\"2024-03-01\",\"12:00:00\"", "2024-03-01T12:00:00"},
                    Spelling{"12:00:00.5\t2024-03-01", "2024-03-01T12:00:00.5"},
                    Spelling{"2024-03-01", "2024-03-01"},
                    Spelling{"2024-03-01 12:00", "2024-03-01T12:00:00"},
                    Spelling{"01/02/2024 12:00:00", ""}, Spelling{"24-03-01 12:00:00", ""},
                    Spelling{"20240301T120000.5", "2024-03-01T12:00:00.5"},
                    Spelling{"20240301T1205Z", "2024-03-01T12:05:00Z"},
                    Spelling{"12:00:00.5", ""}));

TEST(DateTime, WhatIsNoneIsRefused) {
  for (const char* text : {"",
                           "1.5",
                           "12",
                           "12:00",
                           "1:2:3",
                           "12:60:00",
                           "12:00:61",
                           "2024-13-01",
                           "2023-02-29",
                           "30.02.2024",
                           "32/13/2024",
                           "0:00:00 PM",
                           "13:00:00 AM",
                           "12:00:00x",
                           "2024-03-01-04",
                           "12:00:00 +15:00",
                           "1.2.3",
                           "192.168.0.1",
                           "1.10.2-3",
                           "May",
                           "12:00:00:5",
                           "5 N",
                           "5 minutes long",
                           "5sec",
                           "1e300 sec",
                           "20240301",
                           "20241301T120000",
                           "20240301T126000",
                           "20240301T120",
                           "99999:00:00",
                           "0x10:00:00",
                           "--12:00:00",
                           "-12:00:00 2024-03-01",
                           "-12:00:00Z",
                           "Mai 1, 2024"})
    EXPECT_FALSE(date_time_in(text)) << text;
}

// The differences are exact decimals: one rounding, that of the quotient.
TEST(DateTime, TimesAreCountedInNanoseconds) {
  EXPECT_THAT(seconds("2024-03-01 12:00:00.000000", "2024-03-01 12:00:00.000001"), Optional(1e-6));
  EXPECT_THAT(seconds("2024-01-01 00:00:00", "2024-03-01 00:00:00.000000003"),
              Optional(60 * 86400 + 3e-9));
  EXPECT_THAT(seconds("12:00:00.9999999996", "12:00:01"), Optional(0.0));
  EXPECT_THAT(seconds("2024-02-28 23:59:59.9", "2024-02-29 00:00:00.1"), Optional(0.2));
}

TEST(DateTime, ZonesCount) {
  EXPECT_THAT(seconds("2024-03-31T01:59:59+01:00", "2024-03-31T03:00:00+02:00"), Optional(1.0));
  EXPECT_EQ(seconds("2024-03-31T01:59:59+01:00", "2024-03-31T03:00:00"), std::nullopt);
}

TEST(DateTime, MidnightIsPassed) {
  EXPECT_THAT(seconds("23:59:59.999", "00:00:00.001"), Optional(0.002));
  EXPECT_THAT(seconds("11:59:59.999 PM", "12:00:00.001 AM"), Optional(0.002));
  EXPECT_THAT(seconds("59:59.9", "00:00.1"), Optional(0.2));
  EXPECT_THAT(seconds("23:59:59", "24:00:01"), Optional(2.0));
  EXPECT_THAT(seconds("99:59:59", "100:00:01"), Optional(2.0));
}

TEST(DateTime, DayAndMonthAreToldApartByTheRows) {
  EXPECT_THAT(seconds("01/02/2024 12:00:00", "01/02/2024 12:00:01"), Optional(1.0));
  EXPECT_THAT(seconds("31/01/2024 23:59:59", "01/02/2024 00:00:00"), Optional(1.0));
  EXPECT_THAT(seconds("01/31/2024 23:59:59", "02/01/2024 00:00:00"), Optional(1.0));
  EXPECT_THAT(seconds("01/02/2024 23:59:59", "02/02/2024 00:00:00"), Optional(1.0));
  EXPECT_THAT(seconds("02/01/2024 23:59:59", "02/02/2024 00:00:00"), Optional(1.0));
  EXPECT_THAT(seconds("12/01/2024 23:59:59", "13/01/2024 00:00:00"), Optional(1.0));
  EXPECT_EQ(seconds("01/02/2024 12:00:00", "02/03/2024 12:00:00"), std::nullopt);
  EXPECT_THAT(seconds("24-03-01 12:00:00", "24-03-01 12:00:01"), Optional(1.0));
  EXPECT_EQ(seconds("24-03-01 12:00:00", "24-03-02 12:00:00"), std::nullopt);
}

TEST(DateTime, DurationsCountFromZero) {
  EXPECT_THAT(seconds("0 sec", "1e-05 sec"), Optional(1e-5));
  EXPECT_THAT(seconds("-0.5 sec", "0.1 min"), Optional(6.5));
  EXPECT_THAT(seconds("0.1 hr", "0.2 hr"), Optional(360.0));
  EXPECT_THAT(seconds("0 days 00:00:00.5", "0.75 sec"), Optional(0.25));
  EXPECT_EQ(seconds("00:00:00.5", "0.75 sec"), std::nullopt);
}

TEST(DateTime, WholeSecondsMayCountFrom1970) {
  const auto since_1970 = whole_seconds_in("1709290800");
  ASSERT_TRUE(since_1970);
  EXPECT_EQ(since_1970->iso(), "2024-03-01T11:00:00Z");
  const auto later = whole_seconds_in("1709337601");  // of the next day
  ASSERT_TRUE(later);
  EXPECT_THAT(seconds_between(*since_1970, *later), Optional(46801.0));
  const auto few = whole_seconds_in("12");
  ASSERT_TRUE(few);
  EXPECT_EQ(few->iso(), "");
  for (const char* text : {"", "-1", "1.5", "99999999999"})
    EXPECT_FALSE(whole_seconds_in(text)) << text;
}

TEST(DateTime, OnlyLikeIsCompared) {
  EXPECT_EQ(seconds("2024-03-01 12:00:00", "12:00:01"), std::nullopt);
  EXPECT_EQ(seconds("2024-03-01 12:00:00", "2024-03-01"), std::nullopt);
  EXPECT_EQ(seconds("1000-03-01 12:00:00", "2024-03-01 12:00:00"), std::nullopt);
}

}  // namespace
}  // namespace impactrig::acquisition
