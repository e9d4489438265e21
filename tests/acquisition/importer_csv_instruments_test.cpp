// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <array>

#include "acquisition/importer.hpp"
#include "acquisition/importers/formats.hpp"
#include "tests/acquisition/large_texts.hpp"
#include "tests/acquisition/written_file.hpp"

/// Tables as one instrument or program writes them.
namespace impactrig::acquisition {
namespace {

using datasets::Record;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using tests::import_error;
using tests::imported;
using tests::names_and_units;

TEST(SignalExpress, KeysStandOnTheLineAboveTheirValues) {
  const Record record = imported(
      "channel names: \r\nDev1 ai0\tDev1 ai1\r\nstart times: \r\n"
      "3/15/2014 10:11:12.500000\t3/15/2014 10:11:12.500000\r\ndt: \r\n0.000100\t0.000100\r\n"
      "data: \r\n1.5\t-2.0\r\n2.5\t-3.0\r\n0.5\t-4.0\r\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("Dev1 ai0 []", "Dev1 ai1 []"));
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(1.5, 2.5, 0.5));
  EXPECT_DOUBLE_EQ(record.channels[1].clock.interval, 1e-4);
  EXPECT_EQ(record.started, "2014-03-15T10:11:12.5");
  EXPECT_THAT(record.warnings, IsEmpty());
}

TEST(SignalExpress, MayHaveOneChannelAndDecimalCommas) {
  const Record record = imported(
      "channel names: \r\nhammer\r\nstart times: \r\n15.03.2014 10:11:12,500000\r\ndt: \r\n"
      "0,000100\r\ndata: \r\n1,5\r\n2,5\r\n0,5\r\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("hammer []"));
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(1.5, 2.5, 0.5));
  EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 1e-4);
  EXPECT_EQ(record.started, "2014-03-15T10:11:12.5");
}

// 1/51200 s is printed as 0.000020 too
TEST(SignalExpress, KeysOfOtherEncodingsBecomeUtf8) {
  const Record record =
      imported("channel names: \nF\nM\xE4nner: \nx\ndt: \n0.5\ndata: \n1\n2\n3\n");
  EXPECT_EQ(record.attributes.at("m\u00E4nner"), "x");
}

TEST(SignalExpress, AnIntervalOfFewDigitsIsToldOf) {
  const Record record = imported(
      "channel names:\na\tb\nstart times:\n3/15/2014 10:11:12.0\t3/15/2014 10:11:13.0\ndt:\n"
      "0.000020\t0.000020\ndata:\n1.5\t2.5\n1.4\t2.6\n");
  EXPECT_DOUBLE_EQ(record.channels.at(0).clock.interval, 2e-5);
  EXPECT_THAT(record.warnings,
              ElementsAre("the channels begin at different times by 'start times': all are taken "
                          "to begin with the first row",
                          "the header states 'dt' as '0.000020', whose decimals leave it open by 2 "
                          "%: --sample-rate states the rate"));
}

std::string owon(std::string_view interval) {
  return fmt::format(  // as an HDS242 writes it
      "Channel\t\t\t  :,CH1,CH2\r\nFrequency\t\t\t  :,F=1.498kHz,F=  ?\r\n"
      "Voltage per ADC value:,20.00mV,20.00mV\r\nTime interval\t\t\t  :,{0},{0}\r\n\r\n"
      "index,CH1_Voltage(mV),CH2_Voltage(mV)\r\n0,380.00,1.00\r\n1,-360.00,2.00\r\n"
      "2,20.00,3.00\r\n",
      interval);
}

TEST(Owon, TheTimeIntervalIsTheClock) {
  const Record record = imported(owon("100.00uS"));
  EXPECT_THAT(names_and_units(record), ElementsAre("CH1_Voltage [mV]", "CH2_Voltage [mV]"));
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(380, -360, 20));
  EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 1e-4);
  EXPECT_THAT(record.warnings, IsEmpty());
}

// 8 ns are printed as 0.01uS
TEST(Owon, ATimeIntervalOfFewDigitsIsToldOf) {
  const Record record = imported(owon("0.08uS"));
  EXPECT_DOUBLE_EQ(record.channels.at(0).clock.interval, 8e-8);
  EXPECT_THAT(record.warnings, ElementsAre(HasSubstr("'0.08uS', whose decimals leave it open by 6 "
                                                     "%: --sample-rate states the rate")));
}

