// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "acquisition/importer.hpp"
#include "acquisition/importers/column_heads.hpp"
#include "tests/acquisition/written_file.hpp"

/// What stands above the rows of a table, as instruments and programs write it.
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

TEST(CsvHeads, ARateOfThousandsIsNoRateOfDecimals) {
  for (const char* rate : {"51,200", "10,000 Hz", "51,200Hz"}) {
    const Record record =
        imported(fmt::format("Sample Rate: {}\nF [N]\td [mm]\n1.5\t2.5\n1.4\t2.6\n", rate));
    EXPECT_EQ(record.channels.at(0).clock.interval, 0.0) << rate;
    EXPECT_THAT(record.warnings, Contains(HasSubstr("may be a decimal mark or divide thousands")))
        << rate;
  }
  const Record record =
      imported("Sample interval: 0,000100 s\nF [N]\td [mm]\n1.5\t2.5\n1.4\t2.6\n");
  EXPECT_EQ(record.channels.at(0).clock.interval, 1e-4) << "no thousands begin with 0";
}

TEST(CsvHeads, ARateMayBeInSamplesASecondAndInGerman) {
  for (const char* key : {"Sampling rate: 10 kS/s", "Sampling rate: 10000 Samples/s",
                          "Sample Rate: 10ksps", "Sample rate: 0.01 MSa/s", "Abtastrate: 10000 Hz",
                          "Abtastfrequenz: 10 kHz", "Time Increment: 1e-4"}) {
    const Record record = imported(std::string(key) + "\nF [N]\td [mm]\n1.5\t2.5\n1.4\t2.6\n");
    EXPECT_DOUBLE_EQ(record.channels.at(0).clock.interval, 1e-4) << key;
    EXPECT_THAT(record.warnings, IsEmpty()) << key;
  }
}

// In UTF-8, as logging programs of these countries write it
TEST(CsvHeads, MayBeChineseJapaneseOrRussian) {
  Record record = imported("采样频率：10 kHz\n力（N）\t位移【mm】\n1.5\t2.5\n1.4\t2.6\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("力 [N]", "位移 [mm]"));
  EXPECT_DOUBLE_EQ(record.channels.at(0).clock.interval, 1e-4);
  EXPECT_THAT(record.warnings, IsEmpty());

  record = imported("加速度（左）,時間,荷重［Ｎ］\n1,0,2\n3,0.1,4\n5,0.2,7\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("加速度（左） []", "荷重 [Ｎ]"));
  EXPECT_EQ(record.channels.at(1).quantity, Quantity::force);
  EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 0.1);

  record = imported("Частота дискретизации: 10 кГц\nСила, кН;Перемещение, мкм\n1,5;2\n1,4;3\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("Сила [кН]", "Перемещение [мкм]"));
  EXPECT_EQ(record.channels.at(1).quantity, Quantity::displacement);
  EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 1e-4);
}

TEST(CsvHeads, KeysBesideTheSamplesGoOnBelowRowsWithout) {
  const Record record = imported(  // as a Tektronix TDS2000 writes it
      "Record Length,2.5e+03,,-00.002,  1.0,\nSample Interval,1.0e-03,,-00.001,  2.0,\n"
      ",,,000.000,  3.0,\n,,,000.001,  4.0,\nSource,CH2,,000.002,  5.0,\n"
      "Vertical Units,V,,000.003,  6.0,\nHorizontal Units,s,,000.004,  7.0,\n"
      ",,,000.005,  8.0,\n,,,000.006,  9.0,\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("CH2 [V]"));
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9));
  EXPECT_EQ(record.channels[0].clock.start, -0.002);
  EXPECT_THAT(record.warnings, IsEmpty());
}

TEST(CsvHeads, ARowWithoutAKeyAmongThoseThatHaveOneIsARow) {
  const Record record = imported(
      "Record Length,500,,0.0,1.0\nTrigger Point,50,,0.5,2.0\n,,,1.0,3.0\n"
      "Horizontal Offset,0.0,,1.5,4.0\n,,,2.0,5.0\n,,,2.5,6.0\n");
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_EQ(record.channels[0].clock.start, 0.0);
}

