// SPDX-License-Identifier: BSD-3-Clause
// What the columns of a table are where their heads do not say so plainly.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "acquisition/importer.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Channel;
using datasets::Record;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using tests::import_error;
using tests::imported;
using tests::names_and_units;

/// Rows of pairs of times and values, the second ones of half the step.
std::string pairs(const std::string& head, const std::string& row = "{0},{1},{2},{3}\n") {
  std::string text = head + "\n";
  for (int i = 0; i < 5; ++i) text += fmt::format(fmt::runtime(row), 0.1 * i, i, 0.05 * i, 10 + i);
  return text;
}

// --- Times of their own
// ----------------------------------------------------------------------------

class CsvPairs : public testing::TestWithParam<const char*> {};

TEST_P(CsvPairs, HaveTimesOfTheirOwn) {
  const Record record = imported(pairs(GetParam()));
  ASSERT_EQ(record.channels.size(), 2U);
  EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 0.1);
  EXPECT_DOUBLE_EQ(record.channels[1].clock.interval, 0.05);
  EXPECT_THAT(record.channels[1].values(), ElementsAre(10, 11, 12, 13, 14));
}

INSTANTIATE_TEST_SUITE_P(Names, CsvPairs,
                         testing::Values("Time 1 [s],F [N],Time 2 [s],v [m/s]",
                                         "Time [s],F [N],Time.1 [s],v [m/s]", "t,F,t_2,v",
                                         "t1 [s],F [N],t2 [s],v [m/s]", "X,F,X,v",
                                         "F time (s),F (N),v time (s),v (m/s)"));

// keys above do not say how many columns there are
TEST(CsvCommas, BetweenTwoWholeNumbersUnderNoNamesMayBeDecimalMarks) {
  const std::string rows = "1,5\n2,25\n-3,5\n";
  for (const char* const head : {"", "Sample rate: 1000 Hz\n"}) {
    const Record record = imported(head + rows);
    EXPECT_EQ(record.channels.size(), 2U);
    EXPECT_THAT(
        record.warnings,
        testing::Contains("each row is two whole numbers under no names: the comma is taken "
                          "for the end of a cell (--decimal , reads '1,5' as one number)"));
  }
  ImportOptions options;
  options.decimal = ',';
  EXPECT_THAT(imported(rows, options).channels.at(0).values(), ElementsAre(1.5, 2.25, -3.5));
  options = {};
  options.delimiter = ',';
  const auto told = testing::Contains(HasSubstr("whole numbers under no names"));
  EXPECT_THAT(imported(rows, options).warnings, testing::Not(told));
  for (const char* const sure :
       {"1,5\n2,2.5\n3,5\n", "1,5\n2,-2\n3,5\n", "0,5\n1,2\n2,5\n3,4\n", "F,v\n1,5\n2,25\n"})
    EXPECT_THAT(imported(sure).warnings, testing::Not(told)) << sure;
}

TEST(CsvPairs, HaveUnitsOfTheirOwn) {
  const Record record =
      imported("F time (ms),F (N),v time (us),v (m/s)\n0,0,0,0\n1,1,100,1\n2,2,200,2\n");
  ASSERT_EQ(record.channels.size(), 2U);
  EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 1e-3);
  EXPECT_DOUBLE_EQ(record.channels[1].clock.interval, 1e-4);
  EXPECT_THAT(record.warnings, IsEmpty());
}

TEST(CsvPairs, MayHaveTheirTimesBehindThem) {
  const Record record = imported(pairs("F [N],Time [s],v [m/s],Time [s]", "{1},{0},{3},{2}\n"));
  EXPECT_THAT(names_and_units(record), ElementsAre("F [N]", "v [m/s]"));
  EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 0.1);
  EXPECT_DOUBLE_EQ(record.channels[1].clock.interval, 0.05);
}

TEST(CsvPairs, MayEndOneBeforeTheOther) {
  const Record record = imported(
      "Time 1 [s],F [N],Time 2 [s],v [m/s]\n0,0,0,5\n0.1,1,0.2,6\n0.2,2,0.4,7\n0.3,3,,\n0.4,4,,\n");
  ASSERT_EQ(record.channels.size(), 2U);
  EXPECT_EQ(record.channels[0].size(), 5U);
  EXPECT_THAT(record.channels[1].values(), ElementsAre(5, 6, 7));
  EXPECT_DOUBLE_EQ(record.channels[1].clock.interval, 0.2);
  EXPECT_TRUE(record.channels[1].valid.empty());
  EXPECT_THAT(record.warnings, IsEmpty());
}