// a GL240: milliseconds in a column of their own, units below the names
std::string gl240() {
  return "Vendor,\"GRAPHTEC Corporation\"\nModel,\"GL240\"\nSampling interval,200ms\n"
         "Start time,2026/09/24,09:09:54\nAMP settings\nCH,Signal "
         "name,Input,Range,Filter,Span,,Unit\n"
         "CH1,\"hammer\",\"DC\",100mV,Off,+50.00,-50.00,[mV]\n"
         "CH2,\"beam\",\"DC\",5V,Off,+5.000,-5.000,[V]\nData\n"
         "Number,Date&Time,ms,CH1,CH2,Alarm1-10,AlarmOut\n"
         "NO.,Time,ms,\"mV\",\"V\",\"A1234567890\",\"AO1234\"\n"
         "         1,2026/09/24 09:09:54,  0,+    1.50,-    2.000,LLLLLLLLLL,LLLL\n"
         "         2,2026/09/24 09:09:54,200,+    2.50,+++++++,LLLLLLLLLL,LLLL\n"
         "         3,2026/09/24 09:09:54,400,+    0.50,BURNOUT,LLLLLLLLLL,LLLL\n"
         "         4,2026/09/24 09:09:54,600,+    0.50,-    1.000,LLLLLLLLLL,LLLL\n"
         "         5,2026/09/24 09:09:54,800,+    0.50,-    1.000,LLLLLLLLLL,LLLL\n"
         "         6,2026/09/24 09:09:55,  0,+    0.50,-    1.000,LLLLLLLLLL,LLLL\n";
}

TEST(Graphtec, MillisecondsBesideTheTimeBelongToIt) {
  const Record record = imported(gl240());
  EXPECT_THAT(names_and_units(record), ElementsAre("CH1 [mV]", "CH2 [V]"));
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(1.5, 2.5, 0.5, 0.5, 0.5, 0.5));
  EXPECT_THAT(record.channels[1].valid, ElementsAre(1, 0, 0, 1, 1, 1));
  EXPECT_EQ(record.channels[0].attributes.at("description"), "hammer");
  EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 0.2);
  EXPECT_TRUE(record.channels[0].clock.uniform());
  EXPECT_EQ(record.started, "2026-09-24T09:09:54");
  EXPECT_THAT(record.warnings,
              ElementsAre(HasSubstr("'Alarm1-10' holds text"), HasSubstr("'AlarmOut' holds text"),
                          HasSubstr("2 of 6 values are missing, the first, written '+++++++'")));
}

// a GL980: date, time and microseconds, units in the settings; here with decimal commas
TEST(Graphtec, UnitsMayStandInTheSettingsOfTheAmplifier) {
  const std::string head =
      "Vendor;GRAPHTEC Corporation\nModel;GL980\nVersion;Ver1,35;Rev0001\n"
      "Sampling interval;100us\nStart time;2026/06/01;17:01:39\nAMP settings\n"
      "CH;Signal name;Amp;Input;Range;Filter;Span;;Unit\nCH3;hammer;M;DC;50V;Off;25;-25;N\n"
      "CH4;;M;DC;50mV;Off;10;-10;A\nPosition/Vernier settings\nCH;Position;Vernier\n"
      "CH3;50%;100,00%\nData\nNumber;Date;Time;us;CH3;CH4;Alarm;AlarmOut\n";
  const std::string row = "2026/06/01;17:01:";
  const Record record = imported(head + "1;" + row + "39;999800;+1,500;-2,0000;LLLLLLLLLL;LLLL\n" +
                                 "2;" + row + "39;999900;+2,500;-3,0000;LLLLLLLLLL;LLLL\n" + "3;" +
                                 row + "40;0;+0,500;-4,0000;LLLLLLLLLL;LLLL\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("CH3 [N]", "CH4 [A]"));
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(1.5, 2.5, 0.5));
  EXPECT_THAT(record.channels[1].values(), ElementsAre(-2, -3, -4));
  EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 1e-4);
  EXPECT_EQ(record.started, "2026-06-01T17:01:39.9998");
  EXPECT_THAT(record.warnings,
              ElementsAre(HasSubstr("'Alarm' holds text"), HasSubstr("'AlarmOut' holds text")));
}

std::string tds_row(std::string_view keys, double time, double value) {
  return fmt::format("{},{:016.9f}, {:9.5f},", keys, time, value);
}

