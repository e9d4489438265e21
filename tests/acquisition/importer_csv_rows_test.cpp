// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>

#include "acquisition/importer.hpp"
#include "acquisition/importers/formats.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Channel;
using datasets::Record;
using testing::ElementsAre;
using testing::HasSubstr;
using tests::import_error;
using tests::imported;
using tests::names_and_units;

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
  const auto record = imported("t,F\n0,1\n# pause\n\n1,2\n% again\n2,3\n");
  EXPECT_THAT(record.channels[0].values(), ElementsAre(1.0, 2.0, 3.0));
  EXPECT_THAT(record.warnings,
              testing::Contains(testing::AllOf(testing::HasSubstr("stand between the rows"),
                                               testing::HasSubstr(":3:1 (byte 8): '# pause'"))));
  EXPECT_THAT(imported("t,F\n0,1\n\n1,2\n# end\n").warnings,
              testing::Not(testing::Contains(testing::HasSubstr("between the rows"))));
}

// One under the other: 't' and 'force' would be one channel.
// A row that is spoilt stands first and is longer than the others: its date is in none of their
// columns (found by fuzzing).
TEST(Csv, ADateBeyondTheColumnsIsNone) {
  using namespace std::string_literals;
  ImportOptions options;
  options.format = "csv";
  const std::string bytes =
      "S>tamp SStamp State /\n31F/\xf8"s + "2024ate /\n31F/\xf8"s +
      "2024 11tate F\n3\xff\xff\xff&/\0?2024 111:59:59.9 PM 1\n3\0A/20~4 12:0\x98\0\0\0\0\0\0\0"s +
      "0:59\n3.1 1 A\xcd 59:59.9 PM 1\n3\0A/2024 12:?2\nAM 2\n"s;
  EXPECT_THAT(import_error(bytes, options), HasSubstr("the row goes on with"));
}

TEST(Csv, OctavesVariableHasItsName) {
  const std::string head = "# Created by Octave 8.4.0, Mon Sep 28 12:00:00 2026 UTC <a@b>\n";
  const Record record =
      imported(head + "# name: force_N\n# type: matrix\n# rows: 3\n# columns: 1\n 0\n 0.5\n 0.7\n");
  ASSERT_EQ(record.channels.size(), 1U);
  EXPECT_EQ(record.channels[0].name, "force_N");
  EXPECT_THAT(
      import_error(head + "# name: s\n# type: sparse matrix\n# nnz: 2\n# rows: 3\n# columns: 3\n"
                          "1 1 0.5\n2 2 0.7\n"),
      HasSubstr("a sparse matrix is no recording"));
}

TEST(Csv, OctavesVariablesAreReadOneAFile) {
  const std::string head = "# Created by Octave 7.3.0, Sat Nov 28 06:51:30 2026 UTC <a@b>\n";
  const std::string t = "# name: t\n# type: matrix\n# rows: 3\n# columns: 1\n 0\n 1\n 2\n\n\n";
  const std::string force =
      "# name: force\n# type: matrix\n# rows: 3\n# columns: 2\n 0 5\n 1 6\n 2 8\n\n\n";
  EXPECT_THAT(tests::import_error(head + t + force),
              testing::HasSubstr("another variable begins here"));
  // numbers above would be its first samples
  const std::string fs = "# name: fs\n# type: scalar\n51200\n\n\n";
  const std::string row = "# name: F\n# type: matrix\n# rows: 1\n# columns: 3\n 5.5 6.5 8.5\n\n\n";
  EXPECT_THAT(tests::import_error(head + fs + row),
              testing::HasSubstr("another variable begins here"));
  EXPECT_THAT(imported(head + force).channels.back().values(), ElementsAre(5.0, 6.0, 8.0));
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
  // the second block of an MTS file
  EXPECT_THAT(import_error(rows + "Data Acquisition,\nt,F\ns,N\n5,6\n6,7\n"),
              HasSubstr("found 'Data Acquisition': does another table begin here? Keep one in a "
                        "file"));
  EXPECT_THAT(import_error(rows + "Data Acquisition,,Time:,8\n5,6\n6,7\n"),
              HasSubstr("does another table begin here?"));
}