TEST(CsvHeads, NamesAreNotUnitsOfTheLineAboveThem) {
  EXPECT_THAT(names_and_units(imported("Hammer test of bar 3\nForce (N)\n1\n2\n")),
              ElementsAre("Force [N]"));
  EXPECT_THAT(names_and_units(imported("Hammer test;bar 3\nF1 (N);V1 (V)\n1;4\n2;3\n")),
              ElementsAre("F1 [N]", "V1 [V]"));
  EXPECT_THAT(names_and_units(imported("Operator,Smith\nforce,acc\n3,4\n1,2\n2,3\n")),
              ElementsAre("force []", "acc []"));
  const Record record = imported("Test 1;hammer;bar\nt;F;a\n0,0;1;5\n0,1;3;4\n0,2;2;7\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("F []", "a []"));
  EXPECT_DOUBLE_EQ(record.channels.at(0).clock.interval, 0.1);
}

TEST(CsvHeads, NamesMayBeNumbersBesideATime) {
  const Record record = imported("Time [ms];1;2;3\n0.0;5.5;6;7.5\n0.1;4.5;3;9.5\n0.2;4;3;9\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("CH 1 []", "CH 2 []", "CH 3 []"));
  EXPECT_DOUBLE_EQ(record.channels.at(0).clock.interval, 1e-4);
  EXPECT_THAT(record.warnings, IsEmpty());
  EXPECT_THAT(names_and_units(imported("time,0,45\nms,N,N\n0.0,5.5,6.5\n0.1,4.5,3.5\n")),
              ElementsAre("CH 0 [N]", "CH 45 [N]"));
  // a key and its values
  EXPECT_THAT(names_and_units(imported("Time,12.5,13.5\n0.0,5.5,6.5\n0.1,4.5,3.5\n")),
              ElementsAre("column 1 []", "column 2 []"));
}

TEST(CsvHeads, NamesOfQuantitiesMayEndWithAUnit) {
  const Record record = imported(
      "time_ms,force_N,F_kN,velocity_tip_mm_s,v_m_s,disp_um,acc_m_s2\n"
      "0,1,2,3,4,5,6\n1,2,3,4,5,6,7\n");
  EXPECT_THAT(names_and_units(record),
              ElementsAre("force_N [N]", "F_kN [kN]", "velocity_tip_mm_s [mm/s]", "v_m_s [m/s]",
                          "disp_um [um]", "acc_m_s2 [m/s2]"));
  EXPECT_EQ(record.channels.at(0).quantity, Quantity::force);
  // no quantity, or a unit of another
  for (const char* name : {"ch_N", "force_top", "force_mm", "A_V", "velocity_N", "forces_N"})
    EXPECT_EQ(split_head(name).unit, "") << name;
}

TEST(CsvHeads, AnIndexInBracketsIsNoUnit) {
  const Record record = imported(  // as LabVIEW exports waveforms to a spreadsheet
      "waveform\t[0]\t[1]\nt0\t03/12/2021 10:11:12.5\t03/12/2021 10:11:12.5\n"
      "delta t\t0.500000\t0.500000\n\ntime\tY[0]\tY[1]\n"
      "03/12/2021 10:11:12.5\t1.5\t2.5\n03/12/2021 10:11:13.0\t3.5\t4.5\n"
      "03/12/2021 10:11:13.5\t5.5\t6.5\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("Y[0] []", "Y[1] []"));
  EXPECT_EQ(record.channels.at(0).clock.interval, 0.5);
  EXPECT_THAT(record.warnings, IsEmpty());
}

TEST(CsvHeads, OneInBracketsBehindABlankIsTheUnitOfARatio) {
  EXPECT_THAT(names_and_units(imported("t [s];strain [1]\n0;1.5\n1;2.5\n2;0.5\n")),
              ElementsAre("strain [1]"));
}

TEST(CsvHeads, ARatePerSecondIsNoTime) {
  const Record record = imported("strain,strain rate 1/s\n0.5,1\n0.25,2\n0.75,3\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("strain []", "strain rate [1/s]"));
  EXPECT_EQ(record.channels.at(0).clock.interval, 0.0);
  EXPECT_THAT(names_and_units(imported("Time 1/s,Force 1/N\n0,1\n1,2\n2,3\n")),
              ElementsAre("Force 1 [N]"));
}

TEST(CsvHeads, KeysMayListOneValueAChannel) {
  const std::string head =  // as a Yokogawa DL850 writes it
      "\"Model Name\",\"DL850\"\n\"TraceName\",\"Hammer\",\"Beam\"\n\"BlockSize\",4,4\n"
      "\"VUnit\",\"N\",\"m/s\"\n\"SampleRate\",2.0E+00,2.0E+00\n"
      "\"HResolution\",5.0E-01,5.0E-01\n\"HOffset\",-1.0E+00,-1.0E+00\n\"HUnit\",\"s\",\"s\"\n"
      "\"Date\",\"2021/03/12\",\"2021/03/12\"\n\"Time\",\"10:11:12.1234\",\"10:11:12.1234\"\n\n";
  const Record record = imported(head + ",1.5E+00,4.0,\n,2.5E+00,3.0,\n,0.5,2.0,\n,1.0,1.0,\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("Hammer [N]", "Beam [m/s]"));
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(1.5, 2.5, 0.5, 1.0));
  EXPECT_EQ(record.channels[1].clock.start, -1.0);
  EXPECT_EQ(record.channels[1].clock.interval, 0.5);
  EXPECT_EQ(record.channels[1].quantity, Quantity::velocity);
  EXPECT_THAT(record.warnings, IsEmpty());
  const Record timed =
      imported(head + "-1.0,1.5,4.0,\n-0.5,2.5,3.0,\n0.0,0.5,2.0,\n0.5,1.0,1.0,\n");
  EXPECT_THAT(names_and_units(timed), ElementsAre("Hammer [N]", "Beam [m/s]"));
  EXPECT_EQ(timed.channels.at(0).clock.start, -1.0);
  EXPECT_EQ(timed.channels[0].clock.interval, 0.5);
  EXPECT_THAT(timed.warnings, IsEmpty());
}

TEST(CsvHeads, KeysMayStateTheClockOfOneColumn) {
  const Record record = imported(  // as an Agilent Infiniium writes it
      "Revision:,0\nType:,Raw\nPoints:,3\nXInc:,5.0E-07\nXOrg:,-1.0E-06\nDate:,12-MAR-2021\n"
      "Time:,10:11:12\nX Units:,second\nY Units:,Volt\nData:,\n1.5E-3\n-2.5E-3\n3.5E-3\n");
  EXPECT_EQ(record.channels.at(0).unit, "Volt");
  EXPECT_EQ(record.channels[0].clock.interval, 5e-7);
  EXPECT_EQ(record.channels[0].clock.start, -1e-6);
  EXPECT_THAT(record.channels[0].values(), ElementsAre(1.5e-3, -2.5e-3, 3.5e-3));
}

TEST(CsvHeads, KeysMayStandAmongNames) {
  const Record record = imported(  // as a Rigol MSO5000 writes it
      "CH1(V),CH2(V),t0 = -5.0e-04, tInc = 1.0e-06,\n1.5e-1,2,,,\n2.5e-1,4,,,\n0.5,3,,,\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("CH1 [V]", "CH2 [V]"));
  EXPECT_EQ(record.channels.at(0).clock.start, -5e-4);
  EXPECT_EQ(record.channels[0].clock.interval, 1e-6);
  EXPECT_THAT(record.warnings, IsEmpty());
  const Record timed =
      imported("Time(s),CH1(V),t0 =-1.0e-06, tInc = 1.0e-06,\n-1e-6,2,,,\n0,4,,,\n1e-6,3,,,\n");
  EXPECT_THAT(names_and_units(timed), ElementsAre("CH1 [V]"));
  EXPECT_EQ(timed.channels.at(0).clock.start, -1e-6);
}

TEST(CsvHeads, OfLabChartAreKeysDividedByTabs) {
  const Record record = imported(
      "Interval=\t0.5 s\nChannelTitle=\tForce\tAcc\nRange=\t10.000 V\t5.000 V\nUnitName=\tN\tg\n"
      "BottomValue=\t-10\t-5\n0.0\t1.5\t4\n0.5\t2.5\t3\n1.0\t0.5\t2\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("Force [N]", "Acc [g]"));
  EXPECT_EQ(record.channels.at(0).clock.interval, 0.5);
}

// [ADInstruments: an export without units ends its head with the ranges]
TEST(CsvHeads, OfLabChartMayEndInRangesAndHaveNoUnits) {
  const std::string keys =
      "Interval=\t0.5 s\nChannelTitle=\tForce\tAcc\nRange=\t10.000 V\t5.000 V\n";
  const std::string rows = "0.0\t1.5\t4\n0.5\t2.5\t3\n1.0\t0.5\t2\n";
  EXPECT_THAT(names_and_units(imported(keys + rows)), ElementsAre("Force []", "Acc []"));
  EXPECT_THAT(names_and_units(imported(keys + "UnitName=\t*\tg\n" + rows)),
              ElementsAre("Force []", "Acc [g]"));
  // two blocks, of which the second begins at 0 again
  const std::string head = keys + "UnitName=\tN\tg\n";
  EXPECT_THAT(names_and_units(imported(head + rows + head + rows)),
              ElementsAre("column 0 []", "Force [N]", "Acc [g]"));
}

// The counts of samples above the rows are no sample; times may be there, and counts above them.
TEST(CsvHeads, OfAcqKnowledgeHaveALineForEachNameAndUnit) {
  const std::string head = "shot.acq\n0.5 msec/sample\n2 channels\nForce - HLT100C\nN\nAcc\ng\n";
  for (const std::string rows :
       {"CH1\tCH2\t\n3\t3\t\n1.5\t4\t\n2.5\t3\t\n0.5\t2\t\n", "CH1\tCH2\n1.5\t4\n2.5\t3\n0.5\t2\n",
        "milliSec\tCH1\tCH2\n\t3\t3\n0\t1.5\t4\n0.5\t2.5\t3\n1.0\t0.5\t2\n",
        "milliSec\tCH1\tCH2\n0\t1.5\t4\n0.5\t2.5\t3\n1.0\t0.5\t2\n"}) {
    const Record record = imported(head + rows);
    EXPECT_THAT(names_and_units(record), ElementsAre("Force - HLT100C [N]", "Acc [g]")) << rows;
    EXPECT_THAT(record.channels.at(0).values(), ElementsAre(1.5, 2.5, 0.5)) << rows;
    EXPECT_NEAR(record.channels[0].clock.interval, 0.5e-3, 1e-15) << rows;
  }
}

// [Gulf Coast Data Concepts, X16-1D user manual, figure 19]
TEST(CsvHeads, OfGulfCoastDataConceptsNameTheTimeSecond) {
  const Record record = imported(
      ";Title, http://www.gcdataconcepts.com, x16-1d, ADXL345\n;Start_time, 2016-01-04, "
      "10:25:14.000\n;SampleRate, 100,Hz\n;Headers, time,Ax,Ay,Az\n0.003,799,650,-1773\n"
      "0.013,805,661,-1808\n0.023,816,687,-1844\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("Ax []", "Ay []", "Az []"));
  EXPECT_THAT(record.channels[0].values(), ElementsAre(799, 805, 816));
  EXPECT_NEAR(record.channels[0].clock.start, 0.003, 1e-12);
  EXPECT_NEAR(record.channels[0].clock.interval, 0.01, 1e-12);
  EXPECT_EQ(record.started, "2016-01-04T10:25:14");
}

// [GW Instek, OpenWave-1KB]: a line a key; a waveform in a file of its own kind has them in one.
TEST(CsvHeads, OfInstekBeginWithTheirFormat) {
  const Record record = imported(
      "Format,1.0B,\nMemory Length,3,\nSource,CH1,\nVertical Units,V,\nVertical Scale,1.0,\n"
      "Horizontal Units,S,\nSampling Period,5.0e-01,\nMode,Detail,\nWaveform Data,\n"
      "-5.0e-01,1.5,\n0.0,2.5,\n5.0e-01,0.5,\n");
  ASSERT_EQ(record.channels.size(), 1U);
  EXPECT_EQ(record.channels[0].unit, "V");
  EXPECT_EQ(record.channels[0].clock.start, -0.5);
  EXPECT_EQ(record.channels[0].clock.interval, 0.5);
}

TEST(CsvHeads, NamesAndUnitsMayStandBehindKeys) {
  for (const char* head :
       {"Channel:,Force,Acc\nUnit:,N,g\n", "Name,Force,Acc\nUnits,N,g\nRange,5,5\n",
        "Channel,1,2\nLabel,Force,Acc\nType,A,B\nUnit,N,g\nTime (s),,\n"}) {
    const Record record = imported(std::string(head) + "0.0,1.5,4\n0.5,2.5,3\n1.0,0.5,2\n");
    EXPECT_THAT(names_and_units(record), ElementsAre("Force [N]", "Acc [g]")) << head;
    EXPECT_EQ(record.channels.at(0).clock.interval, 0.5) << head;
  }
  EXPECT_THAT(names_and_units(imported("Name,Smith\nRange,5\n1,2.5\n1.5,2\n3,1\n")),
              ElementsAre("column 1 []"));
}

TEST(CsvHeads, OfCampbellLoggersAreThreeLines) {
  const Record record = imported(
      "\"TOA5\",\"CR1000\",\"1234\"\n\"TIMESTAMP\",\"RECORD\",\"Force_Avg\"\n"
      "\"TS\",\"RN\",\"N\"\n\"\",\"\",\"Avg\"\n\"2021-03-12 10:11:12.00\",7,1.5\n"
      "\"2021-03-12 10:11:12.05\",8,2.5\n\"2021-03-12 10:11:12.10\",9,0.5\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("RECORD []", "Force_Avg [N]"));
  EXPECT_NEAR(record.channels.at(0).clock.interval, 0.05, 1e-12);
}

TEST(CsvHeads, SOfTheHorizontalAxisIsASecond) {
  const Record record = imported(
      "Source,CH1,\nVertical Units,V,\nHorizontal Units,S,\nWaveform Data,,\n0.0,1.5,\n"
      "0.5,2.5,\n1.0,0.5,\n");
  ASSERT_EQ(record.channels.size(), 1U);
  EXPECT_EQ(record.channels[0].unit, "V");
  EXPECT_EQ(record.channels[0].clock.interval, 0.5);
}

TEST(CsvHeads, NamesMayBeListedALineAColumn) {
  for (const char* head :
       {"# 1: time [ms]\n# 2: force [kN]\n", "% Column 1 = time [ms]\n% Column 2 = force [kN]\n",
        "shot 7\n# col0: time (ms)\n# col1: force (kN)\n"}) {
    const Record record = imported(std::string(head) + "0.0 1.5\n0.1 2.5\n0.2 0.5\n");
    EXPECT_THAT(names_and_units(record), ElementsAre("force [kN]")) << head;
    EXPECT_DOUBLE_EQ(record.channels.at(0).clock.interval, 1e-4) << head;
    EXPECT_THAT(record.warnings, IsEmpty()) << head;
  }
}

TEST(CsvHeads, ChannelsMayBeListedALineAChannel) {
  for (const char* head :
       {"Ch1: Force / kN\nCh2: Velocity / m/s\nRate: 10 kHz\n",
        "Channel 1: Force [kN]\nChannel 2: Velocity [m/s]\nFs = 10 kHz\n",
        "Sampling rate: 10 kHz\nKanal 1 = Force (kN)\nKanal 2 = Velocity (m/s)\n"}) {
    const Record record = imported(std::string(head) + "0.0\t1.5\n0.1\t2.5\n0.2\t0.5\n");
    EXPECT_THAT(names_and_units(record), ElementsAre("Force [kN]", "Velocity [m/s]")) << head;
    EXPECT_DOUBLE_EQ(record.channels.at(0).clock.interval, 1e-4) << head;
  }
  const Record from_zero = imported("Ch0: Force [N]\nCh1: Weg [mm]\n0.2\t1.5\n0.1\t2.5\n");
  EXPECT_THAT(names_and_units(from_zero), ElementsAre("Force [N]", "Weg [mm]"));
  const Record words = imported(
      "Ch1: Full bridge [mV/V]\nCh2: Peak force [N]\nRate: 10 kHz\n0.0\t1.5\n0.1\t2.5\n0.2\t0.5\n");
  EXPECT_THAT(names_and_units(words), ElementsAre("Full bridge [mV/V]", "Peak force [N]"));
  const Record timed = imported("CH1: Force [N]\nCH2: Weg [mm]\n0,1,2\n0.5,3,4\n1,5,6\n");
  EXPECT_THAT(names_and_units(timed), ElementsAre("Force [N]", "Weg [mm]"));
  EXPECT_EQ(timed.channels.at(0).clock.interval, 0.5);
}

// Ranges of an oscilloscope's channels, and names that follow the list.
TEST(CsvHeads, WhatIsListedAChannelMayBeNoName) {
  const Record ranges =
      imported("CH1: 500 mV\nCH2: 2 V\nTime [s],Force [N],Weg [mm]\n0,1,2\n0.5,3,4\n1,5,6\n");
  EXPECT_THAT(names_and_units(ranges), ElementsAre("Force [N]", "Weg [mm]"));
  const Record above = imported(
      "Time,Force,Velocity\ns,N,m/s\nChannel 1: Kistler [pC]\nChannel 2: Polytec [V]\n"
      "0,1,2\n0.5,3,4\n1,5,6\n");
  EXPECT_THAT(names_and_units(above), ElementsAre("Force [N]", "Velocity [m/s]"));
  const Record others =
      imported("Time [s],Force [N]\nCh1: Trigger / V\nCh2: Aux / V\n0,1\n0.5,3\n1,5\n");
  EXPECT_THAT(names_and_units(others), ElementsAre("Force [N]"));
  const Record figures = imported("Ch1: Range / N\nCh2: full scale / V\n0,1,2\n0.5,3,4\n1,5,6\n");
  EXPECT_THAT(figures.channels.at(0).unit, "");
  const Record named = imported(
      "Ch1: sensor 12 [N]\nCh2: sensor 14 [mm]\nTime [s],Force [N],Weg [mm]\n0,1,2\n0.5,3,4\n"
      "1,5,6\n");
  EXPECT_THAT(names_and_units(named), ElementsAre("Force [N]", "Weg [mm]"));
}

TEST(CsvHeads, LinesOfEachChannelMayStandUnderItsUnit) {
  const Record record = imported(  // as catman and Testlab write them
      "Zeit  1 - Standardmessrate\tKraft\tBeschl\ns\tN\tm/s\xB2\nM 0\tSN 123\tSN 44\n"
      "Zeit\tC9C\tPCB\n0,0\t1,5\t4\n0,5\t2,5\t3\n1,0\t0,5\t2\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("Kraft [N]", "Beschl [m/s\u00B2]"));
  EXPECT_EQ(record.channels.at(0).clock.interval, 0.5);
  EXPECT_THAT(record.warnings, IsEmpty());
}

TEST(CsvHeads, ARuleMayStandUnderNamesAndUnits) {
  for (const char* head : {"  Time  Force\n  (ms)   (kN)\n------  -----\n",
                           "Time [ms]  Force [kN]\n---------  ----------\n"}) {
    const Record record = imported(std::string(head) + "0.0 1.5\n0.1 2.5\n0.2 0.5\n");
    EXPECT_THAT(names_and_units(record), ElementsAre("Force [kN]")) << head;
    EXPECT_DOUBLE_EQ(record.channels.at(0).clock.interval, 1e-4) << head;
    EXPECT_THAT(record.warnings, IsEmpty()) << head;
  }
}

TEST(CsvHeads, ANoBreakSpaceIsNoPartOfAName) {
  EXPECT_THAT(names_and_units(imported("Time\u00A0[s];Force\u00A0[N]\n0;1.5\n1;2.5\n2;0.5\n")),
              ElementsAre("Force [N]"));
}

TEST(CsvHeads, UnitsMayStandAboveNames) {
  const Record record = imported("ms,kN,m/s\nTime,Force,Velocity\n0.0,1.5,3\n0.1,2.5,2\n0.2,0,1\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("Force [kN]", "Velocity [m/s]"));
  EXPECT_DOUBLE_EQ(record.channels.at(0).clock.interval, 1e-4);
}

TEST(CsvHeads, ASemicolonMayBeginARemark) {
  const Record record = imported("; t[ms] ; F[kN]\n0.0;1.5\n0.1;2.5\n0.2;0.5\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("F [kN]"));
  EXPECT_DOUBLE_EQ(record.channels.at(0).clock.interval, 1e-4);
}

TEST(CsvHeads, ArduinosClocksHaveAUnit) {
  EXPECT_DOUBLE_EQ(
      imported("micros,ax\n1000,1.5\n1100,2.5\n1200,0.5\n").channels.at(0).clock.interval, 1e-4);
  EXPECT_DOUBLE_EQ(
      imported("millis,ax\n1000,1.5\n1010,2.5\n1020,0.5\n").channels.at(0).clock.interval, 1e-2);
}

TEST(CsvHeads, OfSignalExpressNameTheTime) {
  const Record record =
      imported("Time - Voltage\tAmplitude - Voltage\n0.0\t1.5\n0.5\t2.5\n1.0\t0.5\n");
  ASSERT_EQ(record.channels.size(), 1U);
  EXPECT_EQ(record.channels[0].clock.interval, 0.5);
}

TEST(CsvCells, MayHaveBlanksBehindTheirSign) {
  const Record record =
      imported("t [s],T [degC],F [N]\n0,+  25.0,-   1.5\n1,-   3.5,+  12.0\n2,+   0.0,- 2\n");
  ASSERT_EQ(record.channels.size(), 2U);
  EXPECT_THAT(record.channels[0].values(), ElementsAre(25.0, -3.5, 0.0));
  EXPECT_THAT(record.channels[1].values(), ElementsAre(-1.5, 12.0, -2.0));
  EXPECT_THAT(record.warnings, IsEmpty());
}

TEST(CsvTimes, ThatFallAreNotRounded) {
  std::string text = "time [s],F [N]\n";
  for (int i = 0; i < 40; ++i) text += fmt::format("{:.4f},{}\n", -1e-3 + i % 20 * 1e-4, i % 7);
  const Record record = imported(text);
  EXPECT_FALSE(record.channels.at(0).clock.uniform());
  EXPECT_THAT(record.warnings, ElementsAre(HasSubstr("time does not increase from sample 19")));
}

// Looked for rows in the first 256 KiB alone, which a scan of so many points fills with its names.
TEST(CsvHeads, MayBeLongerThanHundredsOfKilobytes) {
  constexpr int points = 8000;
  std::string text = "Scan\ntime [s]";
  for (int k = 0; k < points; ++k) text += fmt::format(",Vib 3D point {:05} velocity X [m/s]", k);
  ASSERT_GT(text.size(), 256U * 1024U);
  for (int i = 0; i < 5; ++i) {
    text += fmt::format("\n{:.3f}", 1e-3 * i);
    for (int k = 0; k < points; ++k) text += fmt::format(",{}", 10 * k + i);
  }
  const Record record = imported(text + "\n");
  ASSERT_EQ(record.channels.size(), static_cast<std::size_t>(points));
  EXPECT_EQ(record.channels.back().name, "Vib 3D point 07999 velocity X");
  EXPECT_EQ(record.channels.back().unit, "m/s");
  EXPECT_THAT(record.channels.back().values(), ElementsAre(79990, 79991, 79992, 79993, 79994));
  EXPECT_EQ(record.channels.back().clock.interval, 1e-3);
}

}  // namespace
}  // namespace impactrig::acquisition
