// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "acquisition/importer.hpp"
#include "acquisition/importers/formats.hpp"
#include "tests/acquisition/large_texts.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Channel;
using datasets::Record;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using tests::import_error;
using tests::imported;

struct Spelling {
  const char* text;
  const char* started;
};

class CsvDates : public testing::TestWithParam<Spelling> {};

TEST_P(CsvDates, AreTimesSinceTheFirstRow) {
  const Record record = imported(GetParam().text);
  ASSERT_EQ(record.channels.size(), 1U);
  const Channel& force = record.channels[0];
  EXPECT_EQ(force.name, "Force");
  EXPECT_EQ(force.unit, "N");
  EXPECT_THAT(force.values(), ElementsAre(1.5, -2.5, 3.0));
  EXPECT_EQ(force.clock.start, 0.0);
  EXPECT_EQ(force.clock.interval, 0.002);
  EXPECT_TRUE(force.clock.uniform());
  EXPECT_EQ(record.started, GetParam().started);
  EXPECT_THAT(record.warnings, IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(
    Spellings, CsvDates,
    testing::Values(
        Spelling{"Time,Force [N]\n2024-03-01 12:00:00.998,1.5\n2024-03-01 12:00:01.000,-2.5\n"
                 "2024-03-01 12:00:01.002,3\n",
                 "2024-03-01T12:00:00.998"},
        Spelling{"Zeit;Force [N]\n01.03.2024 23:59:59,998;1,5\n02.03.2024 00:00:00,000;-2,5\n"
                 "02.03.2024 00:00:00,002;3\n",
                 "2024-03-01T23:59:59.998"},
        Spelling{"When,Force [N]\n2/13/2024 11:59:59.998 PM,1.5\n2/14/2024 12:00:00.000 AM,-2.5\n"
                 "2/14/2024 12:00:00.002 AM,3\n",
                 "2024-02-13T23:59:59.998"},
        Spelling{"Date\tTime\tForce [N]\n2024/03/01\t12:00:00.998\t1.5\n2024/03/01\t12:00:01."
                 "000\t-2.5\n2024/03/01\t12:00:01.002\t3\n",
                 "2024-03-01T12:00:00.998"},
        Spelling{"Date Time Force[N]\n2024-03-01 12:00:00.998 1.5\n2024-03-01 12:00:01.000 -2.5\n"
                 "2024-03-01 12:00:01.002 3\n",
                 "2024-03-01T12:00:00.998"},
        // one name above a date and time that blanks divide
        Spelling{"Timestamp Force[N]\n2/13/2024 1:00:00.998 AM 1.5\n2/13/2024 1:00:01.000 AM -2.5\n"
                 "2/13/2024 1:00:01.002 AM 3\n",
                 "2024-02-13T01:00:00.998"},
        // the comma of the seconds divides cells too, and the names tell
        Spelling{"Time,Force [N]\n2024-03-01 12:00:00,998,1.5\n2024-03-01 12:00:01,000,-2.5\n"
                 "2024-03-01 12:00:01,002,3\n",
                 "2024-03-01T12:00:00.998"},
        Spelling{"time [hh:mm:ss.000],Force [N]\n\"23:59:59.998\",1.5\n\"00:00:00.000\",-2.5\n"
                 "\"00:00:00.002\",3\n",
                 ""},
        Spelling{"time,Force [N]\n2024-03-01T12:00:00.998Z,1.5\n2024-03-01T12:00:01.000Z,-2.5\n"
                 "2024-03-01T12:00:01.002Z,3\n",
                 "2024-03-01T12:00:00.998Z"}));

TEST(CsvDate, AColumnNamedAsTimeComesBeforeThem) {
  const Record record =
      imported("Stamp,t [s],Force [N]\n2024-03-01 12:00:00.1,0.5,1\n2024-03-01 12:00:00.2,1,2\n");
  ASSERT_EQ(record.channels.size(), 1U);
  EXPECT_EQ(record.channels[0].clock.start, 0.5);
  EXPECT_EQ(record.channels[0].clock.interval, 0.5);
  EXPECT_EQ(record.started, "2024-03-01T12:00:00.1");
  EXPECT_THAT(record.warnings,
              ElementsAre("'Stamp' holds times of day, and 't' is the time: it is left out"));
}

// A delay in ms is a channel where the rows state when they were recorded.
TEST(CsvDate, ComesBeforeAColumnOfTimeUnits) {
  const Record record = imported("Stamp,Delay [ms]\n12:00:00.1,5\n12:00:00.2,4\n12:00:00.3,7\n");
  ASSERT_EQ(record.channels.size(), 1U);
  EXPECT_EQ(record.channels[0].name, "Delay");
  EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 0.1);
}

TEST(CsvDate, StandsBesideTextAndCounters) {
  const Record record = imported(
      "No,Stamp,State,Force [N]\n1,12:00:00.1,ok,5\n2,12:00:00.2,ok,4\n3,12:00:00.3,bad,7\n");
  ASSERT_EQ(record.channels.size(), 1U);
  EXPECT_THAT(record.channels[0].values(), ElementsAre(5, 4, 7));
  EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 0.1);
  EXPECT_THAT(record.warnings, ElementsAre(HasSubstr("'State' holds text ('ok')")));
}

