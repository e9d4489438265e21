// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "acquisition/importer.hpp"
#include "acquisition/importers/clock_words.hpp"
#include "datasets/input_error.hpp"
#include "tests/acquisition/mat_byte_order.hpp"
#include "tests/acquisition/mat_bytes.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using tests::imported;
using tests::Mat;
using tests::MatBytes;

std::vector<double> counted(int count, double step) {
  std::vector<double> values;
  for (int i = 0; i < count; ++i) values.push_back(step * i);
  return values;
}

TEST_P(Mat, TimesByNameOfTheOwnGroupFirst) {
  const std::string fields = b.doubles("", {0, 1, 2}) + b.doubles("", {4, 5, 6});
  const auto record =
      imported(b.header() + b.doubles("time", {0, 0.5, 1}) + b.doubles("force", {1, 2, 3}) +
               b.structure("run", {"t", "a"}, fields) + b.doubles("other", {1, 2}) +
               b.doubles("dt", {0.125}));
  EXPECT_EQ(record.find("force")->clock.interval, 0.5);
  EXPECT_EQ(record.find("run.a")->clock.interval, 1.0);
  EXPECT_EQ(record.find("other")->clock.interval, 0.125);
  EXPECT_EQ(record.attributes.at("time column"),
            "time (by its name); run.t (by its name); dt (an interval of 0.125 s by its name)");
}

TEST_P(Mat, TimesOfOneArrayCountBeforeThoseOfAll) {
  const std::vector<double> slow = {-1, 1, 3}, fast = {0, 0.25, 0.5};
  const auto record = imported(b.header() + b.doubles("t", fast) + b.doubles("force", {1, 2, 3}) +
                               b.doubles("t_acc", slow) + b.doubles("acc", {4, 5, 6}) +
                               b.doubles("time2", slow) + b.doubles("force2", {7, 8, 7}) +
                               b.doubles("t_3", slow) + b.doubles("v_3", {1, 0, 1}));
  EXPECT_EQ(record.find("force")->clock.interval, 0.25);
  for (const char* name : {"acc", "t_acc", "force2", "time2", "v_3", "t_3"}) {
    EXPECT_EQ(record.find(name)->clock.start, -1.0) << name;
    EXPECT_EQ(record.find(name)->clock.interval, 2.0) << name;
  }
}

TEST_P(Mat, TimesOfAnotherLengthBesideARateAreToldOf) {
  const auto record = imported(b.header() + b.doubles("t", {-1, -0.5, 0, 0.5}) +
                               b.doubles("force", {1, 2, 3}) + b.doubles("fs", {5}));
  EXPECT_EQ(record.find("force")->clock.interval, 0.2);
  EXPECT_THAT(record.warnings,
              Contains("'t' has 4 numbers and 'force' 3 samples, so they are not taken as its "
                       "times: 'fs' tells the interval"));
  EXPECT_EQ(record.attributes.at("time column"), "fs (an interval of 0.2 s by its name)");
}

TEST_P(Mat, UnitsMayBeWrittenInTheCamelsWay) {
  const auto record =
      imported(b.header() + b.doubles("time", {0, 0.5, 1}) + b.text("TimeUnit", "ms") +
               b.doubles("force", {1, 2, 3}) + b.text("ForceUnit", "kN"));
  EXPECT_EQ(record.find("force")->clock.interval, 0.5e-3);
  EXPECT_EQ(record.find("force")->unit, "kN");
  EXPECT_THAT(record.warnings, ElementsAre());
  const auto two = imported(b.header() + b.doubles("f", {1, 2}) + b.doubles("F", {1, 2}) +
                            b.text("F_unit", "kN") + b.doubles("dt", {1}));
  EXPECT_EQ(two.channels[0].unit, "");
  EXPECT_EQ(two.channels[1].unit, "kN");
}

