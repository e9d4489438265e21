// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <string>

#include "acquisition/importer.hpp"
#include "acquisition/importers/column_heads.hpp"
#include "tests/acquisition/written_file.hpp"

/// Which words above a table are its names and units: remarks, keys and suffixes that are not.
namespace impactrig::acquisition {
namespace {

using datasets::Quantity;
using datasets::Record;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using tests::imported;
using tests::names_and_units;

constexpr const char* rows = "0.0,1.5,1\n0.1,1.6,2\n0.2,1.7,3\n0.3,1.8,4\n";

TEST(CsvNames, MayHaveARemarkBelowThem) {
  for (const char* remark : {"# recorded by me", "# calibrated yesterday", "# note: a, b, c",
                             "recorded by me", "% 3 shots", "Tracks 1 to 2"}) {
    const Record record =
        imported(fmt::format("time (ms),force (N),accel (g)\n{}\n{}", remark, rows));
    EXPECT_THAT(names_and_units(record), ElementsAre("force [N]", "accel [g]")) << remark;
    EXPECT_DOUBLE_EQ(record.channels.at(0).clock.interval, 1e-4) << remark;
    EXPECT_THAT(record.warnings, IsEmpty()) << remark;
  }
  // units below names in a comment are none
  EXPECT_THAT(names_and_units(imported(fmt::format("time,force,accel\n#ms,N,g\n{}", rows))),
              ElementsAre("force [N]", "accel [g]"));
}

// What stands above them may be a title or a key, which the delimiter happens to divide
TEST(CsvNames, MayBeDividedOtherwiseBelowATitle) {
  struct Head {
    const char *head, *force;
  };

  for (const Head& one : {Head{"Impact test, steel bar\ntime force\n", "force []"},
                          {"Comment, none\nTime;Force\n", "Force []"},
                          {"Author, Miller\n%t(ms) F(N)\n", "F [N]"},
                          {"Load cell: HBM, left side\n# Time [s]  Force [N]\n", "Force [N]"}})
    EXPECT_THAT(names_and_units(imported(std::string(one.head) + "0,0.5\n0.1,0.7\n0.2,0.6\n")),
                ElementsAre(one.force))
        << one.head;
  EXPECT_THAT(names_and_units(imported("Probe;Stahl\nSensor;Kistler\n#Zeit [us];Kraft [kN]\n"
                                       "0;0,5\n0,001;7,5\n0,002;6,5\n")),
              ElementsAre("Kraft [kN]"));
  EXPECT_THAT(names_and_units(imported("Material;Stahl\nPr\u00FCfer;M\u00FCller\nMesswerte\n"
                                       "0;0,5\n0,001;7,5\n0,002;6,5\n")),
              ElementsAre("column 1 []"));
}

TEST(CsvNames, OfSensorsAboveAreNoneOfTheirOwn) {
  const Record record =
      imported("Channel,Hammer,Bar tip,Bar root\nTime,N,m,g\n0,1,2,3\n0.1,2,3,4\n0.2,1,1,2\n");
  EXPECT_DOUBLE_EQ(record.channels.at(0).clock.interval, 0.1);
}

// The first column of a table without keys may be filled later on
TEST(CsvNames, OfAFirstColumnThatIsBlankStayAChannel) {
  EXPECT_THAT(names_and_units(imported(",t [s],F [N]\n,0,1\n,1,2\n,2,3\n")),
              ElementsAre("column 0 []", "F [N]"));
}

TEST(CsvNames, OfColumnsThatAreBlankAtFirstCount) {
  const Record record =
      imported("time (s),force (N),wind\n# wind is blank at first\n0,1,\n1,2,\n2,3,4\n3,4,5\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("force [N]", "wind []"));
  EXPECT_THAT(record.channels.at(1).valid, ElementsAre(0, 0, 1, 1));
}

TEST(CsvNames, AreNoKeysWithTheirValues) {
  const Record record = imported(  // Hantek DSO5000
      "#timebase=40000000(ps),#voltbase=1000000(uV)\n2.00000E-07,3320\n4.00000E-07,3240\n"
      "6.00000E-07,3320\n8.00000E-07,3260\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("column 1 []"));
  EXPECT_NEAR(record.channels.at(0).clock.interval, 2e-7, 1e-15);
}

// Yokogawa WT1800 and DL850: keys stand over an empty first column
TEST(CsvNames, StandBesideAnEmptyColumnOfKeys) {
  for (const char* names : {"\n,\"U1\",\"I1\",\n\"$WaveData\"\n", "\n"}) {
    const Record record = imported(
        fmt::format("\"Model Name\"   ,\"WT1800\"\n\"TraceName\"    ,\"U1   \",\"I1   \"\n"
                    "\"VUnit\"        ,\"V    \",\"A    \"\n\"HResolution\"  ,3.125E-05,3.125E-05\n"
                    "\"HUnit\"        ,\"s    \",\"s    \"\n{},-516.7,-3.9,\n,-520.5,-4.0,\n"
                    ",-522.1,-4.2,\n",
                    names));
    EXPECT_THAT(names_and_units(record), ElementsAre("U1 [V]", "I1 [A]"));
    EXPECT_EQ(record.channels.at(0).clock.interval, 3.125e-5);
    EXPECT_THAT(record.warnings, IsEmpty());
  }
}

// As R's write.table() and gnuplot's files have them: the quotes stayed, and units and clocks were
// lost.
TEST(CsvNames, MayStandInQuotesBetweenBlanks) {
  const std::string plain = "0.0 7.5\n0.1 8.5\n0.2 9.5\n";
  const std::string numbered = "\"1\" 0.0 7.5\n\"2\" 0.1 8.5\n\"3\" 0.2 9.5\n";
  for (const std::string& text :
       {"\"Time[s]\" \"Force[N]\"\n" + plain, "\"Time [s]\" \"Force [N]\"\n" + plain,
        "# \"Time (s)\"  \"Force (N)\"\n" + plain, "\"Time [s]\" \"Force [N]\"\n" + numbered}) {
    const Record record = imported(text);
    ASSERT_THAT(names_and_units(record), ElementsAre("Force [N]")) << text;
    EXPECT_EQ(record.channels[0].value(2), 9.5);
    EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 0.1);
  }
  EXPECT_THAT(imported("\"Force\" \"Vel\"\n5 7 1\n3 8 2\n4 9 3\n").warnings,
              Contains(HasSubstr("names 2 of 3 columns")));
}

TEST(CsvNames, MayBeOverOneWordThatIsNoUnit) {
  Record record = imported(  // MTS
      "Force\tDisplacement\tRunning Time\tCount\nN\tmm\ts\tsegments\n-123.3\t9.98\t0.02\t0\n"
      "-132.7\t9.97\t0.03\t0\n-126.7\t9.98\t0.04\t1\n");
  EXPECT_THAT(names_and_units(record),
              ElementsAre("Force [N]", "Displacement [mm]", "Count [segments]"));
  EXPECT_DOUBLE_EQ(record.channels.at(0).clock.interval, 0.01);
  record = imported("Test\tof\tto\tday\nF\tx\tt\tcount\n1.5\t2.5\t0\t3\n1.6\t2.6\t1\t4\n");
  EXPECT_THAT(names_and_units(record), Contains(HasSubstr("x [")));
}

std::string divided(const char* text) {
  const ColumnHead head = split_head(text);
  return head.name + "|" + head.unit;
}

TEST(ColumnHead, ARangeIsNoUnit) {
  EXPECT_EQ(divided("Acc (g) (50 g)"), "Acc (50 g)|g");
  EXPECT_EQ(divided("F (N) [5 V]"), "F [5 V]|N");
  EXPECT_EQ(divided("F [N] (5 kHz)"), "F (5 kHz)|N");
  EXPECT_EQ(divided("F (N) (10%)"), "F (10%)|N");
  EXPECT_EQ(divided("X (200g)"), "X (200g)|");
  EXPECT_EQ(divided("CH1 (\u00b110 V)"), "CH1 (\u00b110 V)|");
  EXPECT_EQ(divided("Force [2000N]"), "Force [2000N]|");
  // counted by
  EXPECT_EQ(divided("Time (10 us)"), "Time|10 us");
  EXPECT_EQ(divided("F [10^3 N]"), "F|10^3 N");
  EXPECT_EQ(divided("F (1e3 N)"), "F|1e3 N");
  EXPECT_EQ(divided("x [0.1 mm]"), "x|0.1 mm");
  EXPECT_EQ(divided("strain [1/m]"), "strain|1/m");
}

TEST(ColumnHead, HasItsUnitBeforeASuffix) {
  EXPECT_EQ(divided("Time (ms) Run #1"), "Time Run #1|ms");
  EXPECT_EQ(divided("Force [N] - Plot 0"), "Force - Plot 0|N");
  EXPECT_EQ(divided("Time [ms].1"), "Time.1|ms");
  EXPECT_EQ(divided("Force (N)_1"), "Force_1|N");
  EXPECT_EQ(divided("Force (N) (filtered)"), "Force (filtered)|N");
  EXPECT_EQ(divided("acc (g) [Ch 1]"), "acc [Ch 1]|g");
  EXPECT_EQ(divided("Force (N) (A)"), "Force (A)|N");
  EXPECT_EQ(divided("Velocity (tip) (m/s)"), "Velocity (tip)|m/s");
  EXPECT_EQ(divided("x [mm] rate (m/s)"), "x [mm] rate|m/s") << "the last one";
  EXPECT_EQ(divided("F(x) left"), "F(x) left|");
  EXPECT_EQ(divided("i:quat[0-1]"), "i:quat[0-1]|") << "an index";
  EXPECT_EQ(divided("strain [-]"), "strain|-");
  EXPECT_EQ(divided("Strain [10-6]"), "Strain|10-6");
  EXPECT_EQ(divided("Weg (s) in mm"), "Weg (s)|mm") << "a symbol";
  EXPECT_EQ(divided("Kraft (F) / kN"), "Kraft (F)|kN");
  EXPECT_EQ(divided("Sensor (A) left"), "Sensor (A) left|");
  EXPECT_EQ(divided("Torque [in lbf]"), "Torque|in lbf");
  EXPECT_EQ(divided("Force (in kN)"), "Force|kN");
  EXPECT_EQ(divided("Обороты, об/мин"), "Обороты|об/мин");
  EXPECT_EQ(divided("Way (in mm)"), "Way|mm") << "no inch";
  EXPECT_EQ(divided("Way (in)"), "Way|in");
  EXPECT_EQ(divided("Y(t)"), "Y(t)|") << "of the time";
  EXPECT_EQ(divided("load (t)"), "load|t") << "in tonnes";
}

TEST(CsvTimes, OfTheSizeOfAnEpochAreCountedFrom1970) {
  struct Epoch {
    const char *first, *second, *unit;
    double interval;
  };

  for (const Epoch& epoch :
       {Epoch{"1742324422348709600", "1742324422358709600", "ns", 0.01},
        Epoch{"1742324422348709", "1742324422358709", "us", 0.01},
        Epoch{"1641807866241.00", "1641807866253.00", "ms", 0.012},
        Epoch{"1641807866.25", "1641807866.50", "s", 0.25},
        // ticks of .NET (100 ns), ns since the start of a computer, ms since 1904: none of these
        Epoch{"639000000000000000", "639000000000010000", "s", 10000},
        Epoch{"812000000000", "812010000000", "s", 1e7},
        Epoch{"3793000000000", "3793000000010", "s", 10}}) {
    const Record record =
        imported(fmt::format("time,F [N]\n{},1\n{},2\n", epoch.first, epoch.second));
    EXPECT_NEAR(record.channels.at(0).clock.interval, epoch.interval, 1e-9) << epoch.unit;
    EXPECT_THAT(record.warnings,
                Contains(HasSubstr(std::string(epoch.unit) == "s"
                                       ? "states no unit: it is taken as s"
                                       : fmt::format("count {} since 1970", epoch.unit))));
  }
}

TEST(CsvTimes, AreNoFrequenciesAndNoDateThatStands) {
  Record record = imported("Hz\tReal\n0\t1\n1\t2\n2\t4\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("Hz []", "Real []"));
  record = imported("Datum [d];Kraft [kN];Laufzeit [s]\n41883;1,5;34,0\n41883;1,6;34,5\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("Datum [d]", "Kraft [kN]"));
  EXPECT_DOUBLE_EQ(record.channels.at(0).clock.interval, 0.5);
  record = imported("Time,X-Axis,Y-Axis\n0,1,2\n1,2,1\n2,3,5\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("X-Axis []", "Y-Axis []"));
}

// Scopy of the ADALM2000, and Rohde & Schwarz' RTB
TEST(CsvTimes, InCapitalsAreNotInSiemens) {
  for (const char* head : {"Time(S),F [N]\n", "Time [S],F [N]\n", "Time,F\nS,N\n"})
    EXPECT_DOUBLE_EQ(
        imported(std::string(head) + "0,1\n0.5,2\n1,3\n").channels.at(0).clock.interval, 0.5)
        << head;
  EXPECT_DOUBLE_EQ(imported("Time(MS),F [N]\n0,1\n0.5,2\n1,3\n").channels.at(0).clock.interval,
                   5e-4);
  EXPECT_THAT(names_and_units(imported("in s,C1 in V,C2 in A\n0,1,2\n1,2,3\n2,2,4\n")),
              ElementsAre("C1 [V]", "C2 [A]"));
}

TEST(CsvKeys, MayStandBehindASemicolon) {
  const Record record = imported(  // sigrok-cli
      "; CSV generated by libsigrok\n; Samplerate: 1 MHz\nF [N],d [mm]\n1.5,2.5\n1.4,2.6\n");
  EXPECT_DOUBLE_EQ(record.channels.at(0).clock.interval, 1e-6);
}

// The serial number of a sensor, as testing machines name a channel.
TEST(CsvNames, OfWhichOneIsANumberAreNames) {
  const std::string numbers = "66.16,0.5,1.5\n66.66,0.6,0.9\n67.16,1.2,0.8\n";
  EXPECT_THAT(names_and_units(imported("Laufzeit,Kraft,4712\ns,kN,mm\n" + numbers)),
              ElementsAre("Kraft [kN]", "CH 4712 [mm]"));
  EXPECT_THAT(names_and_units(imported("Laufzeit,Ch 1 Kraft,1281068\ns,kN,mm\n" + numbers)),
              ElementsAre("Ch 1 Kraft [kN]", "CH 1281068 [mm]"));
  EXPECT_THAT(names_and_units(imported("Force,Disp,3\nkN,mm,mm\n" + numbers)),
              ElementsAre("Force [kN]", "Disp [mm]", "CH 3 [mm]"));
  EXPECT_THAT(names_and_units(imported("Force,Disp,4711\n" + numbers)),
              ElementsAre("Force []", "Disp []", "CH 4711 []"));
  // a key with its values
  EXPECT_THAT(names_and_units(imported("Gain,10,100\ns,kN,mm\n" + numbers)),
              testing::Not(Contains(HasSubstr("Gain"))));
}

TEST(CsvNames, MayAllBeginWithADigit) {
  EXPECT_THAT(names_and_units(imported("1x,2x,3x\n0.6,2,3\n0.5,1,4\n")),
              ElementsAre("1x []", "2x []", "3x []"));
  EXPECT_THAT(names_and_units(imported("50g Acc (g),5kN Load cell (kN)\n0.5,2\n0.6,1\n")),
              ElementsAre("50g Acc [g]", "5kN Load cell [kN]"));
  EXPECT_THAT(names_and_units(imported("Sample rate,1000\n1. Hammer,2. Plate\n0.6,2\n0.5,1\n")),
              ElementsAre("1. Hammer []", "2. Plate []"));
  EXPECT_THAT(names_and_units(imported("0 deg [V];90 deg [V]\n0.5;2\n0.6;1\n")),
              ElementsAre("0 deg [V]", "90 deg [V]"));
  EXPECT_THROW(imported("0.5 s,12 N\n0.6,1\n0.7,2\n"), datasets::InputError);
}

TEST(ColumnHead, OfATemperatureInCIsNoCharge) {
  const Record record =
      imported("Time [s],TEMP [C],oil temp 2 [C],Q [C],Template [C]\n0,25.1,1,2,3\n1,25,2,1,4\n");
  EXPECT_EQ(record.channels.at(0).quantity, Quantity::temperature);
  EXPECT_EQ(record.channels.at(1).quantity, Quantity::temperature);
  EXPECT_EQ(record.channels.at(2).quantity, Quantity::charge);
  EXPECT_EQ(record.channels.at(3).quantity, Quantity::charge);
}

}  // namespace
}  // namespace impactrig::acquisition
