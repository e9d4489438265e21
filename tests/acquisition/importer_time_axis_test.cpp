// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/time_axis.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "acquisition/importers/number.hpp"

namespace impactrig::acquisition {
namespace {

std::vector<double> line(std::size_t n, double start, double step) {
  std::vector<double> times(n);
  for (std::size_t i = 0; i < n; ++i) times[i] = start + step * static_cast<double>(i);
  return times;
}

/// As a program prints them with so many significant digits.
std::vector<double> printed(std::vector<double> times, int digits) {
  for (double& time : times) time = number_in(fmt::format("{:.{}g}", time, digits)).value_or(0.0);
  return times;
}

using testing::HasSubstr;
using testing::Not;

TEST(TimeAxis, OfAStraightLineIsItsStartAndStep) {
  for (const double step : {1e-6, 1.0 / 65536.0, 4e-11, 0.01, 3.0}) {
    const TimeAxis axis = time_axis(line(5000, -0.125, step));
    EXPECT_TRUE(axis.clock.uniform());
    EXPECT_EQ(axis.clock.start, -0.125);
    EXPECT_NEAR(axis.clock.interval, step, 1e-15 * (0.125 / 5000 + step));
    EXPECT_EQ(axis.warning, "");
  }
  EXPECT_EQ(time_axis(line(5000, 0.0, 1e-6)).clock.interval, 1e-6);  // not 9.999999999999998e-07
}

TEST(TimeAxis, WithAJitterOfAThousandthIsUniform) {
  std::vector<double> times = line(101, 0.0, 1e-3);
  times[50] += 0.9e-6;
  EXPECT_TRUE(time_axis(times).clock.uniform());
  times[50] += 0.3e-6;
  EXPECT_FALSE(time_axis(times).clock.uniform());
}

// Seconds since 1970: doubles have 2.4e-7 s between them there, and loggers print microseconds.
TEST(TimeAxis, OfTimesSince1970IsUniformAsFarAsTheyTell) {
  for (const double rate : {1e3, 1e4, 51200.0}) {
    const std::vector<double> exact = line(5000, 1709294400.123456, 1.0 / rate);
    std::vector<double> microseconds;
    for (std::size_t i = 0; i < exact.size(); ++i) {
      const double elapsed = 123456.0 + std::round(1e6 * static_cast<double>(i) / rate);
      const double second = std::floor(elapsed / 1e6);
      microseconds.push_back(
          number_in(fmt::format("{:.0f}.{:06.0f}", 1709294400.0 + second, elapsed - 1e6 * second))
              .value_or(0.0));
    }
    // of few digits, but further ones than those
    const std::vector<double> round = line(5000, 1709294400.0, 1.0 / rate);
    for (const auto& times : {exact, microseconds, round}) {
      const TimeAxis axis = time_axis(times);
      EXPECT_TRUE(axis.clock.uniform()) << rate << ": " << axis.warning;
      // what first and last are rounded by, and four bits for a shorter number
      EXPECT_NEAR(axis.clock.interval, 1.0 / rate, (1e-6 + 4.0 * 3.8e-7) / 4999);
    }
    std::vector<double> lost = exact;
    lost.erase(lost.begin() + 2000, lost.begin() + 2003);
    EXPECT_FALSE(time_axis(lost).clock.uniform());
  }
}

// Steps of a clock that ticks 64 times a second, and of one that shows minutes.
TEST(TimeAxis, OfManyEqualTimesHasTheStepBetweenTheirChanges) {
  for (const double tick : {1.0 / 64.0, 1.0, 60.0}) {
    const double step = tick / 250.0;
    std::vector<double> times = line(900, 0.8 * tick, step);
    for (double& time : times) time = tick * std::floor(time / tick + 1e-9);
    const TimeAxis axis = time_axis(times);
    EXPECT_TRUE(axis.clock.uniform());
    EXPECT_NEAR(axis.clock.interval, step, 1e-12 * step);
    EXPECT_NE(axis.warning.find("several samples share one"), std::string::npos) << axis.warning;
  }
}

TEST(TimeAxis, OfLessThanTwoChangesTellsNoStep) {
  for (const std::size_t n : {2U, 100U, 299U}) {
    std::vector<double> times = line(n, 0.0, 1.0 / 200.0);
    for (double& time : times) time = std::floor(time);
    const TimeAxis axis = time_axis(times);
    EXPECT_TRUE(axis.clock.uniform());
    EXPECT_EQ(axis.clock.interval, 0.0);
    EXPECT_NE(axis.warning.find("do not tell the sample interval"), std::string::npos);
  }
}

TEST(TimeAxis, KeepsTimesThatAreNotUniform) {
  const std::vector<double> times = {0.0, 1.0, 2.5, 3.0, 4.0};
  const TimeAxis axis = time_axis(times);
  EXPECT_EQ(axis.clock.times, times);
  EXPECT_EQ(axis.clock.interval, 1.0);
  EXPECT_EQ(axis.warning,
            "the samples are not evenly spaced (steps differ from their mean of 1 s by up to 0.5 "
            "s): every time is kept");
}

// One time in a hundred would be a multiple of 0.01 s.
TEST(TimeAxis, OfALostStretchOfRoundTimesIsNotUniform) {
  std::vector<double> times;
  for (int i = 0; i < 100101; ++i)
    if (i < 50000 || i >= 50100) times.push_back(1e-4 * i);
  EXPECT_FALSE(time_axis(printed(times, 6)).clock.uniform());
}

TEST(TimeAxis, OfALostSampleIsNotUniform) {
  std::vector<double> times = line(1000, 0.0, 0.001);
  times.erase(times.begin() + 500);
  EXPECT_FALSE(time_axis(times).clock.uniform());
  EXPECT_FALSE(time_axis(printed(times, 6)).clock.uniform());
}

// Two segments one after the other: their times are a digit apart from a line of half the step.
TEST(TimeAxis, OfTimesThatFallIsNotRounded) {
  std::vector<double> times;
  for (int i = 0; i < 40; ++i) times.push_back(-1e-3 + 1e-4 * (i % 20));
  const TimeAxis axis = time_axis(printed(times, 6));
  EXPECT_FALSE(axis.clock.uniform());
  EXPECT_NEAR(axis.clock.interval, 1e-4, 1e-9);
  EXPECT_EQ(axis.warning,
            "time does not increase from sample 19 (0.0009 s) to sample 20 (-0.001 s)");
}

TEST(TimeAxis, SeesThroughRoundedTimes) {
  // 51.2 kHz with six digits: near 1 s the last digit is half a step
  const TimeAxis fine = time_axis(printed(line(51200, 0.0, 1.0 / 51200.0), 7));
  EXPECT_TRUE(fine.clock.uniform());
  EXPECT_EQ(fine.clock.interval, 1.0 / 51200.0);
  EXPECT_EQ(fine.warning,
            "the times are rounded to 1e-07 s: they are taken as uniform, with the interval of "
            "1.953125e-05 s that those of them with finer digits tell");
  // 1 MHz with six digits: ten samples share a time
  const TimeAxis coarse = time_axis(printed(line(200001, 1.0, 1e-6), 6));
  EXPECT_TRUE(coarse.clock.uniform());
  EXPECT_NEAR(coarse.clock.interval, 1e-6, 1e-10);
}

// As a spreadsheet saves them, "1.234E-01": from 0.1 s on the last digit is 0.4 of a step, from 1 s
// on 4 steps: the times before tell it.
TEST(TimeAxis, IsToldBySmallTimesOfAFewDigits) {
  for (const std::size_t count : {2000U, 10000U}) {
    std::vector<double> times = line(count, 0.0, 0.00025);
    const TimeAxis axis = time_axis(printed(times, 4));
    EXPECT_TRUE(axis.clock.uniform()) << count;
    EXPECT_NEAR(axis.clock.interval, 0.00025, 1e-9) << count;
    EXPECT_THAT(axis.warning, HasSubstr("those of them with finer digits tell")) << count;
  }
  for (const int lost : {50, 1500}) {
    std::vector<double> times = line(2001, 0.0, 0.00025);
    times.erase(times.begin() + lost);
    EXPECT_FALSE(time_axis(printed(times, 4)).clock.uniform()) << lost;
  }
}

// "0.347" in steps of a millisecond: the digits are as many everywhere, and one time is missing
TEST(TimeAxis, OfFixedDecimalsShowsALostSample) {
  struct Lost {
    double start, step;
    std::size_t samples;
    std::ptrdiff_t lost;
  };

  for (const Lost& one : {Lost{-1.25, 1e-3, 2501, 1597},
                          {0.0, 1e-3, 100, 95},
                          {-0.05, 1e-3, 1001, 950},
                          {-2.0, 1e-3, 2501, 2100},
                          {-0.125, 1e-5, 25000, 20000},
                          {0.0, 1e-3, 2000, 3}}) {
    std::vector<double> times = line(one.samples, one.start, one.step);
    times.erase(times.begin() + one.lost);
    for (double& time : times) time = std::round(time * 1e5) / 1e5;
    EXPECT_THAT(time_axis(times).warning, Not(HasSubstr("finer digits"))) << one.start;
    EXPECT_FALSE(time_axis(times).clock.uniform()) << one.start << " " << one.lost;
  }
  std::vector<double> doubled = line(100, 0.0, 1e-3);
  for (double& time : doubled) time = std::round(time * 1e3) / 1e3;
  doubled.push_back(doubled.back());
  EXPECT_THAT(time_axis(doubled).warning, Not(HasSubstr("finer digits")));
}

// From half a second before the trigger on: the finest times are in the middle
TEST(TimeAxis, IsToldByTheTimesAboutTheTrigger) {
  const TimeAxis axis = time_axis(printed(line(4001, -0.5, 0.00025), 4));
  EXPECT_TRUE(axis.clock.uniform());
  EXPECT_NEAR(axis.clock.interval, 0.00025, 1e-9);
  std::vector<double> times = line(4001, -0.5, 0.00025);
  times.erase(times.begin() + 3000);
  EXPECT_FALSE(time_axis(printed(times, 4)).clock.uniform());
}

TEST(TimeAxis, DoesNotExplainALostSampleByRounding) {
  EXPECT_FALSE(time_axis({0.000, 0.001, 0.003, 0.004}).clock.uniform());
}

TEST(TimeAxis, SaysWhereTimeGoesBack) {
  const TimeAxis axis = time_axis({0.0, 1.0, 0.5, 3.0});
  EXPECT_FALSE(axis.clock.uniform());
  EXPECT_EQ(axis.warning, "time does not increase from sample 1 (1 s) to sample 2 (0.5 s)");
}

TEST(TimeAxis, OfNanIsNotUniform) {
  std::vector<double> times = line(10, 0.0, 1.0);
  times[4] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(time_axis(times).clock.uniform());
}

TEST(TimeAxis, OfOneSampleHasNoInterval) {
  const TimeAxis axis = time_axis({2.5});
  EXPECT_EQ(axis.clock.start, 2.5);
  EXPECT_EQ(axis.clock.interval, 0.0);
  EXPECT_EQ(axis.warning, "there is one sample only: the sample interval is not known");
  EXPECT_EQ(time_axis({}).clock.interval, 0.0);
}

// Rates of real data acquisition systems, as E13.5 holds their intervals.
TEST(NiceRate, IsWhatSixDigitsStandFor) {
  EXPECT_EQ(nice_rate(1.52588e-05), 65536.0);
  for (const double rate : {131072.0, 262144.0, 102400.0, 44100.0, 48000.0, 96000.0, 65536.0 * 8,
                            3.0e5, 4096.0, 6000.0}) {
    const double interval = number_in(fmt::format("{:.5e}", 1.0 / rate)).value_or(0.0);
    EXPECT_EQ(nice_rate(interval).value_or(std::round(1.0 / interval)), rate);
  }
}

TEST(NiceRate, IsNotOfferedForARoundInterval) {
  for (const double interval : {5e-05, 1e-6, 3.125e-4, 0.01, 1.953125e-05, 1.0, 0.0})
    EXPECT_FALSE(nice_rate(interval).has_value()) << interval;
  EXPECT_FALSE(nice_rate(1.52587890625e-05).has_value());  // all digits are there
}

TEST(Date, IsWrittenBothWays) {
  EXPECT_EQ(iso_date("30-Apr-20 19:12:52"), "2020-04-30T19:12:52");
  EXPECT_EQ(iso_date("08-OCT-94 10:27:07"), "1994-10-08T10:27:07");
  EXPECT_EQ(iso_date("11-Oct-17"), "2017-10-11");
  EXPECT_EQ(uff_date("2020-04-30T19:12:52"), "30-Apr-20 19:12:52");
  EXPECT_EQ(uff_date("2017-10-11"), "11-Oct-17");
}

TEST(Date, StaysAsItIsWhenItIsSomethingElse) {
  for (const char* text : {"", "NONE", "yesterday", "30-Foo-20 19:12:52", "30-Apr-20 19:12",
                           "30-Apr-20 99:12:52", "41-Apr-20", "30-Apr-20 19:12:52 UTC"})
    EXPECT_EQ(iso_date(text), text);
  for (const char* text : {"", "2020-04-30T19:12:52Z", "2120-04-30", "2020-13-01", "April 2020"})
    EXPECT_EQ(uff_date(text), text);
}

// A logger's start, or one line that is written again: all times after it would come a step late.
TEST(TimeAxis, WithOneTimeThatStandsTwiceKeepsAll) {
  for (const std::size_t twice : {0U, 100U, 199U}) {
    std::vector<double> times = line(200, 0.0, 0.5);
    times.insert(times.begin() + static_cast<std::ptrdiff_t>(twice), times[twice]);
    const TimeAxis axis = time_axis(times);
    EXPECT_EQ(axis.clock.times, times);
    EXPECT_THAT(axis.warning, HasSubstr("time does not increase from sample"));
  }
}

// Steps of 40 ns differ by a thousandth and more from 0.25 ms on, of 10 us from 0.1 s on.
TEST(TimeAxis, OfSinglePrecisionIsUniform) {
  for (const double step : {4e-8, 1e-6, 1e-5})
    for (const double per_second : {1.0, 1e3, 1e6})
      for (const int digits : {9, 17}) {
        std::vector<double> times = line(12000, -4000.0 * step, step);
        for (double& time : times) {
          const auto single = static_cast<float>(time * per_second);
          time = number_in(fmt::format("{:.{}g}", single, digits)).value_or(0.0) / per_second;
        }
        const TimeAxis axis = time_axis(times);
        EXPECT_TRUE(axis.clock.uniform()) << step << ' ' << per_second << ' ' << digits;
        EXPECT_NEAR(axis.clock.interval / step, 1.0, 1e-7);
      }
  // as large a jitter is no rounding of double precision
  std::vector<double> times = line(12000, 0.0, 4e-8);
  for (std::size_t i = 0; i < times.size(); i += 7) times[i] += 1e-10 * std::sin(double(i));
  EXPECT_FALSE(time_axis(times).clock.uniform());
}

// Of the same instants, printed in ms or in us: what is read differs by the last bit.
TEST(TimeAxis, RoundedTimesAreEvenInAnyUnit) {
  for (const double rate : {3000.0, 8192.0, 44100.0, 51200.0, 96000.0})
    for (const double unit : {1.0, 1e3, 1e6}) {
      std::vector<double> times;
      for (int i = 0; i < 2000; ++i) {
        const double printed = std::round(1e7 * i / rate);  // in 0.1 us
        times.push_back(printed / (1e7 / unit) / unit);
      }
      const TimeAxis axis = time_axis(times);
      EXPECT_TRUE(axis.clock.uniform()) << rate << " " << unit;
      EXPECT_NEAR(axis.clock.interval * rate, 1.0, 1e-4);
    }
}

}  // namespace
}  // namespace impactrig::acquisition