TEST(CsvPairs, OfWhichTheFirstEndsBeforeTheOther) {
  const Record record =
      imported("Time 1 [s],F [N],Time 2 [s],v [m/s]\n0,0,0,5\n0.1,1,0.2,6\n,,0.4,7\n,9,0.6,8\n");
  ASSERT_EQ(record.channels.size(), 2U);
  EXPECT_THAT(record.channels[0].values(), ElementsAre(0, 1));
  EXPECT_THAT(record.channels[1].values(), ElementsAre(5, 6, 7, 8));
  EXPECT_THAT(record.warnings,
              ElementsAre(HasSubstr("'F': 1 value behind the last of its times is left out")));
}

TEST(CsvPairs, AreToldOfWhereOnlyTheUnitSaysSo) {
  const Record record = imported(pairs("Time [s],F [N],stamp [s],v [m/s]"));
  ASSERT_EQ(record.channels.size(), 2U);
  EXPECT_DOUBLE_EQ(record.channels[1].clock.interval, 0.05);
  EXPECT_THAT(record.warnings,
              ElementsAre(HasSubstr("'stamp' is taken as the times of the columns beside it")));
}

TEST(CsvPairs, WithAGapInTheirTimesAreToldOf) {
  const Record record = imported("t,F,t,v\n0,1,0,5\n1,2,,6\n2,3,1,7\n");
  EXPECT_EQ(record.channels.size(), 3U);
  EXPECT_THAT(record.warnings,
              Contains(HasSubstr("'t' is named as times of its own, but has gaps")));
  ImportOptions options;
  options.time_column = "0";
  EXPECT_THAT(imported("t [s],F,t [s],v\n0,1,0,5\n1,2,7,6\n2,3,1,7\n", options).warnings,
              IsEmpty());
}

TEST(CsvPairs, AreNoneWhereSignalsRise) {
  EXPECT_EQ(imported("0.5,1,2,3\n0.6,2,3,4\n0.7,3,4,5\n0.8,4,5,6\n").channels.size(), 3U);
  EXPECT_EQ(imported("t,F,T2,v\n0.5,1,2,3\n0.6,2,3,4\n0.7,3,4,5\n").channels.size(), 3U);
  EXPECT_EQ(imported("t [s],F,delay [ms],v\n0,1,2,3\n1,2,2,4\n2,3,4,5\n").channels.size(), 3U);
}

// --- Columns that count
// ----------------------------------------------------------------------------

class CsvRowNumbers : public testing::TestWithParam<const char*> {};

TEST_P(CsvRowNumbers, WithoutANameDoNotShiftTheOthers) {
  const Record record = imported(GetParam());
  EXPECT_THAT(names_and_units(record), ElementsAre("force [N]"));
  EXPECT_THAT(record.channels[0].values(), ElementsAre(5, 6, 7));
  EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 0.001);
}

INSTANTIATE_TEST_SUITE_P(
    Tables, CsvRowNumbers,
    testing::Values("\"time [s]\",\"force [N]\"\n\"1\",0.000,5\n\"2\",0.001,6\n\"3\",0.002,7\n",
                    "time [s],force [N]\n0,0.000,5\n1,0.001,6\n2,0.002,7\n",
                    ",time [s],force [N]\n0,0.000,5\n1,0.001,6\n2,0.002,7\n",
                    "time [s];force [N]\n1;0,000;5\n2;0,001;6\n3;0,002;7\n"));

TEST(CsvRowNumbers, ThatAreNoneMakeNamesDoubtful) {
  const Record record = imported("time [s],force [N]\n0,7,5\n0.1,8,6\n0.2,9,7\n");
  EXPECT_THAT(record.warnings,
              Contains(HasSubstr("line 1 names 2 of 3 columns: the first ones are taken")));
}

TEST(CsvRowNumbers, AreNoPhysicalQuantity) {
  EXPECT_THAT(names_and_units(imported("Frequency [Hz],Amp [N]\n0,5\n1,6\n2,7\n")),
              ElementsAre("Frequency [Hz]", "Amp [N]"));
  EXPECT_THAT(
      names_and_units(imported("Sample rate,1000\nDisplacement [mm],Force [N]\n0,5\n1,6\n2,7\n")),
      ElementsAre("Displacement [mm]", "Force [N]"));
  EXPECT_THAT(names_and_units(imported("Force,v [m/s]\n1,5\n2,6\n3,7\n")),
              ElementsAre("Force []", "v [m/s]"));
}

