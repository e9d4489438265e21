// SPDX-License-Identifier: BSD-3-Clause
//
// Lines above a table that say what they hold, and lines between its names and its rows.
#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "acquisition/importer.hpp"
#include "acquisition/importers/column_heads.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Record;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using tests::imported;
using tests::names_and_units;

class CsvLabels : public testing::TestWithParam<const char*> {};

// The rows have one cell less than the lines above them, so that names must not be those of the
// columns from the first on: the velocity was called 'Force'.
TEST_P(CsvLabels, NameTheColumnsBesideThem) {
  const Record record = imported(std::string(GetParam()) + "7.5,-0.4\n8.5,-0.3\n9.5,-0.2\n");
  ASSERT_THAT(names_and_units(record), ElementsAre("Force [N]", "Vel [m/s]"));
  EXPECT_EQ(record.channels[0].values(), (std::vector<double>{7.5, 8.5, 9.5}));
  EXPECT_EQ(record.channels[1].values(), (std::vector<double>{-0.4, -0.3, -0.2}));
  EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 1e-3);
  EXPECT_THAT(record.warnings, IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(
    Heads, CsvLabels,
    testing::Values("Sampling rate,1000\nName,Force,Vel\nUnit,N,m/s\n",
                    "Sampling rate,1000\nChannel:,Force,Vel\nUnit:,N,m/s\n",
                    "Sampling rate,1000\n# Channel,Force,Vel\n# Unit,N,m/s\n",
                    "SERIES,Force,Vel\nVERT_UNITS,N,m/s\nSampling rate,1000,1000\n",
                    "CH,1,2\nName,Force,Vel\nUnit,N,m/s\nSample interval,1,ms\n",
                    "\"TraceName\",\"Force\",\"Vel\"\n\"VUnit\",\"N\",\"m/s\"\n"
                    "\"SampleRate\",1000,1000\n\"HUnit\",\"s\",\"s\"\n",
                    "Sampling rate,1000\nWhatever,Force,Vel\nUnits,N,m/s\n"));

TEST(CsvLabels, StandOverTimesToo) {
  for (const char* head :
       {"Name,Time,Force\nUnit,ms,N\n", "#TITLES,Time,Force\n#UNITS,ms,N\n#DATA\n",
        "Kanal,Zeit,Force\nEinheit,ms,N\n"}) {
    const Record record = imported(std::string(head) + "0.0,7.5\n1.0,8.5\n2.0,9.5\n");
    ASSERT_THAT(names_and_units(record), ElementsAre("Force [N]")) << head;
    EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 1e-3);
    EXPECT_EQ(record.channels[0].value(0), 7.5);
  }
  const Record one = imported("Sampling rate,1000\nName,Force\nUnit,N\n7.5\n8.5\n9.5\n");
  EXPECT_THAT(names_and_units(one), ElementsAre("Force [N]"));
}

// A title, an operator and inputs above names: "run 3" and "John" were channels.
TEST(CsvLabels, AreNoNamesAboveNames) {
  const std::string rows = "0.0,7.5\n0.1,8.5\n0.2,9.5\n";
  for (const char* head :
       {"Title,Impact on plate,run 3\nTime,Force\ns,N\n", "Name,John,Lab 3\nTime [s],Force [N]\n",
        "Channel,A,B\nTime (s),Force (N)\n", "Test,Plate,Steel\nUnit,s,N\nTime,Force\n"}) {
    const Record record = imported(head + rows);
    ASSERT_EQ(record.channels.size(), 1U) << head;
    EXPECT_EQ(record.channels[0].name, "Force") << head;
    EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 0.1) << head;
  }
  EXPECT_THAT(
      names_and_units(imported("Sample rate,1000\nTitle,Impact test\nForce [N]\n1\n2\n3\n")),
      ElementsAre("Force [N]"));
}

// Names of columns whose last one is empty, and a title with its value, are none.
TEST(CsvLabels, AreNoNamesOfColumns) {
  EXPECT_THAT(names_and_units(imported("Name,F [N],v [m/s]\n1,2,\n2,3,\n3,4,\n")),
              ElementsAre("F [N]", "v [m/s]"));
  EXPECT_THAT(names_and_units(imported("Sampling rate,1000\nName,Smith\nF [N]\n1\n2\n3\n")),
              ElementsAre("F [N]"));
}