// A summary of two rows above the course, and another below.
TEST(Csv, OfSeveralTablesOfATestingMachineTheLargestIsRead) {
  const std::string first = "MTS793|MPT|ENU|1|2|.|/|:|1|0|0|A\n\n",
                    begin = "Data Acquisition\t\t\tTime:\t137.65723\ts\t03/05/2024 10:03:10 AM\n",
                    summary = begin + "Axial Force\tStroke\nkN\tmm\n2.5\t4.5\n-933.5\t-1.5\n\n",
                    course = begin +
                             "Running Time\tAxial Force\tStroke\ns\tkN\tmm\n0.1\t5\t1\n"
                             "0.2\t6\t2\n0.3\t7\t3\n";
  for (const std::string& file : {first + summary + course, first + course + "\n" + summary,
                                  first + summary + course + "\n" + summary}) {
    const Record record = imported(file);
    ASSERT_EQ(record.channels.size(), 2U) << file;
    EXPECT_EQ(record.channels[0].name, "Axial Force");
    EXPECT_EQ(record.channels[0].unit, "kN");
    EXPECT_THAT(record.channels[0].values(), ElementsAre(5, 6, 7));
    EXPECT_NEAR(record.channels[0].clock.interval, 0.1, 1e-12);
    EXPECT_THAT(record.warnings, testing::Contains(HasSubstr("left out")));
  }
  ImportOptions options;
  options.skip_lines = 0;
  const Record record = imported(first + summary + course, options);
  ASSERT_EQ(record.channels.size(), 2U);
  EXPECT_THAT(record.channels[0].values(), ElementsAre(2.5, -933.5));
}

// As testing machines of MTS write their names and units every so often.
TEST(Csv, AHeadThatStandsAgainIsPassedOver) {
  const std::string head =
      "Data Header:\t\tTime:\t20.02\ts\nStation Name:\tft40.cfg\nRunning Time\tForce\ns\tN\n";
  const Record record =
      imported(head + "0.1\t1\n0.2\t2\n\n" + head + "0.3\t3\n0.4\t4\n" + head + "0.5\t5\n");
  ASSERT_EQ(record.channels.size(), 1U);
  EXPECT_THAT(record.channels[0].values(), ElementsAre(1, 2, 3, 4, 5));
  EXPECT_NEAR(record.channels[0].clock.interval, 0.1, 1e-12);
  EXPECT_THAT(record.warnings, testing::Contains(HasSubstr(
                                   ":8:1 (byte 87) on ('Data Header:  Time: 20.02 s'): the rows "
                                   "are read as one table")));
}