TEST_P(Mat, TimesMayStandAroundAStructure) {
  const auto record = imported(b.header() +
                               b.structure("run", {"t", "laser"},
                                           b.doubles("", {0, 0.25, 0.5}) +
                                               b.structure("", {"v"}, b.doubles("", {7, 8, 6}))) +
                               b.doubles("t", {0, 1, 2}));
  EXPECT_EQ(record.find("run.laser.v")->clock.interval, 0.25);
}

// Times of one array each: the velocity has half the rate, and the number at the top is of others.
TEST_P(Mat, TimesMayBeOfOneArrayByItsName) {
  for (const auto& [force, velocity] :
       {std::pair{"t_Force", "t_Vel"}, std::pair{"Force_time", "Vel_time"}}) {
    const auto record = imported(b.header() + b.doubles("Sample_rate", {4.0}) +
                                 b.doubles(force, {-0.5, 0, 0.5}) + b.doubles("Force", {1, 2, 3}) +
                                 b.doubles(velocity, {-0.5, 0.5}) + b.doubles("Vel", {4, 5}));
    EXPECT_EQ(record.find("Force")->clock.interval, 0.5) << force;
    EXPECT_EQ(record.find("Force")->clock.start, -0.5);
    EXPECT_EQ(record.find("Vel")->clock.interval, 1.0);
    EXPECT_EQ(record.find(velocity)->clock.interval, 1.0);
  }
  // a velocity beside the times of all
  const auto derived = imported(b.header() + b.doubles("t", {0, 0.25, 0.5}) +
                                b.doubles("x", {1, 2, 4}) + b.doubles("x_t", {4, 8, 16}));
  EXPECT_EQ(derived.find("x")->clock.interval, 0.25);
  EXPECT_THAT(derived.warnings, testing::Each(testing::Not(HasSubstr("x_t"))));
  const auto simulink =
      imported(b.header() + b.doubles("tout", {0, 0.25, 0.5}) + b.doubles("yout", {1, 2, 3}));
  EXPECT_EQ(simulink.find("yout")->clock.interval, 0.25);
}

// Positions and settings were a reason to refuse the recording beside them.
TEST_P(Mat, SmallListsBesideTimesAreLeftOut) {
  const tests::WrittenFile file(b.header() + b.doubles("t", counted(40, 0.5)) +
                                b.doubles("F", counted(40, 1.0)) +
                                b.doubles("positions", {0.1, 0.69, 0.8}));
  const auto reader = open_recording(file.path());
  const auto record = read_into_memory(*reader, {});
  EXPECT_EQ(record.channels.size(), 2U);
  EXPECT_EQ(record.channels.at(1).clock.interval, 0.5);
  EXPECT_THAT(record.warnings,
              Contains(HasSubstr("'positions' has no clock and few numbers: left out")));
  EXPECT_EQ(read_into_memory(*reader, {.channels = {1}}).channels.at(0).values().back(), 39.0);
  ImportOptions inspected;
  inspected.require_clock = false;
  EXPECT_EQ(open_recording(file.path(), inspected)->head().record.channels.size(), 3U);
  ImportOptions asked;
  asked.channels = {"positions"};
  EXPECT_THROW(read_into_memory(*open_recording(file.path(), asked), {.channels = {2}}),
               datasets::InputError);
}

// One number in the file made any window hold something.
TEST_P(Mat, AWindowBeyondTheSamplesIsRefusedBesideANumber) {
  const tests::WrittenFile file(b.header() + b.doubles("Fs", {2.0}) +
                                b.doubles("F", counted(40, 1.0)));
  const auto reader = open_recording(file.path());
  EXPECT_THROW(read_into_memory(*reader, {.channels = {}, .from = 500.0}), datasets::InputError);
  EXPECT_EQ(read_into_memory(*reader, {.channels = {}, .from = 5.0, .to = 6.0}).find("F")->size(),
            3U);
}

