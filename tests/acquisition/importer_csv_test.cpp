// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "acquisition/importer.hpp"
#include "acquisition/importers/column_heads.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Channel;
using datasets::Quantity;
using datasets::Record;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using tests::import_error;
using tests::imported;
using tests::names_and_units;

// --- How it is written
// ----------------------------------------------------------------------------

struct Spelling {
  const char* text;
  const char* delimiter;
  const char* decimal;
};

class CsvSpelling : public testing::TestWithParam<Spelling> {};

TEST_P(CsvSpelling, IsFoundByTheRowsItExplains) {
  const Record record = imported(GetParam().text);
  EXPECT_EQ(record.attributes.at("delimiter"), GetParam().delimiter);
  EXPECT_EQ(record.attributes.at("decimal"), GetParam().decimal);
  EXPECT_THAT(names_and_units(record), ElementsAre("Force [N]", "Velocity [mm/s]"));
  ASSERT_EQ(record.channels.size(), 2U);
  EXPECT_THAT(record.channels[0].values(), ElementsAre(1.5, -2.5, 3.0));
  EXPECT_THAT(record.channels[1].values(), ElementsAre(10.0, 20.25, -30.0));
  EXPECT_EQ(record.channels[0].quantity, Quantity::force);
  EXPECT_EQ(record.channels[1].quantity, Quantity::velocity);
  EXPECT_EQ(record.channels[0].clock.start, 0.5);
  EXPECT_EQ(record.channels[0].clock.interval, 0.5);
  EXPECT_THAT(record.warnings, IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(
    Variants, CsvSpelling,
    testing::Values(
        Spelling{"time [s],Force [N],Velocity [mm/s]\n0.5,1.5,10\n1.0,-2.5,20.25\n1.5,3,-30\n",
                 "comma", "."},
        Spelling{"time (s);Force (N);Velocity (mm/s)\n0,5;1,5;10\n1,0;-2,5;20,25\n1,5;3;-30\n",
                 "semicolon", ","},
        Spelling{"time [s]\tForce [N]\tVelocity "
                 "[mm/s]\r\n0.5\t1.5\t10\r\n1.0\t-2.5\t20.25\r\n1.5\t3\t-30\r\n",
                 "tab", "."},
        Spelling{
            "t / s\tForce / N\tVelocity / mm/s\n0,5\t1,5\t1,0E1\n1,0\t-2,5\t20,25\n1,5\t3\t-30\n",
            "tab", ","},
        Spelling{
            "# time(s) Force(N) Velocity(mm/s)\n 0.5  1.5  10\n 1.0 -2.5\t20.25\n 1.5  3    -30\n",
            "blank", "."},
        Spelling{"time|Force|Velocity\ns|N|mm/s\n0.5|1.5|10\n1|-2.5|20.25\n1.5|3|-30\n", "bar",
                 "."},
        Spelling{
            "\"time [s]\",\"Force [N]\",\"Velocity "
            "[mm/s]\"\n\"0.5\",\"1.5\",\"10\"\n\"1\",\"-2.5\",\"20.25\"\n\"1.5\",\"3\",\"-30\"",
            "comma", "."},
        Spelling{"time,Force,Velocity,\r\n[s],[N],[mm/"
                 "s],\r\n0.5,1.5,10,\r\n\r\n1.0,-2.5,20.25,\r\n1.5,3,-30,\r\n\r\n",
                 "comma", "."},
        Spelling{"\xEF\xBB\xBF"
                 "Time [s], Force [N], Velocity [mm/s]\n 0.5 , 1.5 , 10 \n 1.0 , -2.5 , 2.025D+01 "
                 "\n 1.5 , 3 , -30 \n",
                 "comma", "."}));

TEST(Csv, MayBeUtf16) {
  std::string text("\xFF\xFE");
  for (const char c : std::string_view("time [s],Force [N]\n0.5,1\n1.0,2\n")) {
    text += c;
    text += '\0';
  }
  const Record record = imported(text, {}, ".csv");
  EXPECT_THAT(names_and_units(record), ElementsAre("Force [N]"));
  EXPECT_THAT(record.channels[0].values(), ElementsAre(1.0, 2.0));
}

// A logger that takes room on the disk ahead leaves it behind its rows when it is stopped.
TEST(Csv, MayEndWithBytesOfZero) {
  const std::string text = "t [s],F [N]\n0,1\n1,2\n2,3\n";
  const Record record = imported(text + std::string(100, '\0'));
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(1, 2, 3));
  EXPECT_THAT(record.warnings,
              ElementsAre("the file ends with 100 bytes of zero (was its writer stopped?): they "
                          "are left out"));
  // the last row may be cut
  const Record cut = imported(text + "3,4" + std::string(1, '\0'));
  EXPECT_EQ(cut.channels.at(0).value(3), 4);
  EXPECT_THAT(cut.warnings,
              ElementsAre("the file ends with 1 byte of zero (was its writer stopped?): it is left "
                          "out"));
  EXPECT_THAT(import_error(std::string("12\0\0", 4)), HasSubstr("of no known format"));
}

TEST(Csv, WhoseColumnsHaveOneNameIsTold) {
  const Record record = imported("t [s],F [N],v [m/s],F [N]\n0,1,5,2\n1,2,6,3\n2,3,7,4\n");
  EXPECT_THAT(record.warnings,
              ElementsAre("2 channels are called 'F': the name means the first of them, an index "
                          "any other"));
  ImportOptions options;
  options.channels = {"F"};
  EXPECT_THAT(imported("t [s],F [N],F [N]\n0,1,2\n1,2,3\n", options).warnings, testing::SizeIs(1));
}

TEST(Csv, WithLatin1UnitsIsUtf8Inside) {
  const Record record = imported("Zeit [\xB5s];Beschleunigung [m/s\xB2]\n0;1\n1;2\n2;3\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("Beschleunigung [m/s\u00B2]"));
  EXPECT_EQ(record.channels[0].quantity, Quantity::acceleration);
  EXPECT_EQ(record.channels[0].clock.interval, 1e-6);
}

TEST(Csv, IsReadAsTheUserSays) {
  ImportOptions options;
  options.decimal = ',';
  const Record comma = imported("0,5\n1,5\n2,5\n", options);
  EXPECT_THAT(comma.channels.front().values(), ElementsAre(0.5, 1.5, 2.5));
  options.decimal.reset();
  options.delimiter = '/';
  EXPECT_EQ(imported("1/2\n2/4\n3/5\n", options).channels.size(), 1U);
  options.delimiter.reset();
  options.skip_lines = 2;
  const Record skipped = imported("1,2\n3,4\ntime,F\n0.1,7\n0.2,8\n", options);
  EXPECT_THAT(skipped.channels.front().values(), ElementsAre(7.0, 8.0));
  EXPECT_EQ(skipped.channels.front().name, "F");
}

TEST(CsvQuotes, HoldDecimalCommasBetweenCommas) {
  for (const char* text :
       {"\"time [s]\",\"Force [N]\"\n\"0,5\",\"1,5\"\n\"1,0\",\"-2,5\"\n\"1,5\",\"1,234\"\n",
        "time [s],Force [N]\n\"0,5\",\"1,5\"\n1,\"-2,5\"\n\"1,5\",\"1,234\"\n"}) {
    const Record record = imported(text);
    EXPECT_EQ(record.attributes.at("delimiter"), "comma");
    EXPECT_EQ(record.attributes.at("decimal"), ",");
    EXPECT_THAT(names_and_units(record), ElementsAre("Force [N]"));
    EXPECT_THAT(record.channels[0].values(), ElementsAre(1.5, -2.5, 1.234));
    EXPECT_EQ(record.channels[0].clock.start, 0.5);
    EXPECT_EQ(record.channels[0].clock.interval, 0.5);
  }
  // points between numbers whose decimal marks are commas
  EXPECT_THAT(import_error("a,b\n\"0,5\",\"1,5\"\n1,\"-2,5\"\n\"1,5\",1.234\n"),
              HasSubstr("expected a number, found '1.234'"));
  EXPECT_THAT(import_error("a,b\n\"1,234\",\"2,345\"\n\"1,235\",\"2,346\"\n"),
              HasSubstr("thousands separators"));
}

TEST(CsvQuotes, HoldBreaksAndQuotesOfNames) {
  const Record record = imported(
      "\"Time\n[s]\",\"Force \"\"A\"\"\r\n[N]\",\"Velocity\n[mm/s]\"\n0.5,1.5,10\n1.0,-2.5,20\n"
      "1.5,3,-30\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("Force \"A\" [N]", "Velocity [mm/s]"));
  EXPECT_THAT(record.channels[1].values(), ElementsAre(10.0, 20.0, -30.0));
  EXPECT_EQ(record.channels[0].clock.interval, 0.5);
  EXPECT_THAT(record.warnings, IsEmpty());
  // inches, and a quote that never closes, end with their line
  const Record inches =
      imported("bar of 5\"\n\"a note\ntime [s],Force [N]\n0.5,1.5\n1.0,-2.5\n1.5,3\n");
  EXPECT_THAT(names_and_units(inches), ElementsAre("Force [N]"));
}

// --- Heads
// ----------------------------------------------------------------------------------------

TEST(ColumnHead, IsDividedIntoNameAndUnit) {
  const auto divided = [](std::string_view cell) {
    const ColumnHead head = split_head(cell);
    return head.name + "|" + head.unit;
  };
  EXPECT_EQ(divided("Force [N]"), "Force|N");
  EXPECT_EQ(divided("CH 1 (V)"), "CH 1|V");
  EXPECT_EQ(divided("time(s),"), "time|s");
  EXPECT_EQ(divided("v / mm/s"), "v|mm/s");
  EXPECT_EQ(divided("Force [kp?]"), "Force|kp?");
  EXPECT_EQ(divided("accel (top)"), "accel (top)|");
  EXPECT_EQ(divided("left (outer) [V]"), "left (outer)|V");
  EXPECT_EQ(divided("name []"), "name|");
  EXPECT_EQ(divided("left / right"), "left / right|");
  EXPECT_EQ(divided("Time_ms"), "Time|ms");
  EXPECT_EQ(divided("timestamp_ns"), "timestamp|ns");
  EXPECT_EQ(divided("t/ms"), "t|ms");
  EXPECT_EQ(divided("v/mm/s"), "v|mm/s");
  EXPECT_EQ(divided("Time in ms"), "Time|ms");
  EXPECT_EQ(divided("C1 in V"), "C1|V");
  EXPECT_EQ(divided("in s"), "|s");
  EXPECT_EQ(divided("Time - ms"), "Time|ms");
  EXPECT_EQ(divided("Time, ms"), "Time|ms");
  EXPECT_EQ(divided("F/N"), "F|N");
  EXPECT_EQ(divided("m/s"), "m/s|");
  EXPECT_EQ(divided("mV/g"), "mV/g|");
  EXPECT_EQ(divided("N/A"), "N/A|");
  EXPECT_EQ(divided("Channel, C"), "Channel, C|");
  EXPECT_EQ(divided("left/right"), "left/right|");
  EXPECT_EQ(divided("Force_N"), "Force_N|");
  EXPECT_EQ(divided(""), "|");
}

TEST(Csv, WithoutAHeaderNumbersItsColumns) {
  const Record record = imported("0.001 5 7\n0.002 6 8\n0.003 7 9\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("column 1 []", "column 2 []"));
  EXPECT_EQ(record.channels[0].clock.interval, 0.001);
  EXPECT_EQ(record.channels[0].quantity, Quantity::unknown);
  EXPECT_THAT(
      record.warnings,
      ElementsAre(
          "the time column 'column 0' states no unit: it is taken as s (--units states another)"));
  EXPECT_EQ(record.attributes.at("time column"),
            "column 0 (the first column, since it increases throughout)");
}

TEST(Csv, OfBlanksKeepsUnitsAndWordsWithTheirNames) {
  for (const char* head :
       {"# time [s] force [N] velocity [mm/s]\n", "time [ s ]  force [N]  velocity [mm/s]\n",
        "time (s)\tforce (N)\tvelocity (mm/s)\n", "# time, s   force, N   velocity, mm/s\n",
        "t / s force / N velocity / mm/s\n", "time force velocity\n[s] [N] [mm/s]\n",
        "time  force  velocity\n[ s ] [ N ] [ mm/s ]\n"}) {
    const Record record = imported(std::string(head) + "0.000 1.5 2.5\n0.001 1.6 2.6\n");
    ASSERT_EQ(record.channels.size(), 2U) << head;
    EXPECT_THAT(record.channels[0].name, testing::StartsWith("force")) << head;
    EXPECT_THAT(record.channels[0].values(), ElementsAre(1.5, 1.6)) << head;
    EXPECT_THAT(record.channels[1].name, testing::StartsWith("velocity")) << head;
    EXPECT_THAT(record.warnings, IsEmpty()) << head;
    EXPECT_EQ(record.channels[1].unit, "mm/s") << head;
  }
  const Record words =
      imported("Time   Force sensor   Beam velocity\n0.0  1.5  2.5\n0.1  1.6  2.6\n");
  EXPECT_THAT(names_and_units(words), ElementsAre("Force sensor []", "Beam velocity []"));
}

TEST(Csv, OfBlanksHasNoNamesWhereTheyDoNotFitTheColumns) {
  const Record record = imported("Time Force sensor Beam velocity\n0.0 1.5 2.5\n0.1 1.6 2.6\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("column 1 []", "column 2 []"));
  EXPECT_EQ(record.attributes.at("header"), "Time Force sensor Beam velocity");
  EXPECT_THAT(
      record.warnings,
      testing::Contains("line 1 above the rows ('Time Force sensor Beam velocity') does not "
                        "fit their 3 columns: they are numbered"));
  const Record units =
      imported("Time Force sensor Beam velocity\ns N mm/s\n0.0 1.5 2.5\n0.1 1.6 2.6\n");
  EXPECT_THAT(names_and_units(units), ElementsAre("column 1 [N]", "column 2 [mm/s]"));
  EXPECT_EQ(units.attributes.at("unit row"), "line 2");
  EXPECT_THAT(imported("# date: today\n0.0 1.5\n0.1 1.6\n").warnings,
              testing::Not(testing::Contains(HasSubstr("above the rows"))));
}

TEST(Csv, MayStateUnitsInASentence) {
  const Record record = imported(
      "time, accel 1, load\n"
      "time - seconds (computed after test), deacceleration - kg, compression - "
      "N\n0,1,2\n0.5,3,4\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("accel 1 [kg (kilo-g)]", "load [N]"));
  EXPECT_EQ(record.channels[0].quantity, Quantity::acceleration);
  EXPECT_EQ(record.channels[0].attributes.at("unit in file"), "kg");
  EXPECT_EQ(record.channels[0].attributes.at("description"), "deacceleration");
  EXPECT_THAT(
      record.warnings,
      ElementsAre(
          "the unit 'kg' of an acceleration is read as kilo-g (1000 g); --units states another"));
}

TEST(Csv, MayHaveKeysAboveItsColumns) {
  const Record record = imported(
      "Model,MSO64\nSample Interval,0.5\nVertical Units,V\nHorizontal "
      "Units,ms\n\nLabels,\nTIME,CH1\n"
      "0,1\n1,2\n2,3\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("CH1 [V]"));
  EXPECT_EQ(record.attributes.at("Model"), "MSO64");
  EXPECT_EQ(record.attributes.at("column names"), "line 7");
  EXPECT_EQ(record.attributes.at("first data line"), "8");
  EXPECT_THAT(
      record.warnings,
      ElementsAre("the header states a sample interval of 0.5 s but the time column steps by "
                  "0.001 s: the time column is used"));
}

TEST(Csv, TakesItsClockFromAKeyWhenItHasNoTimeColumn) {
  for (const char* key : {"Sample Interval,2e-6", "# Sampling rate: 500 kHz",
                          "sample_rate [Hz]=500000", "dt,0.002 ms"}) {
    const Record record = imported(std::string(key) + "\nCH1 (V),CH2 (V)\n1,2\n3,1\n2,5\n");
    ASSERT_EQ(record.channels.size(), 2U) << key;
    EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 2e-6) << key;
    EXPECT_THAT(record.warnings, IsEmpty());
  }
}

TEST(Csv, WithDecimalCommasMayStateItsRateSoToo) {
  for (const char* key :
       {"Sampling rate;51,2 kHz", "Sampling rate [kHz];51,2", "Sampling rate;51200",
        "Sample Period;0,00001953125", "Sample Period;0.00001953125"}) {
    const Record record = imported(std::string(key) + "\nF [N];v [m/s]\n1,5;2,5\n1,4;2,6\n");
    ASSERT_EQ(record.channels.size(), 2U) << key;
    EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 1.0 / 51200.0) << key;
    EXPECT_THAT(record.warnings, IsEmpty()) << key;
  }
  const Record record = imported("Sampling rate;51.200\nF [N];v [m/s]\n1,5;2,5\n1,4;2,6\n");
  EXPECT_EQ(record.channels[0].clock.interval, 0.0);
  EXPECT_THAT(
      record.warnings,
      testing::Contains("the header states 'Sampling rate' as '51.200', whose point may be a "
                        "decimal mark or divide thousands: it is not used (--sample-rate "
                        "states it)"));
}

TEST(Csv, DividedByCommasMayStateItsRateWithinQuotes) {
  const Record record = imported("Sampling rate [kHz],\"51,2\"\nF [N],v [m/s]\n1.5,2.5\n1.4,2.6\n");
  EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 1.0 / 51200.0);
  EXPECT_THAT(record.warnings, IsEmpty());
  for (const char* rate : {"\"51,200\"", "51,2 kHz", "fast", "-3", "3 apples"})
    EXPECT_THAT(
        imported(fmt::format("Sampling rate,{}\nF [N],v [m/s]\n1.5,2.5\n1.4,2.6\n", rate)).warnings,
        testing::Contains(HasSubstr("it is not used (--sample-rate states it)")))
        << rate;
}

TEST(Csv, WhoseRateAndIntervalDisagreeSaysSo) {
  const Record record =
      imported("Sample rate,1000\nSample interval,0.01\nF [N],v [m/s]\n5,1\n4,2\n7,3\n");
  EXPECT_EQ(record.channels[0].clock.interval, 0.01);
  EXPECT_THAT(
      record.warnings,
      ElementsAre("the header states a sample interval of 0.01 s by 'Sample interval' and one "
                  "of 0.001 s by 'Sample rate': the first is used"));
}

TEST(Csv, OfAnOscilloscopeCountsSamplesAndStatesStartAndIncrement) {
  const Record record = imported(
      "X,CH1,CH2,Start,Increment,\nSequence,Volt,Volt,-3.0e-07,5.0e-10\n0,1,2,\n1,3,4,\n2,5,6,\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("CH1 [Volt]", "CH2 [Volt]"));
  EXPECT_EQ(record.channels[0].clock.start, -3e-7);
  EXPECT_EQ(record.channels[0].clock.interval, 5e-10);
  EXPECT_EQ(record.attributes.at("index column"), "X");
}

TEST(Csv, OfAnOscilloscopeMayCountFromTheMiddleOfItsRecord) {
  const Record record = imported(
      "X,CH1,CH2,Start,Increment,\nSequence,Volt,Volt,-1.4e-03,2.0e-06,\n22,1,2,\n23,3,4,\n24,5,6,"
      "\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("CH1 [Volt]", "CH2 [Volt]"));
  EXPECT_DOUBLE_EQ(record.channels[0].clock.start, -1.356e-3);
  EXPECT_EQ(record.channels[0].clock.interval, 2e-6);
  EXPECT_THAT(record.warnings,
              ElementsAre("'X' counts the samples from 22 on: the clock begins as much later than "
                          "the start in the head"));
}

TEST(Csv, MayEndWithRowsOfEmptyCells) {
  const std::string rows = "time [s],F [N],v [m/s]\n0,1,2\n1,3,4\n2,5,6\n";
  for (const std::string& end : {std::string(",,\n"), std::string(" , ,\r\n,,\n\n,,")}) {
    const Record record = imported(rows + end);
    EXPECT_THAT(record.channels[0].values(), ElementsAre(1, 3, 5)) << end;
    EXPECT_THAT(record.warnings, IsEmpty()) << end;
  }
  std::string many;  // more than is looked at for words
  for (int i = 0; i < 10000; ++i) many += ",,\n";
  EXPECT_THAT(imported(rows + many).channels[1].values(), ElementsAre(2, 4, 6));
  const Record record = imported(rows + "End of data\n,,\n");
  EXPECT_THAT(record.channels[1].values(), ElementsAre(2, 4, 6));
  EXPECT_THAT(record.warnings, ElementsAre(HasSubstr("'End of data' and what comes behind it")));
}

// As the recorder of a gas gun writes it: offsets under the units, the time last.
TEST(Csv, MayHaveOffsetsUnderItsUnits) {
  const Record record = imported(
      "C:\\shots\\test1.txt\nProgrammer - None\nStriker Velocity - -14.0\nSampling Frequency - "
      "5000\nMon, Jun 6, 2022 11:18 AM\nLow G Accel\tAccel\tPin\tTime\n"
      "Voltage (unscaled)\tVoltage (unscaled)\tVolt\tSec\n0.0 0.0 0\t\t0.0 0.0 0\t\n\n"
      "1.2E-3\t3.0E-1\t4.0E-2\t0.0E+0\n-1.2E-3\t3.1E-1\t4.1E-2\t2.0E-4\n"
      "2.4E-3\t3.2E-1\t4.2E-2\t4.0E-4\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("Low G Accel [Voltage (unscaled)]",
                                                   "Accel [Voltage (unscaled)]", "Pin [Volt]"));
  EXPECT_EQ(record.channels[0].clock.interval, 2e-4);
  EXPECT_EQ(record.attributes.at("time column"), "Time (by its name)");
  EXPECT_THAT(record.attributes.at("header"), HasSubstr("Striker Velocity - -14.0"));
  EXPECT_THAT(record.warnings, IsEmpty());
}

TEST(Csv, OfAnInfiniiVisionNumbersItsChannels) {
  const Record record = imported(
      "x-axis,1,2\nsecond,Volt,Volt\n-1.0E-03,+0.5E+00,1\n-0.9E-03,+0.6E+00,2\n-0.8E-03,0.7,3\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("CH 1 [Volt]", "CH 2 [Volt]"));
  EXPECT_EQ(record.channels[0].clock.start, -1e-3);
  EXPECT_EQ(record.channels[0].quantity, Quantity::voltage);
  EXPECT_THAT(record.warnings, IsEmpty());
}

TEST(Csv, OfASiglentHasChannelsBeforeItsKeysValues) {
  const Record record = imported(
      "Record Length,Analog:3\nSample Interval,CH1:0.000000200\nVertical Units,CH1:V\n"
      "Second,Value\n-0.0000002,0.02\n0.0,0.03\n0.0000002,0.04\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("Value [V]"));
  EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 2e-7);
  EXPECT_THAT(record.warnings, IsEmpty());
}

// Tektronix TDS1000 and TDS2000 write their settings beside the first samples.
TEST(Csv, MayHaveKeysBesideItsFirstSamples) {
  const Record record = imported(
      "Record Length,5.0e+00,,-000.5,  1.0,\nSample Interval,5.0e-01,,0000.0,  "
      "2.0,\nSource,CH1,,0.5,3.0,\n"
      "Vertical Units,V,,1.0,4.0,\nHorizontal Units,s,,1.5,5.0,\nSerial Number,,,2.0,6.0,\n"
      ",,,2.5,7.0,\n,,,3.0,8.0,\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("CH1 [V]"));
  EXPECT_THAT(record.channels[0].values(), ElementsAre(1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0));
  EXPECT_EQ(record.channels[0].clock.start, -0.5);
  EXPECT_EQ(record.channels[0].clock.interval, 0.5);
  EXPECT_EQ(record.attributes.at("Record Length"), "5.0e+00");
  EXPECT_EQ(record.attributes.at("first data line"), "1");
  EXPECT_THAT(record.warnings, IsEmpty());
}

TEST(Csv, StatedUnitsReplaceTheFiles) {
  ImportOptions options;
  options.units = {"ms", "", "N"};
  const Record record = imported("time,a [g],b\n0,1,2\n1,2,3\n", options);
  EXPECT_THAT(names_and_units(record), ElementsAre("a [g]", "b [N]"));
  EXPECT_EQ(record.channels[0].clock.interval, 1e-3);
  options.units = {"s", "N", "N", "V"};
  EXPECT_EQ(import_error("time,a,b\n0,1,2\n1,2,3\n", options),
            "FILE: 4 units are stated but the file has 3 columns");
  options.units = {"N", "mm/s"};  // which of the columns?
  EXPECT_EQ(import_error("time,a,b\n0,1,2\n1,2,3\n", options),
            "FILE: 2 units are stated but the file has 3 columns: state one for each, or nothing "
            "between two commas to leave what the file says");
}

// --- The time
// -------------------------------------------------------------------------------------

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

// --- Values
// ---------------------------------------------------------------------------------------

TEST(Csv, MissingValuesAreNanAndNotValid) {
  const Record record = imported("time [s],F [N],G [N]\n0,1,1\n1,,2\n2,NaN,3\n3,4,\n4,-1.#IND,5\n");
  const Channel& channel = record.channels[0];
  EXPECT_EQ(channel.size(), 5U);
  EXPECT_THAT(channel.valid, ElementsAre(1, 0, 0, 1, 0));
  EXPECT_TRUE(std::isnan(channel.value(1)));
  EXPECT_EQ(channel.value(3), 4.0);
  EXPECT_THAT(record.channels[1].valid, ElementsAre(1, 1, 1, 0, 1));
  EXPECT_THAT(record.warnings,
              ElementsAre(HasSubstr(":3:3 (byte 29); marked as not valid"),
                          HasSubstr("'G': 1 of 5 values is missing, the first at ")));
}

TEST(Csv, InfiniteValuesAreMarked) {
  const Record record = imported("time [s],F [N]\n0,1\n1,inf\n2,-Infinity\n3,4\n");
  EXPECT_THAT(record.channels[0].valid, ElementsAre(1, 0, 0, 1));
  EXPECT_THAT(
      record.warnings,
      ElementsAre(
          "'F': 2 of 4 samples are not finite, the first is sample 1; marked as not valid"));
}

TEST(Csv, WhatMetersShowForNoValueIsMissing) {
  const Record record = imported("time [s],F [N]\n0,1\n1,N/A\n2,n/a\n3,OL\n4,-\n5,\u22122.5\n");
  EXPECT_THAT(record.channels[0].valid, ElementsAre(1, 0, 0, 0, 0, 1));
  EXPECT_EQ(record.channels[0].value(5), -2.5);
  EXPECT_THAT(record.warnings, ElementsAre(HasSubstr("'F': 4 of 6 values are missing")));
}

// PicoScope writes the infinity sign for a sample beyond the range.
TEST(Csv, SamplesBeyondTheRangeAreMarked) {
  const Record record = imported(
      "Time,Channel A\n(ms),(V)\n\n-1.0,0.5\n-0.5,\u221E\n0.0,-\u221E\n0.5,\u2212\u221E\n");
  EXPECT_THAT(record.channels[0].valid, ElementsAre(1, 0, 0, 0));
  EXPECT_THAT(record.warnings, ElementsAre(HasSubstr("3 of 4 samples are not finite")));
}

TEST(Csv, AColumnThatIsNamedButEmptyIsAnEmptyChannel) {
  for (const char* text :
       {"time [s],F [N],G [N]\n0,1\n1,2\n", "time [s],F [N],G [N]\n0,1,\n1,2,\n"}) {
    const Record record = imported(text);
    ASSERT_EQ(record.channels.size(), 2U);
    EXPECT_EQ(record.channels[1].size(), 0U);
    EXPECT_EQ(record.channels[1].name, "G");
    EXPECT_THAT(record.warnings, ElementsAre(HasSubstr("'G' ")));
  }
}

TEST(Csv, CommentsAndEmptyLinesBetweenRowsAreSkipped) {
  EXPECT_THAT(imported("t,F\n0,1\n# pause\n\n1,2\n% again\n2,3\n").channels[0].values(),
              ElementsAre(1.0, 2.0, 3.0));
}

TEST(Csv, ATextForANumberIsAnErrorThatNamesPlaceAndColumn) {
  EXPECT_EQ(import_error("time [s],velocity [m/s]\n0,1\n1,bad\n2,3\n"),
            "FILE:3:3 (byte 30): velocity: expected a number, found 'bad'");
  EXPECT_EQ(import_error("time [s],velocity [m/s]\n0,bad\n1,bad\n2,3\n3,4\n"),
            "FILE:2:3 (byte 26): velocity: expected a number, found 'bad'");
  EXPECT_EQ(import_error("time [s],velocity [m/s]\n0,1\n1,2\n2,3e999\n"),
            "FILE:4:3 (byte 34): velocity: 3e999 does not fit a double");
  EXPECT_EQ(import_error("time [s],velocity [m/s]\n0,1\n1,2.5.1\n2,3\n"),
            "FILE:3:3 (byte 30): velocity: expected a number, found '2.5.1'");
}

TEST(Csv, WhatInstrumentsWriteBeyondTheirRangeIsMissing) {
  for (const char* mark : {"OVL", "+Over", "-Overload", "Ovfl", "over range", "---", "#####",
                           "*****", "\"OVL\"", "#NV", "NULL"}) {
    const Record record = imported(
        fmt::format("t [s],F [N],v [m/s]\n0,1,2\n1,2,3\n2,{},4\n3,{},5\n4,5,6\n", mark, mark));
    ASSERT_EQ(record.channels.size(), 2U) << mark;
    EXPECT_EQ(record.channels[0].size(), 5U);
    for (std::size_t i = 0; i < 5; ++i)
      EXPECT_EQ(record.channels[0].is_valid(i), i != 2 && i != 3) << mark << i;
    EXPECT_THAT(record.warnings,
                testing::Contains(testing::AllOf(
                    HasSubstr(fmt::format(
                        "'F': 2 of 5 values are missing, the first, written '{}', at ", mark)),
                    HasSubstr(":4:3 (byte 34); marked as not valid"))))
        << mark;
  }
}

TEST(Csv, WordsAndStatisticsBehindTheRowsAreLeftOut) {
  const std::string rows = "t [s],F [N]\n0,1\n1,2\n2,3\n";
  for (const auto& [behind, found] : {std::pair{"End of data\n", "End of data"},
                                      {"\n\nMax,3\nMin,1\n", "Max,3"},
                                      {"# note\n[Footer]\nSerial=4711", "[Footer]"}}) {
    const Record record = imported(rows + behind);
    EXPECT_THAT(record.channels[0].values(), ElementsAre(1.0, 2.0, 3.0)) << behind;
    EXPECT_THAT(record.warnings,
                testing::Contains(testing::AllOf(HasSubstr("no rows follow at "),
                                                 HasSubstr(fmt::format("'{}'", found)))))
        << behind;
  }
  // rows go on: words between them are none of these, nor is half a number
  EXPECT_THAT(import_error(rows + "pause,\n3,4\n"), HasSubstr("expected a number, found 'pause'"));
  EXPECT_THAT(import_error(rows + "3..1,4\n"), HasSubstr("expected a number, found '3..1'"));
}

TEST(Csv, RowsOfTheWrongLengthAreErrors) {
  EXPECT_EQ(import_error("t,a,b\n0,1,2\n1,2,3\n2,3\n3,4,5\n"),
            "FILE:4:1 (byte 18): the row has 2 cells, expected 3 (b is missing)");
  EXPECT_EQ(import_error("t,a\n0,1\n1,2\n2,3,4\n3,4\n"),
            "FILE:4:5 (byte 16): the row goes on with '4' after its 2 cells");
}

TEST(Csv, RowsOfTheWrongLengthAboveTheOthersAreErrorsToo) {
  EXPECT_EQ(import_error("Time [s],Force [N]\n0.000,1.4\n0.001\n0.002,1.7\n0.003,1.8\n0.004,2\n"),
            "FILE:3:1 (byte 29): the row has 1 cell, expected 2 (Force is missing)");
  EXPECT_EQ(import_error("Time [s],F [N],v [m/s]\n0.000,1.4\n0.001,1.5,2\n0.002,1.7,3\n"),
            "FILE:2:1 (byte 23): the row has 2 cells, expected 3 (v is missing)");
  EXPECT_EQ(import_error("Time [s],Force [N]\n0.000,1.4\n0.001,,ERR\n0.002,1.7\n0.003,1.8\n"),
            "FILE:3:8 (byte 36): the row goes on with 'ERR' after its 2 cells");
  EXPECT_EQ(import_error("t [s],a [N],b [m/s]\n0.000,1,2\n0.001,2\n0.002,3\n0.003,4\n"),
            "FILE:2:9 (byte 28): the row goes on with '2' after its 2 cells");
  EXPECT_EQ(import_error("Time [s];Force [N];;fs\n0,000;1,5;;1000\n0,001;1,6\n0,002;1,7\n"),
            "FILE:2:12 (byte 34): the row goes on with '1000' after its 2 cells");
  // without names there must be a row as long as the others above the wrong one: what is alone in
  // its shape may be a count of rows
  EXPECT_EQ(import_error("0.000,1.4\n0.001\n0.002,1.7\n0.003,1.8\n"),
            "FILE:2:1 (byte 10): the row has 1 cell, expected 2 (column 1 is missing)");
  EXPECT_EQ(imported("4000\n0.002,1.7\n0.003,1.8\n").channels[0].size(), 2U);
}

TEST(Csv, WithThousandsSeparatorsIsAnErrorThatSaysSo) {
  const std::string hint = ": it seems to have thousands separators, which are not read";
  for (const char* cell : {"1 234,5", "1.234,5", "1\u00A0234,5", "1\u202F234,5"})
    EXPECT_EQ(
        import_error(fmt::format("Zeit [s];Kraft [N]\n0,000;1,5\n0,001;2,5\n0,002;{}\n", cell)),
        fmt::format("FILE:4:7 (byte 45): Kraft: expected a number, found '{}'{}", cell, hint));
  for (const char* row : {"0.000,\"1,234.5\"", "0.000;1,234.5", "0.000;1'234.5", "0,000;1 234,5",
                          "0.000,1 234.5", "0,000\t1 234,5"}) {
    const std::string_view text(row);
    const std::size_t at = text.find_first_of("\"1");
    EXPECT_EQ(import_error(fmt::format(
                  "{}\n{}\n{}\n", "Time [s]" + std::string(1, row[5]) + "Force [N]", row, row)),
              fmt::format("FILE:2:{} (byte {}): '{}'{}", at + 1 + (row[at] == '"' ? 1 : 0),
                          19 + at + (row[at] == '"' ? 1 : 0),
                          text.substr(at).find('"') == 0 ? "1,234.5" : text.substr(at), hint))
        << row;
  }
  for (const char* rows : {"0.000,1,234\n0.001,2,345\n", "0.000,1,234.5\n0.001,2,345.5\n",
                           "0.000,999\n0.001,2,345\n0.002,3,456\n"})
    EXPECT_THAT(
        import_error(std::string("Time [s],Force [N]\n") + rows),
        HasSubstr(
            "the row has 3 cells under the 2 names of line 1: commas may be thousands "
            "separators, which are not read (--delimiter , takes each for the end of a cell)"));
  EXPECT_EQ(import_error("Time [s],Force [N]\n0.000,1.0\n0.001,2.0\n0.002,1,000.5\n"),
            "FILE:4:9 (byte 47): the row goes on with '000.5' after its 2 cells: commas may be "
            "thousands separators, which are not read");
  EXPECT_EQ(import_error("1.5\n2.5\n2,345.5\n4.5\n"),
            "FILE:3:3 (byte 10): the row goes on with '345.5' after its 1 cell: commas may be "
            "thousands separators, which are not read");
}

TEST(Csv, CommasUnderFewerNamesAreDecimalMarksOrAnError) {
  ImportOptions options;
  options.sample_rate = 1000.0;
  const Record record = imported("Kraft [N]\n1,5\n1,6\n1,7\n", options);
  EXPECT_THAT(names_and_units(record), ElementsAre("Kraft [N]"));
  EXPECT_THAT(record.channels[0].values(), ElementsAre(1.5, 1.6, 1.7));
  EXPECT_EQ(
      import_error("Kraft\n1,5\n1,6\n", options),
      "FILE:2:1 (byte 6): the row has 2 cells under the one name of line 1: commas may be "
      "decimal marks (--decimal , reads them so; --delimiter , takes each for the end of a cell)");
  EXPECT_EQ(
      import_error("Zeit [s],Kraft [N]\n0,000,1,5\n0,001,1,6\n"),
      "FILE:2:1 (byte 19): the row has 4 cells under the 2 names of line 1: commas may be "
      "decimal marks too, which is not read (--delimiter , takes each for the end of a cell)");
  options.delimiter = ',';
  EXPECT_EQ(imported("Kraft\n1,5\n1,6\n", options).channels.size(), 2U);
  options.delimiter.reset();
  options.decimal = ',';
  EXPECT_EQ(imported("Kraft\n1,5\n1,6\n", options).channels.size(), 1U);
}

TEST(Csv, LeavesAColumnOfTextOut) {
  const char* const warning = "'Comment' holds text ('start of test'), no numbers: it is left out";
  for (const char* text :
       {"Time [s],Force [N],Comment\n0.000,1.5,start of test\n0.001,1.6\n0.002,1.7\n",
        "Time [s],Force [N],Comment\n0.000,1.5\n0.001,1.6,start of test\n0.002,1.7,end\n",
        "Time [s],Comment,Force [N]\n0.000,start of test,1.5\n0.001,,1.6\n0.002,,1.7\n"}) {
    const Record record = imported(text);
    EXPECT_THAT(names_and_units(record), ElementsAre("Force [N]")) << text;
    EXPECT_THAT(record.channels[0].values(), ElementsAre(1.5, 1.6, 1.7)) << text;
    EXPECT_EQ(record.channels[0].clock.interval, 1e-3);
    EXPECT_THAT(record.warnings, ElementsAre(warning)) << text;
  }
  ImportOptions options;
  options.time_column = "Comment";
  EXPECT_EQ(import_error("Force [N],Comment\n1.5,start\n1.6,\n1.7,\n", options),
            "FILE: the column 'Comment' holds text, not the time");
}

TEST(Csv, ARowCutOffByTheEndOfTheFileIsLeftOut) {
  const Record record = imported("t,a,b\n0,1,2\n1,2,3\n2,");
  EXPECT_THAT(record.channels[1].values(), ElementsAre(2.0, 3.0));
  EXPECT_THAT(record.channels[0].values(), ElementsAre(1.0, 2.0));
  EXPECT_THAT(record.warnings, testing::Contains(HasSubstr("the file ends within the row at ")));
}

// 2.5 may be what is left of 2.534: all numbers above it have three decimals.
TEST(Csv, ALastNumberThatMayBeCutIsToldOf) {
  const auto told = [](const std::string& rows) {
    std::string found;
    for (const std::string& warning : imported("t [s];F [N]\n" + rows).warnings)
      if (warning.find("may be cut off") != std::string::npos) found = warning;
    return found;
  };
  const std::string rows = "0,0;1,125\n0,1;-12,250\n0,2;2,500\n";
  EXPECT_EQ(told(rows + "0,3;2,5"),
            "the file ends without a line end, and its last number '2,5' has fewer digits than "
            "those above it: it may be cut off");
  EXPECT_NE(told(rows + "0,3;2"), "");
  EXPECT_EQ(told(rows + "0,3;2,534"), "");
  EXPECT_EQ(told(rows + "0,3;2,5\n"), "");
  EXPECT_EQ(told("0,0;1,125\n0,1;-12,25\n0,2;2,500\n0,3;2,5"), "");  // digits as there are
  EXPECT_EQ(told("0,0;1\n0,1;-12\n0,2;25\n0,3;2"), "");
}

TEST(Csv, MayHaveACommentSignAloneAboveItsRows) {
  for (const char* line : {"#", "%", "##", "# "})
    EXPECT_THAT(imported(std::string(line) + "\n0,1\n1,2\n2,3\n").channels[0].values(),
                ElementsAre(1.0, 2.0, 3.0));
}

TEST(Csv, WithoutNumbersIsAnError) {
  EXPECT_EQ(import_error("", {}, ".csv"), "FILE: the file is empty");
  EXPECT_EQ(import_error(" \n\n", {}, ".csv"), "FILE: there is no text in this file");
  EXPECT_EQ(import_error("time,force\n", {}, ".csv"),
            "FILE: no row of numbers among the first 1 line: expected columns of numbers "
            "(--delimiter, --decimal and "
            "--skip-lines state how they are written)");
}

TEST(Csv, OfOneRowIsARecording) {
  const Record record = imported("time [s],F [N]\n0.5,7\n");
  EXPECT_THAT(record.channels[0].values(), ElementsAre(7.0));
  EXPECT_THAT(record.warnings,
              ElementsAre("there is one sample only: the sample interval is not known"));
}

TEST(Csv, OfOneRowHasTheIntervalThatItsHeadStates) {
  const Record record = imported("# sample interval: 1e-5 s\ntime [s],F [N]\n0.5,7\n");
  EXPECT_EQ(record.channels[0].clock.start, 0.5);
  EXPECT_EQ(record.channels[0].clock.interval, 1e-5);
  EXPECT_THAT(record.warnings, testing::IsEmpty());
}

TEST(Csv, OfManyRowsIsReadWhole) {
  std::string text = "time [s],F [N]\n";
  for (int i = 0; i < 100000; ++i) text += fmt::format("{},{}\n", i * 1e-6, i % 1000);
  const Record record = imported(text);
  EXPECT_EQ(record.channels[0].size(), 100000U);
  EXPECT_EQ(record.channels[0].value(99999), 999.0);
  EXPECT_EQ(record.channels[0].clock.interval, 1e-6);
}

// --- Polytec
// --------------------------------------------------------------------------------------

const std::string polytec_head =
    "Source File Name:\tScan\r\nPoint Index:\t3\r\nComponent:\tRoot\r\n";

TEST(PolytecAscii, TakesItsQuantityFromTheUnitOrTheSignal) {
  const Record record =
      imported(polytec_head +
               "Signal:\tTime - Vib Velocity - Samples\r\n\r\nTime\tTime Signal\r\n"
               "[ s ]\t[ mm/s ]\r\n0\t1.5\r\n0.5\t2.5\r\n1\t3.5\r\n");
  EXPECT_EQ(record.provenance.importer, "polytec-ascii");
  EXPECT_THAT(names_and_units(record), ElementsAre("Time Signal [mm/s]"));
  EXPECT_EQ(record.channels[0].quantity, Quantity::velocity);
  EXPECT_EQ(record.channels[0].clock.interval, 0.5);
  EXPECT_EQ(record.channels[0].attributes.at("signal"), "Vib Velocity");
  EXPECT_EQ(record.channels[0].attributes.at("display"), "Samples");
  EXPECT_EQ(record.attributes.at("Point Index"), "3");
  EXPECT_EQ(record.title, "Vib Velocity");
  EXPECT_THAT(record.warnings, IsEmpty());
  const Record odd = imported(
      "Signal:\tTime - Vib Velocity - Samples\nTime\tTime Signal\n[ s ]\t[ gizmo ]\n0\t1\n1\t2\n");
  EXPECT_EQ(odd.channels[0].quantity, Quantity::velocity);
}

TEST(PolytecAscii, MayHaveSeveralColumnsAndDecimalCommas) {
  const Record record = imported(
      "Signal:\tTime - Vib 3D Velocity - Samples\n\nTime\tX\tY\tZ\n[ ms ]\t[ m/s ]\t[ m/s ]\t[ m/s "
      "]\n"
      "0\t1,5\t2\t3\n0,5\t2,5\t3\t4\n1\t3,5\t4\t\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("X [m/s]", "Y [m/s]", "Z [m/s]"));
  EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 0.5e-3);
  EXPECT_THAT(record.channels[0].values(), ElementsAre(1.5, 2.5, 3.5));
  EXPECT_THAT(record.channels[2].valid, ElementsAre(1, 1, 0));
  EXPECT_THAT(record.warnings,
              ElementsAre(HasSubstr("'Z': 1 of 3 values is missing, the first at ")));
}

TEST(PolytecAscii, OfASpectrumHasNoClock) {
  const Record record = imported(
      "Signal:\tFFT - Vib Velocity - Real & Imag.\n\nFrequency\tReal\tImaginary\n"
      "[ Hz ]\t[ m/s ]\t[ m/s ]\n10\t1\t2\n12.5\t2\t3\n15\t3\t4\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("Real [m/s]", "Imaginary [m/s]"));
  EXPECT_EQ(record.channels[0].clock.interval, 0.0);
  EXPECT_EQ(record.channels[0].attributes.at("domain"), "frequency");
  EXPECT_EQ(record.channels[0].attributes.at("abscissa first"), "10");
  EXPECT_EQ(record.channels[0].attributes.at("abscissa increment"), "2.5");
  EXPECT_THAT(record.warnings,
              ElementsAre("this is no time record: 'Vib Velocity' over Frequency [Hz]"));
}

TEST(PolytecAscii, WithUnevenFrequenciesBringsThemAsAChannel) {
  const Record record = imported(
      "Signal:\tOctave - Vib Velocity - Magnitude\nFrequency\tMagnitude\n[ Hz ]\t[ m/s "
      "]\n1\t1\n2\t2\n4\t3\n8\t4\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("Frequency [Hz]", "Magnitude [m/s]"));
  EXPECT_THAT(record.channels[0].values(), ElementsAre(1.0, 2.0, 4.0, 8.0));
}

TEST(PolytecAscii, WithoutItsUnitLineIsAnError) {
  EXPECT_EQ(import_error(polytec_head +
                         "Signal:\tTime - Vib Velocity - Samples\nTime\tTime Signal\n0\t1\n"),
            "FILE: this is a Polytec text export without its line of units: expected a line such "
            "as '[ s ] [ m/s ]' under the "
            "column names");
}

}  // namespace
}  // namespace impactrig::acquisition