TEST(CsvRowNumbers, BesideATimeAreNoChannelEither) {
  EXPECT_THAT(names_and_units(imported("No.;Time [s];Force [N]\n1;0,1;5\n2;0,2;6\n3;0,3;7\n")),
              ElementsAre("Force [N]"));
  EXPECT_THAT(names_and_units(imported("Number,Time,CH1\nNO.,s,V\n1,0.1,5\n2,0.2,6\n3,0.3,7\n")),
              ElementsAre("CH1 [V]"));
  EXPECT_THAT(names_and_units(imported("N,Time,CH1\nN,s,V\n1,0.1,5\n2,0.2,6\n3,0.3,7\n")),
              ElementsAre("N [N]", "CH1 [V]"));
  EXPECT_THAT(names_and_units(imported("Gate,Time [s],F [N]\n1,0.1,5\n2,0.2,6\n3,0.3,7\n")),
              ElementsAre("Gate []", "F [N]"));
}

// Tables of force over displacement have no time.
TEST(CsvTimeColumn, IsNoneThatAnotherQuantityNames) {
  for (const std::string name : {"Stroke", "Weg", "Extension", "Depth", "Temperature", "Wavelength",
                                 "Node", "f", "Kraft", "Crosshead travel"})
    EXPECT_THAT(names_and_units(imported(name + ",Load\n0,5\n0.5,6\n1.0,7\n")),
                ElementsAre(name + " []", "Load []"));
  EXPECT_THAT(names_and_units(imported("x,Load\n0,5\n0.5,6\n1.0,7\n")), ElementsAre("Load []"));
}

TEST(CsvRowNumbers, UnderAnotherNameAreToldOf) {
  const Record record = imported("Shot,Force [N]\n0,5\n1,6\n2,7\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("Force [N]"));
  EXPECT_THAT(record.warnings, Contains(HasSubstr("'Shot' counts 0, 1, 2")));
  EXPECT_THAT(imported("Sample,Force [N]\n0,5\n1,6\n2,7\n").warnings,
              testing::Not(Contains(HasSubstr("counts"))));
}

TEST(CsvTimes, MayBeNamedByTheirUnitAlone) {
  const Record record = imported("ms,F [N]\n0,5\n1,6\n2,7\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("F [N]"));
  EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 1e-3);
}

// --- Times far from 0
// ----------------------------------------------------------------------------

class CsvEpoch : public testing::TestWithParam<const char*> {};

/// Steps of 0.5 us behind the first digits, as text: in doubles they are 2 or 3 of the last place.
TEST_P(CsvEpoch, KeepsTheStepsThatAreWritten) {
  std::string text = std::string("time [") +
                     (std::string(GetParam()).find('.') == std::string::npos ? "ns" : "s") +
                     "],F [N]\n";
  for (int i = 0; i < 40; ++i)
    text += fmt::format(fmt::runtime(GetParam()), 1000 + 5 * i) + fmt::format(",{}\n", i);
  const Record record = imported(text);
  ASSERT_EQ(record.channels.size(), 1U);
  EXPECT_TRUE(record.channels[0].clock.uniform());
  EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 5e-7);
  EXPECT_EQ(record.channels[0].clock.start, 0.0);
  EXPECT_THAT(record.warnings,
              ElementsAre(HasSubstr("too far from 0 for its steps: times are counted from there")));
}

INSTANTIATE_TEST_SUITE_P(Spellings, CsvEpoch,
                         testing::Values("1709290000.000{}", "\"1709290000.000{}\"",
                                         "1709290000.000{}e0", "170929000000{}00"));

TEST(CsvEpoch, LeavesTimesThatDoublesHold) {
  const Record record =
      imported("time [s],F [N]\n1709290000.0,1\n1709290000.5,2\n1709290001.0,3\n");
  EXPECT_EQ(record.channels[0].clock.start, 1709290000.0);
  EXPECT_EQ(record.channels[0].clock.interval, 0.5);
  EXPECT_THAT(record.warnings, IsEmpty());
}

// --- Lines above the rows
// ----------------------------------------------------------------------------

TEST(CsvColumnNumbers, AreNoSamples) {
  const Record plain = imported("0,1\n0.000,5.5\n0.001,6.5\n0.002,7.5\n");
  ASSERT_EQ(plain.channels.size(), 1U);
  EXPECT_THAT(plain.channels[0].values(), ElementsAre(5.5, 6.5, 7.5));
  EXPECT_THAT(plain.warnings, Contains(HasSubstr("line 1 ('0,1') is taken to number the columns")));
  const Record counted = imported(",0,1\n0,0.000,5.5\n1,0.001,6.5\n2,0.002,7.5\n");
  ASSERT_FALSE(counted.channels.empty());
  EXPECT_THAT(counted.channels.back().values(), ElementsAre(5.5, 6.5, 7.5));
}