TEST(Csv, RemarksBehindRowsAreLeftOut) {
  const Record record = imported("t\ta\n0\t1\n1\t2\t#* hit\n2\t3\n3\t4\t#* rebound\n");
  EXPECT_THAT(record.channels[0].values(), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(record.warnings,
              testing::Contains(HasSubstr("remarks behind rows are left out, the first at ")));
  EXPECT_THAT(record.warnings, testing::Contains(HasSubstr(":3:5 (byte 12): '#* hit'")));
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

TEST(Csv, ThousandsSeparatorsThatCanBeNothingElseAreRead) {
  for (const char* cell : {"1 234,5", "1.234,5", "1\u00A0234,5", "1\u202F234,5", "\"1.234,5\""})
    EXPECT_THAT(imported(fmt::format("Zeit [s];Kraft [N]\n0,000;1,5\n0,001;2,5\n0,002;{}\n", cell))
                    .channels[0]
                    .values(),
                ElementsAre(1.5, 2.5, 1234.5))
        << cell;
  for (const char* cells :
       {"0.000,\"1,234.5\"\n0.001,\"-1,234,567.0\"", "0.000;1,234.5\n0.001;-1,234,567.0",
        "0.000;1'234.5\n0.001;-1'234'567", "0,000;1 234,5\n0,001;-1 234 567",
        "0.000,1 234.5\n0.001,-1 234 567", "0,000\t1 234,5\n0,001\t-1 234 567"})
    EXPECT_THAT(
        imported(fmt::format("Time [s]{}Force [N]\n{}\n", cells[5], cells)).channels[0].values(),
        ElementsAre(1234.5, -1234567.0))
        << cells;
}

TEST(Csv, BlanksBetweenDecimalCommasAreNoThousandsSeparators) {
  const Record record = imported("0,500 100,125\n0,750 101,250\n1,000 102,375\n1,250 103,500\n");
  EXPECT_THAT(record.channels[0].values(), ElementsAre(100.125, 101.25, 102.375, 103.5));
  EXPECT_THAT(import_error("1,250 100,125\n1,500 101,250\n1,750 102,375\n"),
              HasSubstr("it may have thousands separators or decimals"));
}

TEST(Csv, ThousandsSeparatorsThatMayBeDecimalMarksAreErrors) {
  EXPECT_EQ(import_error("Zeit [s];Kraft [N]\n0,000;1,5\n0,001;2,5\n0,002;1.234\n"),
            "FILE:4:7 (byte 45): Kraft: expected a number, found '1.234': it may have thousands "
            "separators or decimals, and the file's others do not tell which");
  for (const char* row : {"0.000;1,234", "0,000\t1.234"})
    EXPECT_THAT(import_error(fmt::format("Time [s]{0}Force [N]\n{1}\n{1}\n", row[5], row)),
                HasSubstr("it may have thousands separators or decimals"))
        << row;
  EXPECT_THAT(import_error("Zeit [s];Kraft [N]\n0,000;1,5\n0,001;2,5\n0,002;192.168.100\n"),
              HasSubstr("it may have thousands separators or decimals"));
  EXPECT_THAT(import_error("Zeit [s];Kraft [N]\n0,000;1,5\n0,001;2,5\n0,002;12.34,5\n"),
              HasSubstr("expected a number, found '12.34,5'"));
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

// What is left of 2.5e-3.
TEST(Csv, ARowWhoseLastNumberLacksDigitsIsLeftOut) {
  for (const char* const rest : {"2.5e-", "2.5e", "2.5E+", "."}) {
    SCOPED_TRACE(rest);
    const Record record = imported("t [s],F [N]\n0,1e-3\n1,2.5e-3\n2," + std::string(rest));
    EXPECT_THAT(record.channels.at(0).values(), ElementsAre(1e-3, 2.5e-3));
    EXPECT_THAT(record.warnings, testing::Contains(HasSubstr("the file ends within the row at ")));
  }
  EXPECT_THAT(import_error("t [s],F [N]\n0,1e-3\n1,2.5e-\n"),
              HasSubstr("F: expected a number, found '2.5e-'"));
  EXPECT_THAT(import_error("t [s],F [N]\n0,1e-3\n1,2.5x"),
              HasSubstr("F: expected a number, found '2.5x'"));
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
  EXPECT_THAT(told(rows + "0,3;2,5"),
              testing::MatchesRegex(
                  "the file ends without a line end, and its last number '2,5' "
                  "has fewer digits than those above it, or no mark behind it as they have: it "
                  "may be cut off, and the row at .*:5:1 \\(byte 44\\) is left out"));
  EXPECT_EQ(imported("t [s];F [N]\n" + rows + "0,3;2,5").channels.at(0).size(), 3U);
  EXPECT_NE(told(rows + "0,3;2"), "");
  EXPECT_EQ(told(rows + "0,3;2,534"), "");
  EXPECT_EQ(told(rows + "0,3;2,5\n"), "");
  EXPECT_EQ(told("0,0;1,125\n0,1;-12,25\n0,2;2,500\n0,3;2,5"), "");  // digits as there are
  EXPECT_EQ(told("0,0;1\n0,1;-12\n0,2;25\n0,3;2"), "");
}

// A volt that was a microvolt, among numbers whose zeros are left off.
TEST(Csv, ALastNumberThatLacksItsExponentIsNone) {
  const std::string rows = "t [s],V [V]\n0,1.8874e-06\n1,-8.65e-06\n2,2.34578e-06\n";
  for (const char* cut : {"3,7.424462e-0", "3,7.424462", "3,7"}) {
    const Record record = imported(rows + cut);
    EXPECT_EQ(record.channels.at(0).size(), 3U) << cut;
    EXPECT_THAT(record.warnings, testing::Contains(HasSubstr("may be cut off")));
  }
  EXPECT_EQ(imported(rows + "3,7.4e-06").channels.at(0).size(), 4U);
  for (const char* whole : {"3,0", "3,0.0", "3,NaN", "3,OVL"})
    EXPECT_EQ(imported(rows + whole).channels.at(0).size(), 4U) << whole;
  EXPECT_EQ(imported("Record Length,4\n" + rows + "3,7.4").channels.at(0).size(), 4U);
  // among numbers of which few have exponents it is one ten times as large as all
  const std::string mixed = "t [s],V [V]\n0,0.012345\n1,-8.65e-05\n2,0.0023457\n";
  EXPECT_EQ(imported(mixed + "3,-8.12345").channels.at(0).size(), 3U);
  EXPECT_EQ(imported(mixed + "3,0.05").channels.at(0).size(), 4U);
}

// Rigol's rows end with a comma, and have two decimals.
TEST(Csv, ALastNumberThatLacksWhatEndsItsRowIsNone) {
  const std::string rigol = "t [s],V [V]\n0.0,4.40,\n0.1,4.32,\n0.2,4.40,\n";
  EXPECT_EQ(imported(rigol + "0.3,4.").channels.at(0).size(), 3U);
  EXPECT_EQ(imported(rigol + "0.3,4.40").channels.at(0).size(), 3U);
  EXPECT_EQ(imported(rigol + "0.3,4.40,").channels.at(0).size(), 4U);
  const std::string fixed = "t [s],V [V]\n0.0,0.08\n0.1,0.16\n0.2,0.16\n";
  for (const char* cut : {"0.3,0.", "0.3,0.0"})
    EXPECT_EQ(imported(fixed + cut).channels.at(0).size(), 3U) << cut;
  EXPECT_EQ(imported(fixed + "0.3,0").channels.at(0).size(), 4U);
}

// By its head, as oscilloscopes state it.
TEST(Csv, FewerRowsThanAnnouncedAreTold) {
  const std::string rows = "t [s],V [V]\n0,1\n1,2\n2,3\n";
  for (const char* key :
       {"Record Length,5", "Points:,5\nSample interval,1", "Size,5\nSample interval,1",
        "BlockSize,5,5", "Record Length,Analog:5,Digital:0", "Segments,1,SegmentSize,5"}) {
    EXPECT_THAT(imported(std::string(key) + "\n" + rows).warnings,
                testing::Contains(HasSubstr("the header announces 5 samples")))
        << key;
    std::string enough = key;
    enough.replace(enough.find('5'), 1, "3");
    EXPECT_THAT(imported(enough + "\n" + rows).warnings,
                testing::Not(testing::Contains(HasSubstr("announces"))));
  }
  const tests::WrittenFile file("Record Length,5\n" + rows);
  EXPECT_THAT(read_into_memory(*open_csv_by_blocks(file.path(), {}), {}).warnings,
              testing::Contains(HasSubstr("the header announces 5 samples")));
}

// Excel's, in English and in German: 1153 was read as 1.153.
TEST(Csv, ThousandsSeparatorsThatLookLikeDecimalsAreAnError) {
  EXPECT_THAT(import_error("t [ms];F [N]\n0;12\n1;850\n2;1.153\n3;9.876\n4;10.250\n5;3\n"),
              HasSubstr(":6:3 (byte 42): F: '10.250' may have thousands separators"));
  EXPECT_THAT(
      import_error("t [ms]\tF [N]\n0\t12\n1\t\"1,153\"\n2\t\"9,876\"\n3\t\"10,250\"\n4\t9\n"),
      HasSubstr("F: '10,250' may have thousands separators"));
  EXPECT_THAT(import_error("F [N]\n12\n850\n1.153\n2.468\n9.870\n3\n"),
              HasSubstr("'9.870' may have thousands separators"));
  // decimals: of another number, a zero before the mark, a number of 1000, no whole ones
  for (const char* row : {"7;1.25", "7;0.125", "7;1000", "7;1e3"})
    EXPECT_EQ(
        imported("t [ms];F [N]\n0;12\n1;850\n2;1.153\n3;9.876\n" + std::string(row) + "\n8;2.250\n")
            .channels.at(0)
            .value(2),
        1.153)
        << row;
  EXPECT_EQ(imported("t [ms];F [N]\n0;1.153\n1;9.870\n2;3.125\n").channels.at(0).value(1), 9.87);
  EXPECT_EQ(imported("t [s],F [N]\n0.0000,1.153\n0.0001,9.870\n0.0002,3.125\n0.0003,0\n")
                .channels.at(0)
                .value(1),
            9.87)
      << "the mark is a decimal one in the other column";
  ImportOptions decimals;
  decimals.decimal = '.';
  EXPECT_EQ(imported("F [N]\n12\n850\n1.153\n9.870\n2.468\n3\n", decimals).channels.at(0).value(3),
            9.87);
  // many of three digits, as one in ten rounded ones would have fewer
  // thirds of a step of 1 are no thousands, nor are a few levels
  std::string thirds = "t [ms],F [N]\n";
  for (int i = 0; i < 200; ++i)
    thirds += fmt::format(
        "{},{}\n",
        i % 3 == 0 ? fmt::format("{}", 100 + i / 3) : fmt::format("{:.3f}", 100.0 + i / 3.0),
        i % 2 == 0 ? "1.250" : "1");
  EXPECT_EQ(imported(thirds).channels.at(0).size(), 200U);
  std::string many = "F [N]\n12\n";
  for (int i = 0; i < 60; ++i) many += fmt::format("{}.{}\n", 1 + i % 9, 101 + 7 * i);
  EXPECT_THAT(import_error(many), HasSubstr("may have thousands separators"));
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

TEST(Selection, HasAChannelOnceByNameAndByIndex) {
  const tests::WrittenFile file("t [s],F [N],v [m/s]\n0,1,2\n1,2,3\n");
  ImportOptions options;
  options.channels = {"F", "0", "v"};
  EXPECT_EQ(import_recording(file.path(), options).channels.size(), 2U);
}

}  // namespace
}  // namespace impactrig::acquisition
