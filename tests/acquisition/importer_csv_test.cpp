// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gmock/gmock.h>

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
  EXPECT_EQ(divided("Force_N"), "Force_N|N");
  EXPECT_EQ(divided("Force_V"), "Force_V|");
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
      ElementsAre("the header states a sample interval of 0.0005 s but the time column steps "
                  "by 0.001 s: the time column is used"));
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
  for (const char* rate : {"\"51,200\"", "51,2 kHz", "fast", "3 apples"})
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

}  // namespace
}  // namespace impactrig::acquisition