TEST(CsvColumnNumbers, AreSamplesWhereOthersAreWholeToo) {
  EXPECT_EQ(imported("0,1\n1,3\n2,5\n").channels.at(0).size(), 3U);
  EXPECT_EQ(imported("0,1\n0.5,3.5\n1,5.5\n").channels.at(0).size(), 3U);
}

TEST(CsvSpoiltRows, AtTheTopAreNotPassedOver) {
  EXPECT_THAT(import_error("Time [s];F [N]\n0.0;0\n0.1;1\n0.2,2\n0.3,3\n0.4,4\n0.5,5\n"),
              HasSubstr(":2:"));
  EXPECT_THAT(import_error("Time,F\n0.0 s,0 N\n0.1 s,1 N\n0.2,2\n0.3,3\n0.4,4\n0.5,5\n"),
              HasSubstr(":2:"));
  EXPECT_EQ(imported("2024-03-01,12:00:00\n0.0,1\n0.1,2\n0.2,3\n").channels.at(0).size(), 3U);
}

TEST(CsvLineEnds, OfTwoKindsAreRefused) {
  EXPECT_THAT(import_error("Time [s],F [N]\n0,5\n0.1,6\r0.2,7\n0.3,8\r0.4,9\n"),
              HasSubstr("ends with a carriage return alone"));
  EXPECT_THAT(import_error("Time [s],F [N]\r0,5\r0.1,6\r0.2,7\n0.3,8\n0.4,9\n"),
              HasSubstr("ends with a carriage return alone"));
  EXPECT_EQ(imported("Time [s],\"F\r[N]\"\n0,5\n0.1,6\n0.2,7\n").channels.at(0).size(), 3U);
}

// --- One column under keys, as ISO 13499 (MME) has it
// ----------------------------------------------------------------------------

const std::string channel_file =
    "Test object number          :1\n"
    "Name of the channel         :Chest acceleration, X\n"
    "Laboratory channel code     :NOVALUE\n"
    "Channel code                :11CHST0000H3ACXA\n"
    "Dimension                   :Acceleration\n"
    "Channel frequency class     :1000\n"
    "Unit                        :m/(s*s)\n"
    "Sampling interval           :0.0001\n"
    "Time of first sample        :-0.0010\n"
    "Number of samples           :3\n"
    "  1.25\n  3.25\n  2.25\n";

TEST(CsvOneColumn, TakesNameUnitAndStartFromKeys) {
  const Record record = imported(channel_file, {}, ".001");
  ASSERT_EQ(record.channels.size(), 1U);
  const Channel& channel = record.channels[0];
  EXPECT_EQ(channel.name, "Chest acceleration, X");
  EXPECT_EQ(channel.unit, "m/(s*s)");
  EXPECT_EQ(channel.quantity, datasets::Quantity::acceleration);
  EXPECT_EQ(channel.clock.start, -1e-3);
  EXPECT_EQ(channel.clock.interval, 1e-4);
  EXPECT_THAT(channel.values(), ElementsAre(1.25, 3.25, 2.25));
  EXPECT_EQ(record.attributes.at("Number of samples"), "3");
  EXPECT_THAT(record.warnings, IsEmpty());
}

TEST(CsvOneColumn, KeysMayEndWithATextAndStateNothing) {
  std::string file = channel_file;
  file.replace(file.find("Chest acceleration, X"), 21, "NOVALUE");
  file.replace(file.find("-0.0010"), 7, "NOVALUE");
  file.replace(file.find("Number of samples           :3"), 30, "Reference channel :explicit");
  const Channel channel = imported(file, {}, ".001").channels.at(0);
  EXPECT_EQ(channel.name, "11CHST0000H3ACXA");
  EXPECT_EQ(channel.clock.start, 0.0);
  file.replace(file.find(":0.0001"), 7, ":0.001");
  file.replace(file.find("Time of first sample        :NOVALUE"), 36, "Time of first sample :soon");
  EXPECT_THAT(imported(file, {}, ".001").warnings,
              ElementsAre("the header states 'Time of first sample' as 'soon', which is not "
                          "understood: it is not used"));
  ImportOptions options;
  options.sample_rate = 1000;
  EXPECT_EQ(imported("Trace: Force\n1.5\n0.5\n2.5\n", options).channels.at(0).name, "Trace: Force");
}

}  // namespace
}  // namespace impactrig::acquisition
