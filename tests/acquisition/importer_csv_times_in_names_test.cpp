// SPDX-License-Identifier: BSD-3-Clause
//
// Units of time, and others, that a name tells in words or at its end.
#include <gmock/gmock.h>

#include <string>

#include "acquisition/importer.hpp"
#include "acquisition/importers/column_heads.hpp"
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

struct Words {
  const char* head;
  double interval;  // of steps of one [s]
};

class CsvTimesInWords : public testing::TestWithParam<Words> {};

// All were taken in seconds.
TEST_P(CsvTimesInWords, HaveTheirUnit) {
  const auto [head, interval] = GetParam();
  const Record record = imported(std::string(head) + ";F [N]\n-5;7\n-4;8\n-3;9\n");
  ASSERT_THAT(names_and_units(record), ElementsAre("F [N]"));
  EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, interval);
  EXPECT_THAT(record.warnings, IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(
    Heads, CsvTimesInWords,
    testing::Values(Words{"Time (mins)", 60.0}, Words{"Zeit (Millisekunden)", 1e-3},
                    Words{"Temps (millisecondes)", 1e-3}, Words{"Zeit [Millisekunden]", 1e-3},
                    Words{"Milliseconds", 1e-3}, Words{"Microseconds", 1e-6},
                    Words{"Minutes", 60.0}, Words{"Zeit_in_ms", 1e-3}, Words{"t_in_ms", 1e-3},
                    Words{"Zeitachse_ms", 1e-3}, Words{"Messzeit_ms", 1e-3},
                    Words{"Temps_ms", 1e-3}, Words{"X_ms", 1e-3}, Words{"x_us", 1e-6},
                    Words{"Elapsed Time_ms", 1e-3}, Words{"time_rel_ms", 1e-3},
                    Words{"Time_ms_rel", 1e-3}, Words{"sample time ms", 1e-3},
                    Words{"Zeit-ms", 1e-3}, Words{"time.ms", 1e-3}, Words{"timeMs", 1e-3},
                    Words{"timeUs", 1e-6}, Words{"t_mus", 1e-6}, Words{"Time(ms)*", 1e-3},
                    Words{"Time (ms):", 1e-3}, Words{"Zeit in Millisekunden", 1e-3}));

TEST(CsvTimesInWords, MayBeOfAChannel) {
  EXPECT_THAT(
      names_and_units(imported("t [s],rise_time_ms,second,min\n0,7,1,1\n1,7,2,2\n2,7,1,1\n")),
      ElementsAre("rise_time [ms]", "second []", "min []"));
}

TEST(CsvTimesInWords, ThatAreCountedAreNoSeconds) {
  EXPECT_THAT(import_error("Time (ticks),F [N]\n-5,7\n-4,8\n-3,9\n"),
              HasSubstr("since the file states 'Time' in 'ticks'"));
}

// The velocity was a time in seconds, and of samples that are counted the clock.
TEST(CsvUnitsBehindALine, MayBeDivided) {
  EXPECT_THAT(names_and_units(imported("time_s,v_m/s,F_N\n0,3,7\n1,4,8\n2,5,9\n")),
              ElementsAre("v_m/s [m/s]", "F_N [N]"));
  const Record record = imported("No,v_m/s,load_N/mm,rate_N/s\n0,3,7,1\n1,4,8,2\n2,5,9,2\n");
  EXPECT_THAT(names_and_units(record),
              ElementsAre("v_m/s [m/s]", "load_N/mm [N/mm]", "rate_N/s [N/s]"));
  EXPECT_EQ(record.channels[0].quantity, datasets::Quantity::velocity);
  EXPECT_THAT(names_and_units(imported("t [s],Kanal_2/kN\n0,7\n1,8\n2,9\n")),
              ElementsAre("Kanal_2 [kN]"));
}

// '#' began a comment before a tab: names were those of the columns before.
TEST(CsvNames, MayBeginWithASignForNumbers) {
  const Record dated = imported(
      "#\tTime\tF [N]\tAcc [g]\n1\t2021-03-12 10:11:12.000\t7\t1\n2\t2021-03-12 "
      "10:11:12.001\t8\t2\n"
      "3\t2021-03-12 10:11:12.002\t9\t3\n");
  EXPECT_THAT(names_and_units(dated), ElementsAre("F [N]", "Acc [g]"));
  EXPECT_DOUBLE_EQ(dated.channels.at(0).clock.interval, 1e-3);
  EXPECT_THAT(dated.warnings, IsEmpty());
  const Record units =
      imported("#\tTime\tForce\tAcc\n\ts\tN\tg\n1\t0\t7\t1\n2\t0.1\t8\t2\n3\t0.2\t9\t3\n");
  EXPECT_THAT(names_and_units(units), ElementsAre("Force [N]", "Acc [g]"));
  EXPECT_THAT(names_and_units(imported("#\tt [s]\tF [N]\n0\t7\n1\t8\n2\t9\n")),
              ElementsAre("F [N]"));
}

// Samples, names and units were missing without a word.
TEST(CsvRows, WithWordsBesideThemAreNoHead) {
  EXPECT_THAT(import_error("Time (s),Force (N),,Max,20.5\n0.0,7,,Min,-3\n0.1,8\n0.2,9\n0.3,9\n"),
              HasSubstr("'Min' stands beside its first 2 cells"));
}

// Kyowa's EDX-100A writes so in Japanese: the units were the names.
TEST(CsvLabels, MayStandOverTheTimes) {
  for (const char* head : {"\"\u8a66\u9a13\u65e5\u6642\",\"2022/01/24\",\"12:10:45\"\n"
                           "\"CH\u540d\u79f0\",\"Load\",\"Acc\"\n\"CH No\",\"CH1\",\"CH2\"\n"
                           "\"\u5358\u4f4d\",\"N\",\"m/s2\"\n",
                           "\"Date\",\"2022/01/24\",\"12:10:45\"\n\"CH Name\",\"Load\",\"Acc\"\n"
                           "\"Range\",10,10\n\"Unit\",\"N\",\"m/s2\"\n"}) {
    const Record record = imported(std::string(head) + "0.0,7,1\n0.1,8,2\n0.2,9,3\n");
    EXPECT_THAT(names_and_units(record), ElementsAre("Load [N]", "Acc [m/s2]"));
    EXPECT_EQ(record.started, "2022-01-24T12:10:45");
  }
}

TEST(CsvLabels, InOtherWordsAreNoNames) {
  for (const char* word : {"Sensor", "CH", "Bezeichnung", "Parameter"})
    EXPECT_THAT(names_and_units(imported("Sample rate\t1000 Hz\n" + std::string(word) +
                                         "\tForce\tAcc\n7.5\t1\n8.5\t2\n7\t3\n")),
                ElementsAre("Force []", "Acc []"))
        << word;
}

TEST(CsvKeys, TellTheStartInOtherWords) {
  for (const char* head :
       {"Startzeit;13.03.2021 10:11:12,5\n", "T0 - Standardmessrate;13.03.2021 10:11:12,5\n",
        "Datum/Zeit;13.03.2021 10:11:12,5\n", "Date;2021-03-13\nTime;10:11:12.5\n",
        "Datum;13.03.2021\nUhrzeit;10:11:12.5\n"})
    EXPECT_EQ(imported(std::string(head) + "Zeit (s);F (N)\n0,0;7\n0,1;8\n0,2;9\n").started,
              "2021-03-13T10:11:12.5")
        << head;
}

}  // namespace
}  // namespace impactrig::acquisition