TEST(CsvDate, OfSeveralClocksCountsFromOneTime) {
  const Record record = imported(
      "Time A,F [N],Time B,G [N]\n12:00:00.2,1,12:00:00.1,1\n12:00:00.4,2,12:00:00.3,2\n"
      "12:00:00.6,2,12:00:00.5,2\n");
  ASSERT_EQ(record.channels.size(), 2U);
  EXPECT_DOUBLE_EQ(record.channels[0].clock.start, 0.1);
  EXPECT_EQ(record.channels[1].clock.start, 0.0);
}

// Loggers that print whole seconds: the changes tell the step, not the first and the last row.
TEST(CsvDate, RoundedToSecondsTellsTheStepByItsChanges) {
  std::string text = "Time,Force [N]\n";
  for (int i = 0; i < 3300; ++i)
    text += fmt::format("2024-03-01 12:00:{:02},{}\n", (700 + i) / 1000, i % 7);
  const Record record = imported(text);
  EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 1e-3);
  EXPECT_THAT(record.warnings,
              ElementsAre("the times are rounded to 1 s, and several samples share one: they are "
                          "taken as uniform, with a step of 0.001 s, which they tell to 1 in 2000 "
                          "(--sample-rate states it)"));
}

TEST(CsvDate, RoundedToSecondsWithLessThanTwoChangesTellsNoStep) {
  for (const int rows : {200, 800}) {
    std::string text = "Time,Force [N]\n";
    for (int i = 0; i < rows; ++i) text += fmt::format("12:00:{:02},{}\n", (700 + i) / 1000, i % 7);
    const Record record = imported(text);
    EXPECT_EQ(record.channels[0].clock.interval, 0.0);
    EXPECT_TRUE(record.channels[0].clock.uniform());
    EXPECT_THAT(record.warnings[0], HasSubstr("they do not tell the sample interval"));
    ImportOptions options;
    options.sample_rate = 1000.0;
    EXPECT_EQ(imported(text, options).channels[0].clock.interval, 1e-3);
  }
}

TEST(CsvDate, ErrorsSayWhatAndWhere) {
  EXPECT_EQ(import_error("Time,F\n12:00:00.1,1\n12:00:00.2,2\n12-00-00.3,3\n12:00:00.4,2\n"),
            "FILE:4:1 (byte 33): Time: expected a date and time as in the first row, found "
            "'12-00-00.3'");
  EXPECT_EQ(import_error("Time,F\n24-03-01 23:59:59.9,1\n24-03-02 00:00:00.0,2\n"),
            "FILE:3:1 (byte 29): Time: '24-03-02 00:00:00.0' is not of the first row's day, and "
            "does not tell day, month and year apart: write dates as 2024-12-31");
  EXPECT_THAT(import_error("12:00:00,100,1.5\n12:00:00,200,1.6\n12:00:00,300,1.6\n"),
              HasSubstr("'12:00:00,100': the comma may be the decimal mark of the seconds"));
  EXPECT_THAT(import_error("Time,F\n12:00:00.1,1\n,2\n12:00:00.3,2\n"),
              HasSubstr("a time is missing"));
}

TEST(CsvDate, CutOffAtTheEndIsLeftOut) {
  const Record record = imported("Time,F\n12:00:00.1,1\n12:00:00.2,2\n12:0");
  EXPECT_EQ(record.channels[0].size(), 2U);
  EXPECT_THAT(record.warnings, ElementsAre(HasSubstr("the file ends within the row")));
}