// "three" and "John" were channels.
TEST(CsvLabels, AreNoNamesAboveThoseOfOtherShapes) {
  for (const char* head :
       {"Name Drop three\nTime [s] Force [N]\n", "Channel hammer force\nTime [s] Force [N]\n",
        "# Signal of hammer\n# Time (s) Force (N)\n",
        "Variable names follow:\nTime [s] Force [N]\n", "Signal : hammer\nTime [s] Force [N]\n",
        "Name Smith John\nUnit SI x\n# Time [s] Force [N]\n",
        "# Signal: force hammer\n# time [s], Force [N]\n"}) {
    const Record record = imported(std::string(head) + "0.000 1.25\n0.001 2.75\n0.002 3.50\n");
    EXPECT_THAT(names_and_units(record), ElementsAre("Force [N]")) << head;
    EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 1e-3) << head;
  }
  for (const char* head : {"Name,Smith,John\n,Force [N]\n", "Label,A,B\n,Force [N]\n",
                           "Name,Smith,John\nTime [s],Force [N],Comment\n",
                           "Title,Drop,test\nUnits,SI,base\nTime [s],Force [N],Comment\n",
                           "Name,Smith,John\nChannel,Time,Force\nUnit,s,N\n",
                           "Name,Drop,three\nSensor,A,B\nChannel,Time,Force\nUnit,s,N\n"}) {
    const Record record = imported(std::string(head) + "0.000,1.25\n0.001,2.75\n0.002,3.50\n");
    EXPECT_EQ(names_and_units(record).at(0), "Force [N]") << head;
    EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 1e-3) << head;
  }
  const std::string rows = "0.000,1.25\n0.001,2.75\n0.002,3.50\n";
  EXPECT_THAT(names_and_units(imported("Name,Smith,John\nTime [s],1\n" + rows)),
              Not(Contains(HasSubstr("John"))));
  EXPECT_THAT(names_and_units(imported("Name,Smith,John\n,CH1\n" + rows)), ElementsAre("CH1 []"));
}

// Times were values of 'Name'.
TEST(CsvLabels, StandBeforeNamesWhereEveryLineEndsWithAMark) {
  for (const char* head : {"Name;Time [s];Force [N];\n", "Channel;Time (s);Force (N);\n"}) {
    const Record record = imported(std::string(head) + "0.0;7.5;\n0.1;8.5;\n0.2;9.5;\n");
    ASSERT_THAT(names_and_units(record), ElementsAre("Force [N]")) << head;
    EXPECT_EQ(record.channels[0].value(2), 9.5);
    EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 0.1);
  }
}

// Two channels were called 'Force', or had no unit.
TEST(CsvLabels, MayTellNamesApartThatAreRepeated) {
  const std::string rows = "0.000,1.25,7.1\n0.001,2.75,7.2\n0.002,3.50,7.4\n";
  for (const char* head :
       {"Time,Force,Force\n,hammer,bar\ns,N,N\n", "Time [s],Force [N],Force [N]\n,hammer,bar\n",
        "Time (s),Force (N),Force (N)\nTime,hammer,bar\n"}) {
    const Record record = imported(head + rows);
    EXPECT_THAT(names_and_units(record), ElementsAre("hammer [N]", "bar [N]")) << head;
    EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 1e-3) << head;
  }
  EXPECT_THAT(names_and_units(imported("Time,Acceleration,Acceleration\nt,ax,ay\n" + rows)),
              ElementsAre("ax []", "ay []"));
  EXPECT_THAT(names_and_units(imported("Time,Voltage,Voltage\ns,counts,steps\n" + rows)),
              ElementsAre("Voltage [counts]", "Voltage [steps]"))
      << "units under a time with its own, understood or not";
  EXPECT_THAT(names_and_units(imported("Time [s],Force [N],Force [N]\n,PCB,PCB\n" + rows)),
              ElementsAre("Force [N]", "Force [N]"));
}