std::string tds_side_by_side(std::string_view between) {
  constexpr std::array<std::array<std::string_view, 2>, 7> keys = {{
      {"Record Length,2.5e+03,", "Record Length,2.5e+03,"},
      {"Sample Interval,1.0e-03,", "Sample Interval,1.0e-03,"},
      {",,", ",,"},
      {"Source,CH1,", "Source,MATH,"},
      {"Vertical Units,V,", "Vertical Units,A,"},
      {"Horizontal Units,s,", "Horizontal Units,s,"},
      {"Vertical Scale,5.0e-01,", "Vertical Scale,2.0e+00,"},
  }};
  std::string text;
  for (int i = 0; i < 12; ++i) {
    const auto& key =
        i < 7 ? keys[static_cast<std::size_t>(i)] : std::array<std::string_view, 2>{",,", ",,"};
    text += tds_row(key[0], 1e-3 * (i - 2), 0.5 * i) + std::string(between) +
            tds_row(key[1], 1e-3 * (i - 4), -1.0 * i) + "\n";
  }
  return text;
}

// F0000CH1.CSV and F0000MTH.CSV of a TDS2000, pasted into one file
TEST(Tektronix, TablesSideBySideHaveKeysTimesAndUnitsOfTheirOwn) {
  for (const std::string_view between : {"", ","}) {
    const Record record = imported(tds_side_by_side(between));
    EXPECT_THAT(names_and_units(record), ElementsAre("CH1 [V]", "MATH [A]")) << between;
    ASSERT_EQ(record.channels.size(), 2U);
    EXPECT_EQ(record.channels[0].size(), 12U);
    EXPECT_EQ(record.channels[0].values()[3], 1.5);
    EXPECT_EQ(record.channels[1].values()[3], -3.0);
    EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 1e-3);
    EXPECT_DOUBLE_EQ(record.channels[0].clock.start, -2e-3);
    EXPECT_DOUBLE_EQ(record.channels[1].clock.start, -4e-3);
    EXPECT_EQ(record.attributes.at("Vertical Scale"), "5.0e-01");
    EXPECT_EQ(record.attributes.at("Vertical Scale (MATH)"), "2.0e+00");
    EXPECT_THAT(record.warnings, IsEmpty());
  }
}

/// As a GDS-1000 saves what it shows.
std::string gds1000(std::string_view mode) {
  return fmt::format(
      "Memory Length,4,\nTrigger Level,0.0E+00,\nSource,CH1,\nProbe,10X,\nVertical Units,V,\n"
      "Vertical Scale,5.0E-01,\nVertical Position,1.0E-01,\nHorizontal Units,S,\n"
      "Horizontal Scale,2.5E-04,\nHorizontal Position,1.0E-05,\nHorizontal Mode,Main,\n"
      "Sampling Period,1.0E-06,\nFirmware,V1.13,\nTime, ,\nMode,{},\nWaveform Data,\n"
      "-23,\n0,\n28,\n25,\n",
      mode);
}

// "if the raw data for a point is 001C (=28 decimal) then, (28/25) x 0.5 = 0.56V"
TEST(Instek, LevelsAreTwentyFiveADivisionAboutTheMiddle) {
  const Record record = imported(gds1000("Fast"));
  EXPECT_THAT(names_and_units(record), ElementsAre("Waveform Data [V]"));
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(-0.46, 0.0, 0.56, 0.5));
  EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 1e-6);
  EXPECT_DOUBLE_EQ(record.channels[0].clock.start, 1e-5 - 2e-6);
  EXPECT_THAT(record.warnings, ElementsAre(HasSubstr("are the levels of the screen, 25 a division: "
                                                     "they are taken in the unit of 'Vertical "
                                                     "Scale', 0.5 a division")));
  EXPECT_EQ(imported(gds1000("Detail")).channels.at(0).values()[2], 28.0);
}