TEST_P(Mat, TimesOfDaysAreAskedFor) {
  ImportOptions options;
  options.require_clock = false;
  const std::string force = b.doubles("F", counted(100, 1.0));
  for (const double day : {45365.43, 738000.5}) {
    std::vector<double> times = counted(100, 1.0 / 86400.0 / 51200.0);
    for (double& time : times) time += day;
    EXPECT_THAT(imported(b.header() + b.doubles("time", times) + force, options).warnings,
                Contains(HasSubstr("which may be days (--units states its unit)")));
    std::vector<double> seconds = counted(100, 1e-5);
    for (double& time : seconds) time += day;
    EXPECT_NEAR(
        imported(b.header() + b.doubles("time", seconds) + force).channels.at(1).clock.interval,
        1e-5, 1e-11);
  }
}

TEST_P(Mat, TimesThatHoldNoNumberAreSaidTo) {
  ImportOptions options;
  options.require_clock = false;
  EXPECT_THAT(
      imported(b.header() + b.doubles("t", {0, 1, NAN}) + b.doubles("F", {1, 2, 3}), options)
          .warnings,
      Contains(HasSubstr("the file states 't', which holds numbers that are not finite")));
}

TEST_P(Mat, ElementsOfCellArraysHaveNoUnitOfTheirIndex) {
  EXPECT_EQ(unit_by_name("data{1}"), "");
  EXPECT_EQ(unit_by_name("data{2}"), "");
  EXPECT_EQ(unit_by_name("force{N}"), "N");
}