TEST(CsvDate, OfALargeFileIsReadByBlocksAsItIsReadAtOnce) {
  for (const int per_second : {1000, 50000}) {
    std::string text = "Time,Force [N]\n";
    for (int i = 0; i < 150000; ++i) {
      const int second = 86390 + i / per_second;
      const int of_day = second % 86400;
      text += fmt::format("{:02}:{:02}:{:02}", of_day / 3600, of_day / 60 % 60, of_day % 60);
      if (per_second == 1000) text += fmt::format(".{:03}", i % 1000);
      text += fmt::format(",{}\n", i);
    }
    const tests::WrittenFile file(text, ".csv");
    for (const bool window : {false, true}) {
      Selection wanted;
      if (window) {
        wanted.from = 1.5;
        wanted.to = 1.75;
      }
      const auto at_once = read_into_memory(*open_csv(file.path(), {}), wanted);
      const auto by_blocks = read_into_memory(*open_csv_by_blocks(file.path(), {}), wanted);
      tests::expect_same(by_blocks, at_once);
      ASSERT_GT(at_once.channels[0].size(), 200U);
      EXPECT_DOUBLE_EQ(at_once.channels[0].clock.interval, 1.0 / per_second);
    }
  }
}

TEST(Csv, ADateMayBeMissingBesideAFraction) {
  EXPECT_THAT(import_error("Date;Time;us;F\n2024-03-01;10:00:00;100;1\n ;10:00:00;200;2\n"
                           "2024-03-01;10:00:00;300;3\n"),
              HasSubstr("expected a date and time as in the first row"));
}

TEST(Csv, TimesMayBeDurationsOfPandas) {
  const auto record = imported(
      ",F (N)\n0 days 00:00:00,0.0\n0 days 00:00:00.000100,0.5\n0 days 00:00:00.000200,1.0\n");
  ASSERT_EQ(record.channels.size(), 1U);
  EXPECT_NEAR(record.channels[0].clock.interval, 1e-4, 1e-12);
  EXPECT_EQ(record.channels[0].clock.start, 0.0);
}

TEST(Csv, TimesMayBeDurationsOfMatlab) {
  const auto record = imported("Time,F\n-0.002 sec,0.0\n-0.001 sec,0.5\n0 sec,1.0\n0.001 sec,2\n");
  ASSERT_EQ(record.channels.size(), 1U);
  EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 1e-3);
  EXPECT_EQ(record.channels[0].clock.start, -0.002);
  EXPECT_EQ(record.attributes.at("time column"), "Time (holds durations)");
  EXPECT_EQ(record.started, "");
}

struct SecondColumns {
  const char* names;
  std::int64_t unit;  // [ns]
};

class CsvSecondColumns : public testing::TestWithParam<SecondColumns> {};

