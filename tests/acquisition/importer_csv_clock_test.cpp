// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <limits>
#include <string>

#include "acquisition/importer.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Record;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using tests::import_error;
using tests::imported;
using tests::names_and_units;

TEST(Csv, AUnitOfARateMayStandInACellOfItsOwn) {
  for (const char* head : {"Sample Interval,2.0e-6,s", "Sample Rate,0.5,MHz",
                           "Sample Rate,500,kHz,", "Rate,500000,Hz"})
    EXPECT_DOUBLE_EQ(
        imported(std::string(head) + "\nForce [N],Velocity [m/s]\n0.5,1\n0.6,2\n0.7,3\n")
            .channels.at(0)
            .clock.interval,
        2e-6)
        << head;
}

TEST(Csv, ARateIsOneOfSamplesByItsUnit) {
  const auto interval = [](const char* head) {
    return imported(std::string(head) + "F [N]\n0.5\n0.6\n0.7\n").channels.at(0).clock.interval;
  };
  EXPECT_DOUBLE_EQ(interval("Rate,500,kHz\n"), 2e-6);
  EXPECT_DOUBLE_EQ(interval("Rate: 500 kS/s\n"), 2e-6);
  EXPECT_DOUBLE_EQ(interval("Rate [kHz]: 500\n"), 2e-6);
  EXPECT_DOUBLE_EQ(interval("Sample Rate,1000\nRate,115200,baud\n"), 1e-3);
  EXPECT_DOUBLE_EQ(interval("Sample Rate,1000\nRate,50,Hz\n"), 1e-3);
}

TEST(Csv, KeysAboveOneColumnMayEndAtAComma) {
  const Record record =
      imported("Sample Rate (Hz),100000\nPretrigger samples,3\nForce (N)\n0.5\n0.6\n0.7\n");
  ASSERT_THAT(names_and_units(record), ElementsAre("Force [N]"));
  EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 1e-5);
  EXPECT_DOUBLE_EQ(record.channels[0].clock.start, -3e-5);
  EXPECT_THAT(record.warnings, IsEmpty());
}

TEST(Csv, APretriggerIsCountedOrTimed) {
  const auto start = [](const char* key) {
    return imported(std::string("dt,1e-5\n") + key + "\nF [N],v [m/s]\n1,2\n3,4\n")
        .channels.at(0)
        .clock.start;
  };
  EXPECT_DOUBLE_EQ(start("Pre-trigger samples,50"), -5e-4);
  EXPECT_DOUBLE_EQ(start("Pre-trigger (ms),0.5"), -5e-4);
  EXPECT_DOUBLE_EQ(start("Pretrigger,500 us"), -5e-4);
  EXPECT_DOUBLE_EQ(start("Pretrigger,10"), 0.0);  // samples, percent, milliseconds?
  EXPECT_DOUBLE_EQ(start("Pretrigger,10 %"), 0.0);
}

TEST(Csv, AnIntervalHasTheUnitOfTheTimesWhereItHasNone) {
  const auto interval = [](const char* head) {
    return imported(std::string(head) + "\nF [N],v [m/s]\n1.5,2\n3,4\n")
        .channels.at(0)
        .clock.interval;
  };
  EXPECT_DOUBLE_EQ(interval("Sampling Interval,0.01\nHorizontal Units,ms"), 1e-5);
  EXPECT_DOUBLE_EQ(interval("Sampling Interval,0.01 s\nHorizontal Units,ms"), 1e-2);
  EXPECT_DOUBLE_EQ(interval("Sampling Interval,0.01\nHorizontal Units,V"), 1e-2);
  EXPECT_DOUBLE_EQ(interval("Sampling rate,100k"), 1e-5);
  EXPECT_DOUBLE_EQ(interval("Samples per second,50000"), 2e-5);
}