TEST(CsvLabels, OfAnAxisAreItsUnit) {
  for (const char* head :
       {"X unit:,ms\nY unit:,kN\n", "X axis unit: ms\nY axis unit: kN\n",
        "Data type,Time\nX unit,ms\nY unit,kN\nData length,3\n",
        "Signal,Time\nX Unit,ms\nY Unit,kN\n", "X-Units,ms\nY-Units,kN\nX,Y\n"}) {
    const Record record = imported(std::string(head) + "0.5,7.5\n1.5,8.5\n2.5,9.5\n");
    ASSERT_EQ(record.channels.size(), 1U) << head;
    EXPECT_EQ(record.channels[0].unit, "kN") << head;
    EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 1e-3) << head;
  }
}

class CsvLinesUnderNames : public testing::TestWithParam<const char*> {};

// Times of 1 ms were taken for seconds.
TEST_P(CsvLinesUnderNames, LeaveNamesAndUnits) {
  const Record record =
      imported(std::string(GetParam()) + "0.0,7.5,-0.4\n1.0,8.5,-0.3\n2.0,9.5,-0.2\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("Force [kN]", "Velocity [mm/s]"));
  EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(
    Heads, CsvLinesUnderNames,
    testing::Values(
        "Time [ms],Force [kN],Velocity [mm/s]\nCH0,CH1,CH2\n",
        "Time [ms],Force [kN],Velocity [mm/s]\nSerial,SN1234,SN5678\n",
        "Time [ms],Force [kN],Velocity [mm/s]\n,PCB 086C03,OFV-505\n",
        "Time (ms),Force (kN),Velocity (mm/s)\nX,Y,Y\n",
        "Time (ms),Force (kN),Velocity (mm/s)\nAI0,AI1,AI2\n\n",
        "Time [ms],Force [kN],Velocity [mm/s]\n[MX840 CH 1],[MX840 CH 2]\nT0 = 3,Mean\n",
        "Time,Force,Velocity\nfloat,float,float\nms,kN,mm/s\n",
        "Time,Force,Velocity\n,PCB 086C03,OFV-505\nms,kN,mm/s\n"));

TEST(CsvLinesUnderNames, LeaveThemBesideNumbersOfTheRows) {
  const Record record =
      imported("Index,Time [ms],Force [kN]\n,,AI0\n1,0.0,7.5\n2,1.0,8.5\n3,2.0,9.5\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("Force [kN]"));
  EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 1e-3);
}

TEST(CsvLinesUnderNames, OfATimeWithoutUnitLeaveThemToo) {
  for (const char* line : {"Operator,Smith,Jones", "CH0,CH1,CH2", "Double,Float,Float"})
    EXPECT_THAT(names_and_units(imported(std::string("Time,Force,Velocity\n") + line +
                                         "\n0.0,7.5,-0.4\n0.1,8.5,-0.3\n0.2,9.5,-0.2\n")),
                ElementsAre("Force []", "Velocity []"))
        << line;
  // of two lines of names the lower one counts
  EXPECT_THAT(
      names_and_units(imported("Time,Signal 1,Signal 2\nt,Force,Vel\n0,7,1\n1,8,2\n2,9,3\n")),
      ElementsAre("Force []", "Vel []"));
}

// Of which only the time has a unit of its own, and those over the real names.
TEST(CsvLinesUnderNames, MayBeUnitsOrNames) {
  const std::string rows = "0.0,7.5,-0.4\n1.0,8.5,-0.3\n2.0,9.5,-0.2\n";
  for (const char* head :
       {"Time (ms),Force,Velocity\nms,kN,mm/s\n", "Time (ms),Force,Velocity\n,kN,mm/s\n",
        "Time [ms],Force,Velocity\n[ms],[kN],[mm/s]\n", "Time [ms],Force,Velocity\n-,kN,mm/s\n",
        "Time [ms],Channel 1,Channel 2\n,Force [kN],Velocity [mm/s]\n"})
    EXPECT_THAT(names_and_units(imported(head + rows)),
                ElementsAre("Force [kN]", "Velocity [mm/s]"))
        << head;
  EXPECT_THAT(names_and_units(imported("Time,CH1,CH2\n,Force,Velocity\n" + rows)),
              ElementsAre("Force []", "Velocity []"));
  EXPECT_THAT(names_and_units(imported("Start,Time (s),zero\nt,Force [kN],Vel [m/s]\n" + rows)),
              ElementsAre("Force [kN]", "Vel [m/s]"));
  EXPECT_THAT(names_and_units(imported("X Units,Y Units\ns,N\n0.0,7.5\n0.1,8.5\n0.2,9.5\n")),
              ElementsAre("Y Units [N]"));
}

// Factors that would change what the columns mean.
TEST(CsvLinesUnderNames, AreToldWhereTheyHoldFigures) {
  for (const char* head :
       {"Time,Ch1,Ch2\nms,V,mV\nGain,10,100\n", "Time [ms],Ch1 [V],Ch2 [mV]\nGain,10,100\n",
        "Time [ms],Ch1 [V],Ch2 [mV]\nSensitivity,\"4 mV/N\",\"0.1 V/g\"\n"}) {
    const Record record =
        imported(std::string(head) + "0.0,7.5,-0.4\n1.0,8.5,-0.3\n2.0,9.5,-0.2\n");
    EXPECT_THAT(names_and_units(record), ElementsAre("Ch1 [V]", "Ch2 [mV]"));
    EXPECT_THAT(record.warnings, ElementsAre(HasSubstr("holds figures of the columns"))) << head;
  }
}

// dSPACE's ControlDesk: the first sample was lost.
TEST(CsvLabels, MayStandBeforeTheFirstRowAlone) {
  const Record record = imported(
      "trace_name,\"time\",\"Force\"\nunit,s,N\ntrace_values,0.00,7.5\n,0.01,8.5\n,0.02,9.5\n");
  ASSERT_THAT(names_and_units(record), ElementsAre("Force [N]"));
  EXPECT_EQ(record.channels[0].values(), (std::vector<double>{7.5, 8.5, 9.5}));
  EXPECT_EQ(record.channels[0].clock.start, 0.0);
  EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 0.01);
  // inputs are no samples
  EXPECT_EQ(
      imported("x,t [s],F [N]\nInput,1,2\n,0.01,8.5\n,0.02,9.5\n,0.03,9.5\n").channels.at(1).size(),
      3U);
}

TEST(CsvUnits, MayStandAboveARelativeTime) {
  const Record record = imported("ms,N,V\nRelative Time,Force,Vel\n0,7,1\n1,8,2\n2,9,3\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("Force [N]", "Vel [V]"));
  EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 1e-3);
}

// 20 us were 20 s.
TEST(CsvUnits, OfSpoiltMicrosecondsAreTold) {
  for (const char* unit : {"?s", "\u00C2\u00B5s", "\u00E6s", "\uFFFDs"}) {
    const Record record = imported("Time (" + std::string(unit) + "),F (N)\n0,7\n20,8\n40,9\n");
    EXPECT_DOUBLE_EQ(record.channels.at(0).clock.interval, 20e-6) << unit;
    EXPECT_THAT(record.warnings, ElementsAre("the unit '" + std::string(unit) +
                                             "' of 'Time' is taken for \u00B5s (--units states "
                                             "another)"));
  }
  EXPECT_THAT(imported("Time (\u00B5s),F (N)\n0,7\n20,8\n40,9\n").warnings, IsEmpty());
  const Record below = imported("Time,F\n?s,?N\n0,7\n20,8\n40,9\n");
  EXPECT_DOUBLE_EQ(below.channels.at(0).clock.interval, 20e-6);
  EXPECT_EQ(below.channels.at(0).unit, "\u00B5N");
  EXPECT_EQ(below.warnings.size(), 2U);
}

TEST(CsvUnits, OfTimesMayBeSpeltAsVariablesAre) {
  for (const char* head : {"Time_us_,Force_N_\n", "Time.us.,Force.N.\n", "Time..us.,Force..N.\n",
                           "TIME (US),Force_N\n"}) {
    const Record record = imported(std::string(head) + "0,7\n20,8\n40,9\n");
    EXPECT_DOUBLE_EQ(record.channels.at(0).clock.interval, 20e-6) << head;
    EXPECT_EQ(record.channels.at(0).unit, "N") << head;
  }
}

TEST(CsvUnits, ThatAreStatedAreNotSaidToBeMissing) {
  EXPECT_THAT(imported("Time (s x 10),F (N)\n0,7\n20,8\n40,9\n").warnings,
              Contains(HasSubstr("states no unit that is understood")));
  EXPECT_THAT(imported("Time,F (N)\n0,7\n20,8\n40,9\n").warnings,
              Contains(HasSubstr("states no unit: it is taken as s")));
  // samples that are counted are no channel
  EXPECT_THAT(names_and_units(imported("Time (samples),F (N)\n0,7\n1,8\n2,9\n")),
              ElementsAre("F [N]"));
  EXPECT_THAT(names_and_units(imported("t [s],T [?C]\n0,7\n1,8\n2,9\n")), ElementsAre("T [?C]"));
}

std::string divided(const char* text) {
  const ColumnHead head = split_head(text);
  return head.name + "|" + head.unit;
}

TEST(ColumnHead, HasTheUnitBeforeTheNameOfAnInput) {
  EXPECT_EQ(divided("Force (N) [ch1]"), "Force [ch1]|N");
  EXPECT_EQ(divided("Vel (m/s) [AI 2]"), "Vel [AI 2]|m/s");
  EXPECT_EQ(divided("AI1 (Force) [N]"), "AI1 (Force)|N");
  EXPECT_EQ(divided("Acc (g) [m/s^2]"), "Acc (g)|m/s^2");
}

TEST(ColumnHead, OfMarksAloneIsThese) {
  for (const char* text : {".", "_", "__", "..", "._"})
    EXPECT_EQ(divided(text), std::string(text) + "|");
}

// "Decimal Symbol:" with a point alone beside it.
TEST(CsvKeys, OfPulseAreNoPolytecExport) {
  const Record record = imported(
      "Header Size:\t9\nDecimal Symbol:\t.\nSignal:\tForce\nX-axis unit:\ts\nX-axis size:\t3\n"
      "X-axis delta:\t0.5\nY-axis unit:\tN\n1\t0.0e+00\t3.5e-01\n2\t5.0e-01\t8.2e-01\n"
      "3\t1.0e+00\t3.3e-01\n");
  ASSERT_FALSE(record.channels.empty());
  EXPECT_EQ(record.channels.back().unit, "N");
  EXPECT_DOUBLE_EQ(record.channels.back().clock.interval, 0.5);
  const Record labshop = imported(
      "Header Size:\t9\nDecimal Symbol:\t.\nSignal:\tForce\nAmplitudeUnit:\tN\n"
      "X-Axis unit:\ts\nX-Axis size:\t3\nX-Axis delta:\t0.5\n1\t0.0e+00\t3.5e-01\n"
      "2\t5.0e-01\t8.2e-01\n3\t1.0e+00\t3.3e-01\n");
  EXPECT_EQ(labshop.channels.back().unit, "N");
  EXPECT_DOUBLE_EQ(labshop.channels.back().clock.interval, 0.5);
}

TEST(ColumnHead, MayHaveBracketsWithinItsUnit) {
  EXPECT_EQ(divided("Acc (m/(s^2))"), "Acc|m/(s^2)");
  EXPECT_EQ(divided("Torque (N*(m))"), "Torque|N*(m)");
  EXPECT_EQ(divided("Rate (1/(min))"), "Rate|1/(min)");
  EXPECT_EQ(divided("Acc. / (m/s^2)"), "Acc.|m/s^2");
  EXPECT_EQ(divided("Force (load cell) (N)"), "Force (load cell)|N");
}

TEST(ColumnHead, MayHaveItsUnitBehindAColon) {
  EXPECT_EQ(divided("Vel:m/s"), "Vel|m/s");
  EXPECT_EQ(divided("Force:N"), "Force|N");
  EXPECT_EQ(divided("Channel:A"), "Channel:A|");
  EXPECT_EQ(divided("Force:min"), "Force:min|");
  EXPECT_EQ(divided("Flow:in"), "Flow:in|");
}

}  // namespace
}  // namespace impactrig::acquisition