TEST_P(CsvSecondColumns, AreOneTime) {
  const auto [names, unit] = GetParam();
  std::string text = fmt::format("{},Force [N]\n", names);
  const std::int64_t first = 1'709'290'800'998'000'000;
  for (int i = 0; i < 5; ++i) {
    const std::int64_t time = first + i * 1'000'000;
    text += fmt::format("{},{},{}\n", time / 1'000'000'000, time % 1'000'000'000 / unit, i);
  }
  const Record record = imported(text);
  ASSERT_EQ(record.channels.size(), 1U);
  EXPECT_EQ(record.channels[0].name, "Force");
  EXPECT_EQ(record.channels[0].clock.start, 0.0);
  EXPECT_EQ(record.channels[0].clock.interval, 1e-3);
  EXPECT_EQ(record.started, "2024-03-01T11:00:00.998Z");
  EXPECT_THAT(record.warnings, IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(Names, CsvSecondColumns,
                         testing::Values(SecondColumns{"sec,nsec", 1},
                                         SecondColumns{".stamp.secs,.stamp.nsecs", 1},
                                         SecondColumns{"tv_sec,tv_usec", 1000},
                                         SecondColumns{"Time [s],Time [us]", 1000},
                                         SecondColumns{"Unix Time (s),ns", 1},
                                         SecondColumns{"Seconds,Milliseconds", 1000000}));

TEST(CsvSecondColumns, OfWhichOneDoesNotFitAreColumns) {
  EXPECT_EQ(imported("seconds,milliseconds\n0,0\n1,1000\n2,2000\n").channels.size(), 1U);
  EXPECT_EQ(imported("a.sec,b.nsec\n0,0\n1,100\n2,200\n").channels.at(0).name, "b.nsec");
  EXPECT_THAT(import_error("sec,nsec,F\n0,0,1\n0,500000000,2\n1,0,3\n1,,4\n2,0,5\n"),
              HasSubstr("expected a date and time"));
}

TEST(CsvSecondColumns, OfALargeFileAreReadByBlocksAsTheyAreReadAtOnce) {
  std::string text = "sec,usec,F\n";
  for (int i = 0; i < 150000; ++i)
    text += fmt::format("{},{},{}\n", 5 + i / 1000, i % 1000 * 1000, i);
  const tests::WrittenFile file(text, ".csv");
  const auto at_once = read_into_memory(*open_csv(file.path(), {}), {});
  tests::expect_same(read_into_memory(*open_csv_by_blocks(file.path(), {}), {}), at_once);
  EXPECT_EQ(at_once.channels.at(0).clock.interval, 1e-3);
}

TEST(Csv, TimesOfAClockMayBeBeforeItsZero) {
  for (const char* rows :
       {"-00:00:00.002,0\n-00:00:00.001,1\n00:00:00.000,2\n00:00:00.001,3\n",
        "\u221200:00:00.002,0\n\u221200:00:00.001,1\n00:00:00.000,2\n00:00:00.001,3\n",
        "-00:00:00.002,0\n-00:00:00.001,1\n+00:00:00.000,2\n+00:00:00.001,3\n",
        "\"-00:00:00,002\",0\n\"-00:00:00,001\",1\n\"00:00:00,000\",2\n\"00:00:00,001\",3\n",
        "-1 days +23:59:59.998,0\n-1 days +23:59:59.999,1\n0 days 00:00:00,2\n0 days "
        "00:00:00.001,3\n",
        "-00:00.002,0\n-00:00.001,1\n00:00.000,2\n00:00.001,3\n"}) {
    const auto record = imported(std::string("Time,F\n") + rows);
    ASSERT_EQ(record.channels.size(), 1U) << rows;
    EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 1e-3);
    EXPECT_EQ(record.channels[0].clock.start, -0.002);
    EXPECT_THAT(record.warnings, IsEmpty());
  }
}

struct ClockColumns {
  const char* text;
  const char* started;
};

class CsvClockColumns : public testing::TestWithParam<ClockColumns> {};

// Over a minute's end, after which seconds alone begin anew.
TEST_P(CsvClockColumns, AreOneTime) {
  const auto [text, started] = GetParam();
  const Record record = imported(text);
  ASSERT_EQ(record.channels.size(), 1U) << text;
  EXPECT_EQ(record.channels[0].name, "F");
  EXPECT_EQ(record.channels[0].values(), (std::vector<double>{7, 8, 9, 10}));
  EXPECT_EQ(record.channels[0].clock.start, 0.0);
  EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 0.25);
  EXPECT_EQ(record.started, started);
  EXPECT_THAT(record.warnings, IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(
    Heads, CsvClockColumns,
    testing::Values(
        ClockColumns{"Hour,Minute,Second,F [N]\n10,59,59.5,7\n10,59,59.75,8\n11,0,0,9\n"
                     "11,0,0.25,10\n",
                     ""},
        ClockColumns{"Year;Month;Day;Hour;Minute;Second;F [N]\n2024;2;29;23;59;59,5;7\n"
                     "2024;2;29;23;59;59,75;8\n2024;3;1;0;0;0;9\n2024;3;1;0;0;0,25;10\n",
                     "2024-02-29T23:59:59.5"},
        ClockColumns{"Hour [h],Minute [min],Second [s],F [N]\n10,59,59.5,7\n10,59,59.75,8\n"
                     "11,0,0,9\n11,0,0.25,10\n",
                     ""},
        ClockColumns{"HH\tMM\tSS\tms\tF [N]\n23\t59\t59\t500\t7\n23\t59\t59\t750\t8\n"
                     "0\t0\t0\t0\t9\n0\t0\t0\t250\t10\n",
                     ""},
        ClockColumns{"Date,Hour,Minute,Second,F [N]\n2024-02-29,23,59,59.5,7\n"
                     "2024-02-29,23,59,59.75,8\n2024-03-01,0,0,0,9\n2024-03-01,0,0,0.25,10\n",
                     "2024-02-29T23:59:59.5"},
        ClockColumns{"Datum;H;M;S;ms;F [N]\n29.02.2024;23;59;59;500;7\n"
                     "29.02.2024;23;59;59;750;8\n01.03.2024;0;0;0;0;9\n01.03.2024;0;0;0;250;10\n",
                     "2024-02-29T23:59:59.5"},
        ClockColumns{"Date,Time,Millisecond,F [N]\n2024-02-29,23:59:59,500,7\n"
                     "2024-02-29,23:59:59,750,8\n2024-03-01,00:00:00,0,9\n"
                     "2024-03-01,00:00:00,250,10\n",
                     "2024-02-29T23:59:59.5"},
        ClockColumns{"# yyyy mm dd hh mm ss F\n2.0240e+03 3 1 10 59 59.50 7\n"
                     "2.0240e+03 3 1 10 59 59.75 8\n2.0240e+03 3 1 11 00 00.00 9\n"
                     "2.0240e+03 3 1 11 00 00.25 10\n",
                     "2024-03-01T10:59:59.5"}));

TEST(CsvClockColumns, OfNoClockAreColumns) {
  EXPECT_EQ(imported("h,min,s\n1,70,3\n2,80,4\n3,90,5\n").channels.size(), 2U);
  EXPECT_EQ(imported("m,s,F\n1,0,3\n2,1,4\n3,2,5\n").channels.size(), 2U);
  // a height, a mass, a stroke beside a time; and what goes down
  EXPECT_EQ(imported("t,h,m,s\n0.0,1,2,3.5\n0.1,1,2,3.7\n0.2,1,2,3.6\n").channels.size(), 3U);
  EXPECT_EQ(imported("H,M,S,D\n1,2,3,1\n1,2,4,2\n1,1,5,3\n1,2,6,4\n").channels.size(), 4U);
  EXPECT_EQ(imported("Rate;10;Hz\nF [N];h [mm];m [kg];s [m]\n7;1;2;3\n8;1;2;4\n9;1;3;5\n")
                .channels.size(),
            4U);
  EXPECT_EQ(imported("h,m,s\n1,2,3\n1,2,4\n1,2,5\n").channels.size(), 2U);
  EXPECT_EQ(imported("h,m,s,F\n1,2,58,7\n1,2,59,8\n1,3,0,9\n").channels.size(), 1U);
  ImportOptions by_name;
  by_name.time_column = "second";
  EXPECT_EQ(imported("hour,minute,second,F\n1,2,3,1\n1,2,4,2\n1,2,5,3\n", by_name).channels.size(),
            3U);
  EXPECT_THAT(import_error("hour,minute,second,F\n1,2,3,1\n1,2,4,2\n1,2,5,3\n1,x,6,4\n1,2,7,5\n"),
              HasSubstr(":5:3 (byte 47): minute: expected a number, found 'x'"));
}

// Keys beside the samples and a time of day behind them, which was looked for in other cells: as
// fuzzing made it. The sanitizers told.
TEST(CsvDate, BesideKeysIsNone) {
  const std::string text =
      "D([s],F\376r ce[oN01.2050;00:00:0]\n0,-10,0;2,5\n\n01\n+e6,2.5\n2e-6,.0-3\n2"
      "e-6:.202\3405;00:00.0-3\n2e-6:.2025;00:00:00,0;2,51\n;;;;;;;;;;;;;;;;;;;;;;;"
      ";;;0:00,0;2,51\n;;;;;;;;;;;;;;;;;;;;;;;;;;;;;;;;;;;;0;;;;;;;;;;;;;;;;;;;;;;0"
      "0;;;;;;;;;;0;;;;;;;;;;;;;;;;;;;;;;000,15.000000,15.500000,16.000000,16.50000"
      "0,17.;;;;;\n";
  EXPECT_THAT(import_error(text), HasSubstr("expected a number, found '0:00"));
}

// Names of more columns than the rows have, but for one: as fuzzing made it.
TEST(CsvClockColumns, BeyondTheRowsAreNone) {
  const std::string text =
      "0l,4.5,Hour,Minute,Second,ms3,F [N]\n10,59,59,50015,\n0,59,59,50015,\n7\n"
      "7,  \000\310095,9,7508\n11-,0,0,0,9\n";
  EXPECT_NE(import_error(text), "");
  EXPECT_NE(import_error("a,Hour,Minute,Second\n1,2\n2,3\n3,4,5,6\n"), "");
}

TEST(CsvClockColumns, OfALargeFileAreReadByBlocksAsTheyAreReadAtOnce) {
  std::string text = "hour,minute,second,F\n";
  for (int i = 0; i < 150000; ++i)
    text += fmt::format("{},{},{}.{:03},{}\n", 7, i / 60000, i / 1000 % 60, i % 1000, i);
  const tests::WrittenFile file(text, ".csv");
  const auto at_once = read_into_memory(*open_csv(file.path(), {}), {});
  tests::expect_same(read_into_memory(*open_csv_by_blocks(file.path(), {}), {}), at_once);
  EXPECT_EQ(at_once.channels.at(0).clock.interval, 1e-3);
}

}  // namespace
}  // namespace impactrig::acquisition