TEST(Csv, HanteksClockIsTheInterval) {
  const Record record =
      imported("#CHANNEL:CH1\n#CLOCK=10.0uS\n#SIZE=3\n#UNITS:V\n\n0.5\n0.6\n0.7\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("CH1 [V]"));
  EXPECT_DOUBLE_EQ(record.channels.at(0).clock.interval, 1e-5);
}

TEST(Csv, AKeyMayStateTheUnitOfAColumn) {
  for (const char* head :
       {"# time unit: ms\n# Force unit: kN\n", "Time unit,ms\nUnit of force,kN\n",
        "# units: ms, kN\n", "units,ms,kN\n"}) {
    const Record record = imported(std::string(head) + "Time,Force\n0,1\n0.1,2\n0.2,3\n");
    EXPECT_THAT(names_and_units(record), ElementsAre("Force [kN]")) << head;
    EXPECT_NEAR(record.channels.at(0).clock.interval, 1e-4, 1e-15) << head;
    EXPECT_THAT(record.warnings, IsEmpty()) << head;
  }
}

TEST(Csv, FindsTheTimeByNameThenByUnitThenByGrowth) {
  EXPECT_EQ(imported("F,Time\n1,0.5\n2,1\n3,1.5\n").attributes.at("time column"),
            "Time (by its name)");
  EXPECT_EQ(imported("F [N],clock [ms]\n1,0.5\n2,1\n3,1.5\n").attributes.at("time column"),
            "clock (by its unit)");
  EXPECT_EQ(imported("X,F\n1.5,0.5\n2,1\n3,1.5\n").attributes.at("time column"),
            "X (the first column, since it increases throughout)");
  EXPECT_EQ(imported("displacement,F\n1.5,0.5\n2,1\n3,1.5\n").attributes.at("time column"), "none");
  EXPECT_EQ(imported("F [N],G [N]\n1.5,0.5\n2,1\n3,1.5\n").attributes.at("time column"), "none");
}

TEST(Csv, TheUserMayNameTheTimeColumn) {
  ImportOptions options;
  for (const char* wanted : {"B", "b", "1"}) {
    options.time_column = wanted;
    const Record record = imported("A,B\n5,0.5\n4,1\n3,1.5\n", options);
    EXPECT_THAT(names_and_units(record), ElementsAre("A []"));
    EXPECT_EQ(record.channels[0].clock.interval, 0.5);
  }
  options.time_column = "none";
  options.sample_rate = 100.0;
  const Record record = imported("time,B\n5,0.5\n6,1\n7,1.5\n", options);
  EXPECT_EQ(record.channels.size(), 2U);
  EXPECT_EQ(record.channels[0].clock.interval, 0.01);
  options.time_column = "zeit";
  EXPECT_EQ(import_error("A,B\n5,0.5\n4,1\n", options),
            "FILE: there is no column 'zeit' for the time; the columns are 'A', 'B'");
}

TEST(Csv, AStatedRateReplacesTheInterval) {
  ImportOptions options;
  options.sample_rate = 1000.0;
  const Record record = imported("time [s],F [N]\n0.5,1\n1,2\n1.5,3\n", options);
  EXPECT_EQ(record.channels[0].clock.start, 0.5);
  EXPECT_EQ(record.channels[0].clock.interval, 1e-3);
  EXPECT_EQ(record.channels[0].attributes.at("sample interval in file"), "0.5 s");
  options.sample_rate = 0.0;
  EXPECT_EQ(import_error("1\n2\n", options),
            "FILE: the stated sample rate of 0 Hz is not a number greater than zero");
  options.sample_rate = std::numeric_limits<double>::infinity();
  EXPECT_EQ(import_error("1\n2\n", options),
            "FILE: the stated sample rate of inf Hz is not a number greater than zero");
}

TEST(Csv, WithoutTimesOrRateIsAnErrorThatNamesTheOption) {
  EXPECT_EQ(import_error("F [N]\n1\n2\n"),
            "FILE: 'F' has neither times nor a sample rate: state it with --sample-rate, or the "
            "column with --time-column");
  const Record record = imported("F [N]\n1\n2\n");  // does not insist
  EXPECT_EQ(record.channels[0].clock.interval, 0.0);
  EXPECT_THAT(
      record.warnings,
      ElementsAre("'F' has neither times nor a sample rate: state it with --sample-rate, or the "
                  "column with --time-column"));
}

TEST(Csv, NamesAllChannelsWithoutTimesOrRate) {
  const std::string rest =
      " have neither times nor a sample rate: state it with --sample-rate, or "
      "the column with --time-column";
  const std::string two = "F [N],v [m/s]\n1,5\n2,3\n";
  EXPECT_EQ(import_error(two), "FILE: 'F', 'v'" + rest);
  EXPECT_THAT(imported(two).warnings, ElementsAre("'F', 'v'" + rest));
  std::string heads, row;
  for (int i = 0; i < 12; ++i) {
    heads += fmt::format("{}c{} [V]", i > 0 ? "," : "", i);
    row += fmt::format("{}{}", i > 0 ? "," : "", 7 - i);
  }
  EXPECT_THAT(
      imported(heads + "\n" + row + "\n" + row + "\n").warnings,
      ElementsAre("'c0', 'c1', 'c2', 'c3', 'c4', 'c5', 'c6', 'c7', 'c8', 'c9' and 2 more" + rest));
}

TEST(Csv, ATimeMayHaveItsUnitInManySpellings) {
  for (const char* head : {"Time (msec.)", "Time (millisec.)", "TIME_MS", "Time ms", "Time{ms}",
                           "Time (mS)", "Time (MSEC)", "Zeit (mS)", "Time / MSEC"}) {
    const Record record = imported(std::string(head) + ",F (N)\n0.0,1\n0.1,2\n0.2,3\n");
    EXPECT_DOUBLE_EQ(record.channels.at(0).clock.interval, 1e-4) << head;
    EXPECT_THAT(record.warnings, IsEmpty()) << head;
  }
  // siemens
  EXPECT_THAT(names_and_units(imported("Time (ms),G (mS)\n0.0,1\n0.1,2\n0.2,3\n")),
              ElementsAre("G [mS]"));
}

TEST(Csv, UnitsMayStandAlone) {
  const Record record = imported("[ms],CH1[V],[N]\n0.0,1,2\n0.1,2,3\n0.2,3,4\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("CH1 [V]", "column 2 [N]"));
  EXPECT_DOUBLE_EQ(record.channels.at(0).clock.interval, 1e-4);
  EXPECT_DOUBLE_EQ(imported("(ms)\t(kN)\n0.0\t1\n0.1\t2\n0.2\t3\n").channels.at(0).clock.interval,
                   1e-4);
}

// Words that name the lines of the head stand over a column without values.
TEST(Csv, WordsMayStandBesideTheHead) {
  ImportOptions rate;
  rate.sample_rate = 1000.0;
  for (const char* figures : {"", "Min,-2,0\nMax,80,3\n"}) {
    const Record record = imported(
        std::string("Channel,Force,Vel\nUnit,kN,mm/s\n") + figures + ",-50.5,1\n,-49,2\n,-47.5,3\n",
        rate);
    const auto force = std::ranges::find(record.channels, "Force", &datasets::Channel::name);
    ASSERT_NE(force, record.channels.end()) << figures;
    EXPECT_EQ(force->unit, "kN");
    EXPECT_THAT(force->values(), ElementsAre(-50.5, -49.0, -47.5));
    EXPECT_EQ(record.channels.back().unit, "mm/s");
  }
}

TEST(Csv, UnitsMayStandBesideTheirNames) {
  const Record record = imported("\"Time\",\"ms\",\"Force\",\"kN\"\n0.0,1\n0.1,2\n0.2,3\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("Force [kN]"));
  EXPECT_DOUBLE_EQ(record.channels.at(0).clock.interval, 1e-4);
  EXPECT_THAT(record.warnings, IsEmpty());
}

TEST(Csv, FiguresMayStandBetweenNamesAndRows) {
  for (const char* between : {"Min,-2,0\nMax,80,3\n", "Max:,80,\n", "Sensitivity,1.5,2\n"}) {
    const Record record = imported(std::string("Time (ms),Force (kN),Vel (mm/s)\n") + between +
                                   "0.0,1,2\n0.1,2,3\n0.2,3,4\n");
    EXPECT_THAT(names_and_units(record), ElementsAre("Force [kN]", "Vel [mm/s]")) << between;
    EXPECT_DOUBLE_EQ(record.channels.at(0).clock.interval, 1e-4) << between;
    EXPECT_THAT(record.warnings.at(0), HasSubstr("holds figures of the columns: it is not used"))
        << between;
  }
}

// Cells of dates that a spreadsheet wrote as numbers, and MATLAB's.
TEST(Csv, TimesThatMayBeDaysAreNotTakenForSeconds) {
  for (const char* first : {"45352.5", "739312.5"})
    EXPECT_THAT(import_error(fmt::format("Timestamp,Force (N)\n{0}000000,0\n{0}000116,1\n", first)),
                HasSubstr("which may be a date in days, as spreadsheets and MATLAB count them, or "
                          "seconds: state it with --units (day or s in the column's place)"));
  ImportOptions days;
  days.units = {"day", ""};
  const Record record = imported("Timestamp,Force (N)\n45352.0,0\n45352.5,1\n45353.0,2\n", days);
  EXPECT_NEAR(record.channels.at(0).clock.interval, 43200.0, 1e-6);
  EXPECT_NEAR(
      imported("Time,Force (N)\n45352.5,0\n45352.6,1\n45352.7,2\n").channels.at(0).clock.interval,
      0.1, 1e-9);
}

TEST(Csv, UnevenTimesAreKept) {
  const Record record = imported("time [ms],F [N]\n0,1\n1,2\n5,3\n6.5,3\n");
  EXPECT_THAT(record.channels[0].clock.times, ElementsAre(0.0, 0.001, 0.005, 0.0065));
  EXPECT_THAT(record.warnings, ElementsAre(HasSubstr("the samples are not evenly spaced")));
}

TEST(Csv, ColumnsBehindASecondTimeColumnHaveItsClock) {
  const Record record = imported(
      "Time A [s],Force [N],Time B [ms],Vel [m/s],Acc [g]\n"
      "0.000,1.5,0.5,2.5,1\n0.001,1.6,2.5,2.6,2\n0.002,1.7,4.5,2.7,3\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("Force [N]", "Vel [m/s]", "Acc [g]"));
  EXPECT_EQ(record.channels[0].clock.start, 0.0);
  EXPECT_EQ(record.channels[0].clock.interval, 1e-3);
  for (const std::size_t c : {1U, 2U}) {
    EXPECT_EQ(record.channels[c].clock.start, 0.5e-3);
    EXPECT_DOUBLE_EQ(record.channels[c].clock.interval, 2e-3);
  }
  EXPECT_EQ(record.attributes.at("further time columns"), "Time B");
  EXPECT_THAT(record.warnings, IsEmpty());
}

TEST(Csv, ATimeColumnMayBeNamedAfterTheNextColumn) {
  for (const char* names : {"t,force,t_acc,acc", "t_F,F,t_A,A", "tF,F,tA,A"}) {
    const Record record = imported(std::string(names) +
                                   "\n0.000,1.5,0.5,2.5\n0.001,1.6,2.5,2.6\n0.002,1.7,4.5,2.7\n");
    ASSERT_EQ(record.channels.size(), 2U) << names;
    EXPECT_EQ(record.channels[0].clock.interval, 1e-3);
    EXPECT_EQ(record.channels[1].clock.start, 0.5);
    EXPECT_EQ(record.channels[1].clock.interval, 2.0);
    for (const std::string& warning : record.warnings)
      EXPECT_THAT(warning, HasSubstr("states no unit: it is taken as s"));
  }
  EXPECT_EQ(imported("t,t_oil,v\n0,20,1\n1,21,2\n2,22,3\n").channels.size(), 2U)
      << "the time of no other column";
}

TEST(Csv, ASecondTimeColumnOfTheSameTimesIsNoOtherClock) {
  const Record record =
      imported("Time [s],Force [N],Time [s],Vel [m/s]\n0,1.5,0,2.5\n1,1.6,1,2.6\n5,1.7,5,2.7\n");
  ASSERT_EQ(record.channels.size(), 2U);
  EXPECT_EQ(record.channels[0].clock.times, record.channels[1].clock.times);
  EXPECT_EQ(record.warnings.size(), 1U);  // the times are not even, said once
}

TEST(Csv, OfTwoTimeColumnsSideBySideTheSecondIsAChannel) {
  EXPECT_THAT(names_and_units(imported("Time [s],Time abs [s],F [N]\n0,10,1\n1,11,2\n2,12,3\n")),
              ElementsAre("Time abs [s]", "F [N]"));
  EXPECT_THAT(names_and_units(
                  imported("Time [s],F [N],Time over [ms],v [m/s]\n0,1,3,1\n1,2,2,2\n2,3,5,3\n")),
              ElementsAre("F [N]", "Time over [ms]", "v [m/s]"));
}

TEST(Csv, ATimeColumnNeedsEveryTimeAndAUnitOfTime) {
  EXPECT_EQ(import_error("time [s],F\n0,1\n,2\n1,3\n"),
            "FILE:3:1 (byte 15): time: a time is missing; state --time-column none and "
            "--sample-rate to do without this column");
  ImportOptions options;
  options.time_column = "0";
  EXPECT_EQ(import_error("when [m],F\n0,1\n1,2\n", options),
            "FILE: the time column 'when' has the unit 'm', which is not one of time: state it "
            "with --units");
}

}  // namespace
}  // namespace impactrig::acquisition