// Of few rows: the times beside them tell which way they go.
TEST_P(Mat, AMatrixOfFewRowsHasColumnsBesideTimes) {
  const auto record = imported(b.header() + b.doubles("time", {0, 1, 2}) +
                               b.doubles("force", {1, 2, 3, 4, 5, 6}, 2));
  EXPECT_EQ(record.find("force:1")->values(), (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(record.find("force:2")->clock.interval, 1.0);
  EXPECT_EQ(imported(b.header() + b.doubles("time", {0, 1, 2}) +
                     b.doubles("R", {1, 0, 0, 0, 1, 0, 0, 0, 1}, 3))
                .channels.size(),
            2U);
}

TEST_P(Mat, IntervalsAndRatesMayEndInTheirUnit) {
  const std::string force = b.doubles("force", {1, 2, 3});
  for (const auto& [name, value] : {std::pair{"dt_ms", 0.5}, std::pair{"fs_Hz", 2000.0},
                                    std::pair{"sample_rate_khz", 2.0}, std::pair{"Ts_us", 500.0}})
    EXPECT_DOUBLE_EQ(
        imported(b.header() + force + b.doubles(name, {value})).channels.at(0).clock.interval, 5e-4)
        << name;
  EXPECT_EQ(imported(b.header() + force + b.doubles("dt_N", {2})).channels.at(0).clock.interval, 0);
}

TEST_P(Mat, AStartMayStandBesideAnIntervalOrARate) {
  const auto run = [this](const std::string& name, double start, const std::string& unit) {
    std::string fields = b.doubles("", {1, 2, 3}) + b.doubles("", {0.5}) + b.doubles("", {start});
    if (!unit.empty()) fields += b.text("", unit);
    std::vector<std::string> names = {"data", "dt", name};
    if (!unit.empty()) names.emplace_back("dt_unit");
    return b.structure("force", names, fields);
  };
  for (const char* name : {"t0", "t_start", "Tstart", "start_time"})
    EXPECT_EQ(imported(b.header() + run(name, -0.25, "")).find("force.data")->clock.start, -0.25)
        << name;
  const auto infiniium =
      imported(b.header() + b.structure("CH1", {"data", "XInc", "XOrg"},
                                        b.doubles("", {1, 2, 3}) + b.doubles("", {1e-6}) +
                                            b.doubles("", {-2e-4})));
  EXPECT_EQ(infiniium.find("CH1.data")->clock.interval, 1e-6);
  EXPECT_EQ(infiniium.find("CH1.data")->clock.start, -2e-4);
  const auto in_ms = imported(b.header() + run("t0", -10.0, "ms"));
  EXPECT_DOUBLE_EQ(in_ms.find("force.data")->clock.start, -10e-3);
  EXPECT_DOUBLE_EQ(in_ms.find("force.data")->clock.interval, 0.5e-3);
  const auto at_the_top = imported(b.header() + b.doubles("force", {1, 2, 3}) +
                                   b.doubles("fs", {1000}) + b.doubles("t0_ms", {-4}));
  EXPECT_DOUBLE_EQ(at_the_top.find("force")->clock.start, -4e-3);
  for (const double date : {1.7e9, 739312.5, 45352.5})
    EXPECT_EQ(imported(b.header() + run("start_time", date, "")).find("force.data")->clock.start, 0)
        << date;
}

TEST_P(Mat, TimesMayHaveTheirUnitInATextBesideThem) {
  for (const char* name : {"t_unit", "t_units", "time_unit"}) {
    const auto record = imported(b.header() + b.doubles("t", {0, 0.5, 1}) + b.text(name, "ms") +
                                 b.doubles("force", {1, 2, 3}) + b.text("force_unit", "kN"));
    EXPECT_DOUBLE_EQ(record.find("force")->clock.interval, 0.5e-3) << name;
    EXPECT_EQ(record.find("force")->unit, "kN");
    EXPECT_THAT(record.warnings, testing::IsEmpty());
  }
}

TEST_P(Mat, TimesMayCountFrom1970) {
  const auto record = imported(
      b.header() + b.doubles("timestamp", {1.7092944e12, 1.7092944e12 + 2, 1.7092944e12 + 4}) +
      b.doubles("force", {1, 2, 3}));
  EXPECT_NEAR(record.find("force")->clock.interval, 2e-3, 1e-9);
  EXPECT_THAT(
      record.warnings,
      Contains(HasSubstr("'timestamp' states no unit; by their size its numbers count ms")));
}

TEST_P(Mat, UnevenTimesAreKept) {
  const std::string bytes =
      b.header() + b.doubles("t", {0, 1, 3}) + b.doubles("force", {1, 2, 3}) + b.doubles("Fs", {4});
  const auto record = imported(bytes);
  EXPECT_THAT(record.channels[1].clock.times, ElementsAre(0, 1, 3));
  EXPECT_THAT(record.warnings, Contains(HasSubstr("'t': the samples are not evenly spaced")));
  ImportOptions options;
  options.time_column = "none";
  EXPECT_EQ(imported(bytes, options).channels[1].clock.interval, 0.25);
  const auto back = imported(b.header() + b.doubles("t", {0, 2, 1}) + b.doubles("x", {1, 2, 3}));
  EXPECT_EQ(back.channels[1].clock.interval, 0.0);
  EXPECT_EQ(back.warnings[0], "'t' does not increase throughout: it is not taken as the time");
}

TEST_P(Mat, ClocksThatContradictEachOtherAreNamed) {
  const std::string force = b.doubles("force", {1, 2, 3});
  const auto numbers =
      imported(b.header() + force + b.doubles("Fs", {1000}) + b.doubles("dt", {0.5}));
  EXPECT_EQ(numbers.find("force")->clock.interval, 1e-3);
  EXPECT_THAT(numbers.warnings,
              Contains("'Fs' says that samples are 0.001 s apart, 'dt' 0.5 s: 'Fs' is used"));
  const auto times =
      imported(b.header() + b.doubles("t", {0, 0.5, 1}) + force + b.doubles("Fs", {3}));
  EXPECT_EQ(times.find("force")->clock.interval, 0.5);
  EXPECT_THAT(
      times.warnings,
      Contains("'t' steps by 0.5 s, but 'Fs' says that samples are 0.333333333 s apart: 't' "
               "is used (--time-column none takes 'Fs')"));
  const auto in_ms =
      imported(b.header() + b.doubles("t", {0, 0.5, 1}) + force + b.doubles("Fs", {2000}));
  EXPECT_THAT(in_ms.warnings,
              Contains("'t' steps by 0.5 s, but 'Fs' says that samples are 0.0005 s apart, as if "
                       "the times were in ms: 't' is used (--time-column none takes 'Fs')"));
  for (const auto& warning : imported(b.header() + b.doubles("t", {0, 0.5, 1}) + force +
                                      b.doubles("Fs", {2.0}) + b.doubles("dt", {0.5}))
                                 .warnings)
    EXPECT_THAT(warning, testing::Not(HasSubstr("apart")));
}

TEST_P(Mat, TwoArraysThatClaimToBeTheTimeAreNamed) {
  const std::string force = b.doubles("force", {1, 2, 3});
  const std::string t = b.doubles("t", {0, 0.25, 0.5});
  const auto record = imported(b.header() + t + force + b.doubles("time", {0, 0.5, 1}));
  EXPECT_EQ(record.find("force")->clock.interval, 0.25);
  EXPECT_THAT(
      record.warnings,
      ElementsAre("both 't' and 'time' claim to be the time of 3 samples: 't' is used, from 0 s in "
                  "steps of 0.25 s; 'time' goes from 0 s in steps of 0.5 s (--time-column states "
                  "one)",
                  "the time is taken as s, since no unit is stated: t (by its name)"));
  ImportOptions options;
  options.time_column = "time";
  const auto stated = imported(b.header() + t + force + b.doubles("time", {0, 0.5, 1}), options);
  EXPECT_EQ(stated.find("force")->clock.interval, 0.5);
  EXPECT_THAT(stated.warnings, testing::Not(Contains(HasSubstr("claim"))));
  // the same times, in another unit, say the same; what goes back is no time; another start is one
  for (const std::string& other :
       {b.doubles("time_ms", {0, 250, 500}), b.doubles("time", {0, 1, 0})})
    EXPECT_THAT(imported(b.header() + t + force + other).warnings,
                testing::Not(Contains(HasSubstr("claim"))));
  EXPECT_THAT(imported(b.header() + t + force + b.doubles("time", {1, 1.25, 1.5})).warnings,
              Contains(HasSubstr("'time' goes from 1 s in steps of 0.25 s")));
  EXPECT_EQ(imported(b.header() + b.doubles("t", {0, 1, 0}) + force + b.doubles("time", {0, 3, 6}))
                .find("force")
                ->clock.interval,
            3.0);
}

// What many scripts save: [t, force, velocity].
TEST_P(Mat, AFirstColumnThatIncreasesEvenlyIsTheTime) {
  const auto matrix = [this](double step) {
    std::vector<double> values;
    for (int i = 0; i < 120; ++i) values.push_back(0.25 + step * i);
    for (int i = 0; i < 240; ++i) values.push_back(i % 7);
    return b.header() + b.doubles("data", values, 3);
  };
  const auto record = imported(matrix(1e-3));
  ASSERT_EQ(record.channels.size(), 3U);
  for (const auto& channel : record.channels) {
    EXPECT_EQ(channel.clock.start, 0.25);
    EXPECT_EQ(channel.clock.interval, 1e-3);
  }
  EXPECT_EQ(record.attributes.at("time column"),
            "data:1 (the first column, since it increases evenly)");
  EXPECT_THAT(record.warnings, Contains(HasSubstr("taken as s, since no unit is stated: data:1")));
  EXPECT_EQ(imported(matrix(1.0)).channels[1].clock.interval, 0.0);  // counts samples
  EXPECT_EQ(imported(matrix(-1.0)).channels[1].clock.interval, 0.0);
  ImportOptions options;
  options.time_column = "none";
  EXPECT_EQ(imported(matrix(1e-3), options).channels[1].clock.interval, 0.0);
}

TEST_P(Mat, ManyTimesAreJudgedAllOfThem) {
  const MatBytes mat{GetParam()};
  std::vector<double> times(100000);
  std::vector<double> force(times.size());
  for (std::size_t i = 0; i < times.size(); ++i) times[i] = 1e-3 * static_cast<double>(i);
  const auto read = [&] {
    return imported(mat.header() + mat.doubles("t", times) + mat.doubles("force", force), {},
                    ".mat");
  };
  EXPECT_NEAR(read().channels[1].clock.interval, 1e-3, 1e-18);
  EXPECT_TRUE(read().channels[1].clock.uniform());
  times[70000] += 4e-4;
  const auto uneven = read();
  ASSERT_EQ(uneven.channels[1].clock.times.size(), times.size());
  EXPECT_EQ(uneven.channels[1].clock.times[70000], times[70000]);
  times[65536] = times[65535];  // where one piece ends and the next begins
  EXPECT_THAT(read().warnings,
              Contains("'t' does not increase throughout: it is not taken as the time"));
}

// They asked for a rate.
TEST_P(Mat, ARateMayStandBesideTheStructureOfTheData) {
  const std::string rate = b.doubles("", {1000.0}), data = b.doubles("data", {1, 2, 3, 4, 5});
  const std::string meta = b.structure("meta", {"fs"}, rate);
  EXPECT_DOUBLE_EQ(imported(b.header() + meta + data).find("data")->clock.interval, 1e-3);
  const std::string other = b.structure("info", {"fs"}, b.doubles("", {2000.0}));
  EXPECT_EQ(imported(b.header() + meta + other + data).find("data")->clock.interval, 0.0)
      << "which of them?";
  const std::string run = b.structure("run", {"fs", "force"}, rate + b.doubles("", {1, 2, 3}));
  EXPECT_EQ(imported(b.header() + run + data).find("data")->clock.interval, 0.0) << "the run's";
  EXPECT_DOUBLE_EQ(imported(b.header() + b.doubles("sampleRateHz", {1000.0}) + data)
                       .find("data")
                       ->clock.interval,
                   1e-3);
  const datasets::Record by_text = imported(b.header() + b.text("SamplingRate", "1000") + data);
  EXPECT_DOUBLE_EQ(by_text.find("data")->clock.interval, 1e-3);
  EXPECT_EQ(by_text.attributes.at("time column"),
            "SamplingRate (an interval of 0.001 s by its text)");
}

TEST_P(Mat, TimesMayBeCalledInOtherWords) {
  for (const char* name : {"time_rel_ms", "t_in_ms", "timeMs", "milliseconds"})
    EXPECT_DOUBLE_EQ(
        imported(b.header() + b.doubles(name, {-1, 0, 1, 2}) + b.doubles("force", {1, 2, 3, 4}))
            .find("force")
            ->clock.interval,
        1e-3)
        << name;
}

TEST_P(Mat, ListsOfNamesAndUnitsMayBeCalledInOtherWords) {
  const auto cells = [this](const std::string& name, const std::string& one,
                            const std::string& other) {
    return b.matrix(b.head(1, {1, 2}, name) + b.text("", one) + b.text("", other));
  };
  std::vector<double> samples(200);
  std::iota(samples.begin(), samples.end(), 0.0);
  for (const auto& [names, units] :
       {std::pair{"channelNames", "channelUnits"}, std::pair{"chan_names", "chan_units"},
        std::pair{"ChNames", "EngUnits"}}) {
    const datasets::Record record = imported(b.header() + b.doubles("data", samples, 2) +
                                             cells(names, "Force", "Acc") + cells(units, "N", "g"));
    ASSERT_EQ(record.channels.size(), 2U);
    EXPECT_EQ(record.channels[0].name, "data.Force") << names;
    EXPECT_EQ(record.channels[1].unit, "g") << units;
  }
}

}  // namespace
}  // namespace impactrig::acquisition