TEST(Keysight, LogicLinesHaveNoUnitBesideNumberedChannels) {
  const Record record = imported(
      "x-axis,1,2,D0-D7\nsecond,Volt,Volt,\n-4e-06,0.5,1.5,3\n-2e-06,0.25,1.0,2\n0,0,0.5,3\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("CH 1 [Volt]", "CH 2 [Volt]", "D0-D7 []"));
  EXPECT_DOUBLE_EQ(record.channels.at(0).clock.interval, 2e-6);
  EXPECT_THAT(record.warnings, IsEmpty());
}

/// The head of an MSO2000 or TBS1000C, its times in so few digits that steps differ.
std::string tek(double interval) {
  std::string text = fmt::format(
      "Model,TBS1052C\nFirmware Version,1.3\n\nPoint Format,Y\nHorizontal Units,S\n"
      "Sample Interval,{}\nRecord Length,200\nVertical Units,V\nLabel,\nTIME,CH1\n",
      interval);
  for (int i = 0; i < 200; ++i) text += fmt::format("{:.3e},{}\n", -0.32 + 3.2e-4 * i, i % 7);
  return text;
}

TEST(Tektronix, TheIntervalOfTheHeadIsTheClockOfTimesThatAreRounded) {
  const Record record = imported(tek(0.00032));
  ASSERT_TRUE(record.channels.at(0).clock.uniform());
  EXPECT_EQ(record.channels[0].clock.interval, 0.00032);
  EXPECT_THAT(record.warnings,
              ElementsAre("the times are rounded to 0.0001 s: they are taken as uniform, with the "
                          "interval of 0.00032 s that is stated"));
  EXPECT_FALSE(imported(tek(0.00031)).channels.at(0).clock.uniform());  // samples may be lost
}

TEST(Tektronix, UnitsOfAFurtherBlockStandOverItsColumns) {
  const Record record = imported(
      "Model,MDO3014\nWaveform Type,ANALOG,,Waveform Type,DIGITAL,\n"
      "Vertical Units,V,,Vertical Units,V,V\nTIME,CH1,,TIME,D1,D0\n"
      "0,0.5,,0,1,0\n1e-6,0.25,,1e-6,1,1\n2e-6,0.5,,2e-6,0,1\n");
  const auto units = names_and_units(record);
  EXPECT_THAT(units, testing::Contains("D1 [V]"));
  EXPECT_THAT(units, testing::Contains("D0 [V]"));
}

TEST(InstrumentTables, AreReadByBlocksAsTheyAreReadAtOnce) {
  for (const std::string& text :
       {gl240(), tds_side_by_side(","), owon("2.00uS"), gds1000("Fast"), tek(0.00032)}) {
    const tests::WrittenFile file(text, ".csv");
    tests::expect_same(read_into_memory(*open_csv_by_blocks(file.path(), {}), {}),
                       read_into_memory(*open_csv(file.path(), {}), {}));
  }
}

TEST(Digilent, TheHeadSaysWhenTheRecordingBegan) {
  const auto started = [](std::string_view date) {
    return imported(fmt::format("#Digilent WaveForms Oscilloscope Acquisition\n#Date Time: {}\n"
                                "#Sample rate: 160000Hz\n\nTime (s),Channel 1 (V)\n"
                                "0,1\n0.00000625,2\n0.0000125,3\n",
                                date))
        .started;
  };
  EXPECT_EQ(started("2022-02-24 14:09:15.986"), "2022-02-24T14:09:15.986");
  EXPECT_EQ(started("24/02/2022 14:09:15"), "2022-02-24T14:09:15");
  EXPECT_EQ(started("02/01/2023 11:47:35"), "");  // of January or of February
  EXPECT_EQ(started("14:09:15"), "");
}

TEST(Siglent, AnIntervalOfTheAnalogInputsIsUnderstood) {
  const Record record = imported(
      "Record Length,Analog:3\nSample Interval,Analog:0.0000000200\nVertical Units,CH1:V\n"
      "Horizontal Units,s\nSource,CH1\nSecond,Value\n-4e-08,1.5\n-2e-08,2.5\n0,0.5\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("Value [V]"));
  EXPECT_DOUBLE_EQ(record.channels.at(0).clock.interval, 2e-8);
  EXPECT_THAT(record.warnings, IsEmpty());
}

// As of SDS1202X-E: the unit is that of the horizontal scale.
TEST(Siglent, AnIntervalOfAChannelIsInSeconds) {
  const std::string head =
      "Record Length,Analog:4\nSample Interval,CH1:0.0000020000000\nVertical Units,CH1:V,,,\n"
      "Horizontal Units,us,,,\nHorizontal Scale,20000.0000000000,,,\nSource,CH1\n";
  const Record record = imported(head +
                                 "Second,Volt\n 0.00000000000,1.16\n 0.00000200000,1.18\n"
                                 " 0.00000400000,1.16\n 0.00000600000,1.20\n");
  EXPECT_DOUBLE_EQ(record.channels.at(0).clock.interval, 2e-6);
  EXPECT_THAT(record.warnings, IsEmpty());
}

TEST(LoggerPro, NamesStandOverTheirLetters) {
  const Record record = imported(
      "Vernier Format 2\nuntitled.cmbl 9/28/2026 12:00:00 .\nRun 1\nTime\tForce\tVelocity\n"
      "T\tF\tv\ns\tN\tm/s\n\n0.000\t0.5\t2.0\n0.001\t0.6\t1.9\n0.002\t1.2\t1.8\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("Force [N]", "Velocity [m/s]"));
  EXPECT_NEAR(record.channels.at(0).clock.interval, 1e-3, 1e-12);
}

// "Export Waveforms to Spreadsheet File"
TEST(LabView, WaveformsHaveTheirNamesAboveTheirStarts) {
  const Record record = imported(
      "waveform\tForce\tVel\t\nt0\t4/22/2018  13:45:12.100572\t4/22/2018  13:45:12.100572\t\n"
      "delta t\t0.001000\t0.001000\t\n\ntime\tY[0]\tY[1]\t\n"
      "4/22/2018  13:45:12.100572\t0.0E+00\t2.0E+00\t\n"
      "4/22/2018  13:45:12.101572\t5.9E-01\t1.9E+00\t\n"
      "4/22/2018  13:45:12.102572\t1.1E+00\t1.8E+00\t\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("Force []", "Vel []"));
  EXPECT_NEAR(record.channels.at(0).clock.interval, 1e-3, 1e-12);
}

// MSO5000 and DHO: the lines of each logic pod as one number
TEST(Rigol, LogicLinesAreNumbersInHexadecimalDigits) {
  const Record record = imported(
      "Time(s),CH1V,D7-D0,t0 = -1.0e-03, tInc = 2.0e-06\n"
      "-1.0e-03,0.12,0x00,,\n-0.998e-03,0.11,0xFF,,\n-0.996e-03,0.13,0x1a,,\n");
  ASSERT_EQ(record.channels.size(), 2U);
  EXPECT_THAT(record.channels[1].values(), ElementsAre(0, 255, 26));
  EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 2e-6);
  EXPECT_THAT(import_error("t [s],F [N]\n0,1\n1,2\n2,0x\n"), HasSubstr("found '0x'"));
}

TEST(InstrumentTables, NumbersThatStandForNoneAreMissing) {
  const Record record = imported(
      "Time [s],F [N],a [g]\n0,1.5,+9.9E+37\n1,-9.900000E+37,\"9.91E37\"\n2,+9.99999E+99,9.8e37\n");
  EXPECT_THAT(record.channels.at(0).valid, ElementsAre(1, 0, 0));
  EXPECT_THAT(record.channels.at(1).valid, ElementsAre(0, 0, 1));
  EXPECT_EQ(record.channels[1].values()[2], 9.8e37);
  EXPECT_THAT(record.warnings,
              ElementsAre(HasSubstr("'F': 2 of 3 values are missing, the first, written "
                                    "'-9.900000E+37', at"),
                          HasSubstr("'a': 2 of 3 values are missing, the first, written "
                                    "'+9.9E+37', at")));
}

TEST(CsvDates, AClockOfMillisecondsBesideATimeIsNoFraction) {
  std::string rows = "Time;ms;F\n";
  for (int i = 0; i < 150; ++i) rows += fmt::format("10:11:{:02};{};1.5\n", 12 + i / 100, 10 * i);
  EXPECT_THAT(names_and_units(imported(rows)), ElementsAre("ms [ms]", "F []"));
  // no number of nanoseconds
  rows.replace(rows.find(";10;"), 4, ";9223372036854775807;");
  EXPECT_THAT(names_and_units(imported(rows)), ElementsAre("ms [ms]", "F []"));
}

TEST(CsvDates, AFractionBesideATimeThatIsNoneIsAnError) {
  const std::string rows = "No;Time;ms;F\n1;10:11:12;0;1.5\n2;10:11:12;500;2.5\n3;10:11:13;0;0.5\n";
  EXPECT_DOUBLE_EQ(imported(rows).channels.at(0).clock.interval, 0.5);
  std::string many = rows;
  for (int i = 4; i < 4100; ++i) many += fmt::format("{};10:11:59;0;1.5\n", i);
  EXPECT_EQ(import_error(many + "60;10:12:00;1500;1.5\n"),
            "FILE:4101:4 (byte 80891): Time: expected a date and time as in the first row, found "
            "'10:12:00;1500'");
}

}  // namespace
}  // namespace impactrig::acquisition
