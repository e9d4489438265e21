// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "acquisition/importer.hpp"
#include "acquisition/importers/formats.hpp"
#include "tests/acquisition/lvm_bytes.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using tests::import_error;
using tests::imported;
using tests::lvm_two_channels;
using tests::LvmFile;

const std::string names = "X_Value|force|accel|Comment";

std::string one_segment(const std::string& rows, const std::string& delta = "0.001",
                        const LvmFile& file = {}, const std::string& samples = "3") {
  return file.header() + file.segment(lvm_two_channels(samples, "0", delta), names, rows);
}

TEST(Lvm, HeaderNamesUnitsTimesAndComments) {
  const auto record = imported(one_segment("0|1|2\n0.001|3|4|hit the plate\n0.002|5|6\n\n"));
  ASSERT_EQ(record.channels.size(), 2U);
  EXPECT_EQ(record.provenance.importer, "lvm");
  EXPECT_EQ(record.started, "2024-02-29T09:51:40.250000");
  EXPECT_EQ(record.channels[0].name, "force");
  EXPECT_EQ(record.channels[0].unit, "N");
  EXPECT_EQ(record.channels[0].quantity, datasets::Quantity::force);
  EXPECT_THAT(record.channels[0].values(), ElementsAre(1, 3, 5));
  EXPECT_EQ(record.channels[1].unit, "m/s^2");
  EXPECT_THAT(record.channels[1].values(), ElementsAre(2, 4, 6));
  EXPECT_EQ(record.channels[1].clock.interval, 0.001);
  EXPECT_EQ(record.channels[1].clock.start, 0.0);
  EXPECT_EQ(record.attributes.at("comments"), "row 1: hit the plate");
  EXPECT_EQ(record.attributes.at("Writer_Version"), "2");
  EXPECT_THAT(record.warnings, ElementsAre());
}

TEST(Lvm, SeparatorAndDecimalMarkAreTheHeaders) {
  const LvmFile comma{',', "Comma", ".", "One", "Yes", ""};
  EXPECT_THAT(
      imported(one_segment("0|1.5|2\n0.001|3|4\n0.002|5|6\n", "0.001", comma)).channels[0].values(),
      ElementsAre(1.5, 3, 5));
  const LvmFile semicolon{';', ";", ",", "One", "Yes", ""};
  EXPECT_THAT(imported(one_segment("0|1,5|2\n0,001|3|4\n0,002|5|6\n", "0,001", semicolon))
                  .channels[0]
                  .values(),
              ElementsAre(1.5, 3, 5));
  const LvmFile silent{'\t', "Tab", "", "No", "Yes", ""};
  const auto record = imported(one_segment("|1,5|2\n|3|4\n|5|6\n", "0,001", silent));
  EXPECT_THAT(record.channels[0].values(), ElementsAre(1.5, 3, 5));
  EXPECT_EQ(record.channels[0].clock.interval, 0.001);
}

TEST(Lvm, NamesMayStandBehindAnEmptyCellWhereThereIsNoXColumn) {
  const LvmFile file{',', "Comma", ".", "No", "No", ""};
  const auto record = imported(file.header() + file.segment(lvm_two_channels("3", "0", "0.001"),
                                                            "|force|accel", "|1|2\n|3|4\n|5|6\n"));
  ASSERT_EQ(record.channels.size(), 2U);
  EXPECT_EQ(record.channels[0].name, "force");
  EXPECT_EQ(record.channels[1].name, "accel");
  EXPECT_THAT(record.channels[1].values(), ElementsAre(2, 4, 6));
  EXPECT_THAT(record.warnings, ElementsAre());
  // rows are no names
  EXPECT_THAT(import_error(file.header() + file.segment(lvm_two_channels("3", "0", "0.001"), "|1|2",
                                                        "|3|4\n|5|6\n")),
              HasSubstr("expected the line of names that begins with 'X_Value', found ''"));
}

TEST(Lvm, TimesAmongTheChannelsThatContradictDeltaAreToldOf) {
  const LvmFile file{',', "Comma", ".", "No", "No", ""};
  const auto with_delta = [&file](const std::string& delta) {
    std::string keys = lvm_two_channels("4", "0", delta);
    keys.replace(keys.find("Y_Unit_Label|N"), 14, "Y_Unit_Label|s");
    return imported(file.header() + file.segment(keys, "|time|accel",
                                                 "|0|2\n|0.000605|4\n|0.00121|6\n|0.001815|8\n"));
  };
  const auto record = with_delta("0.000586");
  EXPECT_EQ(record.channels[1].clock.interval, 0.000586);
  EXPECT_THAT(record.warnings,
              testing::Contains("'time' holds times in steps of 0.000605 s, but Delta_X is another "
                                "for 'accel' (0.000586): the clocks are those of Delta_X "
                                "(--sample-rate 1652.89256 states the other)"));
  EXPECT_THAT(with_delta("0.000605").warnings, ElementsAre());
}

TEST(Lvm, EachChannelHasItsXColumn) {
  const LvmFile file{'\t', "Tab", ".", "Multi", "Yes", ""};
  const std::string keys =
      "Channels|2||||\nSamples|3||2||\nY_Unit_Label|N||g||\nX_Dimension|Time||Time||\n"
      "X0|0||0.5||\nDelta_X|0.001||0.002||\n";
  const auto record =
      imported(file.header() + file.segment(keys, "X_Value|a|X_Value|b|Comment",
                                            "0|1|0.5|4\n0.001|2|0.502|5\n0.002|3||\n"));
  ASSERT_EQ(record.channels.size(), 2U);
  EXPECT_THAT(record.channels[0].values(), ElementsAre(1, 2, 3));
  EXPECT_THAT(record.channels[1].values(), ElementsAre(4, 5));
  EXPECT_EQ(record.channels[1].clock.start, 0.5);
  EXPECT_EQ(record.channels[1].clock.interval, 0.002);
  EXPECT_THAT(record.warnings, ElementsAre());
}

TEST(Lvm, TheXColumnIsBelievedWhereDeltaDisagrees) {
  const auto record = imported(one_segment("0|1|2\n0.005|3|4\n0.01|5|6\n", "1.953125E-5"));
  EXPECT_EQ(record.channels[0].clock.interval, 0.005);
  EXPECT_THAT(record.warnings[0],
              "Delta_X is 1.953125e-05 but the X column steps by 0.005: "
              "the X column is used");
}

// The one X column is that of the first of the longest channels, as the specification has it.
TEST(Lvm, AChannelWhoseX0IsAnotherBeginsThen) {
  const LvmFile file;
  std::string keys = lvm_two_channels("3", "0", "0.001");
  keys.replace(keys.find("X0|0|0|"), 7, "X0|0|0.5|");
  for (const std::string rows :
       {"0|1|2\n0.001|3|4\n0.002|5|6\n", "0|1|2\n0.001|3|4\n0.007|5|6\n"}) {
    const auto record = imported(file.header() + file.segment(keys, names, rows));
    EXPECT_EQ(record.channels[0].clock.start, 0.0);
    EXPECT_EQ(record.channels[1].clock.start, 0.5);
    EXPECT_THAT(record.warnings,
                testing::Contains("'accel': X0 is 0.5, that of 'force', whose times the X column "
                                  "has, 0: its times are the column's and 0.5 more"));
    const auto& stated = record.channels[1].clock.times;
    EXPECT_DOUBLE_EQ(stated.empty() ? 0.507 : stated[2], 0.507);
  }
  {
    const std::string rows = "0|1|2\n0.001|3|4\n0.002|5|6\n";
    const tests::WrittenFile large(file.header() + file.segment(keys, names, rows), ".lvm");
    const auto reader = open_lvm_by_blocks(large.path(), {});
    EXPECT_EQ(reader->head().record.channels[0].clock.start, 0.0);
    EXPECT_EQ(reader->head().record.channels[1].clock.start, 0.5);
  }
  keys.replace(keys.find("Samples|3|3"), 11, "Samples|2|3");
  const auto shorter =
      imported(file.header() + file.segment(keys, names, "0.5|1|2\n0.501|3|4\n0.502||6\n"));
  EXPECT_DOUBLE_EQ(shorter.channels[0].clock.start, 0.0);
  EXPECT_DOUBLE_EQ(shorter.channels[1].clock.start, 0.5);
}

// "X values guaranteed valid only for" the first channel, as LabVIEW notes in such files.
TEST(Lvm, AChannelWithAnotherDeltaKeepsItsOwnTimes) {
  const LvmFile file;
  const std::string keys =
      "Channels|2|||\nSamples|4|2||\nDate|2024/02/29|1903/12/31|\nTime|09:51:40|19:00:00|\n"
      "X_Dimension|Time|Time|\nX0|5|0|\nDelta_X|0.001|1.000000|\n";
  const auto record =
      imported(file.header() +
               file.segment(keys, "X_Value|a|b|Comment", "5|1|7\n5.001|2|8\n5.002|3|\n5.003|4|\n"));
  EXPECT_EQ(record.channels[0].clock.start, 5.0);
  EXPECT_EQ(record.channels[0].clock.interval, 0.001);
  EXPECT_EQ(record.channels[1].clock.start, 0.0);
  EXPECT_EQ(record.channels[1].clock.interval, 1.0);
  EXPECT_THAT(record.channels[1].values(), ElementsAre(7, 8));
  EXPECT_THAT(
      record.warnings,
      ElementsAre("'b': Delta_X is 1, that of 'a', whose times the X column has, 0.001: its "
                  "own X0 and Delta_X are taken"));
}

TEST(Lvm, AnXColumnThatRestartsIsToldWithAWayOut) {
  const LvmFile file;
  const auto record = imported(
      file.header() + file.segment(lvm_two_channels("3", "0", "0.001"), "X_Value|a|b|Comment",
                                   "0|1|2\n0.001|3|4\n0.002|5|6\n0|7|8\n0.001|9|1\n"));
  EXPECT_THAT(record.warnings,
              testing::Contains(
                  "'a': the X column restarts: time does not increase from sample 2 (0.002 s) to "
                  "sample 3 (0 s); recordings follow each other, and how much time passed between "
                  "them is not told (--sample-rate 1000 joins them end to end)"));
  for (const std::string& warning : record.warnings)
    EXPECT_THAT(warning, testing::Not(HasSubstr("steps by")));
}

TEST(Lvm, DeltaIsBelievedWhereTheXColumnIsOnlyRounded) {
  const auto record =
      imported(one_segment("0.000000|1|2\n0.000020|3|4\n0.000039|5|6\n", "1.953125E-5"));
  EXPECT_EQ(record.channels[0].clock.interval, 1.953125e-5);
  EXPECT_THAT(record.warnings, ElementsAre());
}

TEST(Lvm, SegmentsThatGoOnInTimeAreJoined) {
  const LvmFile file{'\t', "Tab", ".", "No", "Yes", ""};
  const auto by_x0 = imported(
      file.header() + file.segment(lvm_two_channels("2", "0", "0.001"), names, "|1|2\n|3|4\n\n") +
      file.segment(lvm_two_channels("2", "0.002", "0.001"), names, "|5|6\n|7|8\n"));
  ASSERT_EQ(by_x0.channels.size(), 2U);
  EXPECT_THAT(by_x0.channels[0].values(), ElementsAre(1, 3, 5, 7));
  EXPECT_EQ(by_x0.channels[0].attributes.at("segments"), "2");
  EXPECT_THAT(by_x0.warnings, ElementsAre());

  const auto by_time = imported(
      file.header() +
      file.segment(lvm_two_channels("2", "0", "0.5", "09:51:40.25"), names, "|1|2\n|3|4\n\n") +
      file.segment(lvm_two_channels("2", "0", "0.5", "09:51:41,2500000001"), names,
                   "|5|6\n|7|8\n"));
  ASSERT_EQ(by_time.channels.size(), 2U);
  EXPECT_THAT(by_time.channels[1].values(), ElementsAre(2, 4, 6, 8));
}

TEST(Lvm, SegmentsApartBecomeChannelsOfTheirOwn) {
  const LvmFile file{'\t', "Tab", ".", "One", "Yes", ""};
  const auto record =
      imported(file.header() +
               file.segment(lvm_two_channels("2", "0", "0.001"), names, "0|1|2\n0.001|3|4\n\n") +
               file.segment(lvm_two_channels("2", "0", "0.001", "09:51:50.25"), names,
                            "0|5|6\n0.001|7|8\n"));
  ASSERT_EQ(record.channels.size(), 4U);
  EXPECT_EQ(record.channels[2].name, "force (segment 2)");
  EXPECT_EQ(record.channels[2].clock.start, 10.0);
  EXPECT_THAT(record.channels[2].values(), ElementsAre(5, 7));
  EXPECT_THAT(record.warnings,
              ElementsAre("the file has 2 segments that do not continue each other in time: "
                          "channels of the later ones are named '... (segment n)'"));
}

// "Absolute": from 1904 on; LabVIEW 2012 and later write 0 beside that word.
TEST(Lvm, TimesSince1904BeginWithTheRecording) {
  const LvmFile file{'\t', "Tab", ".", "No", "Yes", ""};
  const auto record = imported(
      file.header() +
      file.segment(lvm_two_channels("2", "3698388672.5", "0.001"), names, "|1|2\n|3|4\n\n") +
      file.segment(lvm_two_channels("2", "3698388682.5", "0.001", "09:51:50.25"), names,
                   "|5|6\n|7|8\n"));
  ASSERT_EQ(record.channels.size(), 4U);
  EXPECT_EQ(record.channels[0].clock.start, 0.0);
  EXPECT_EQ(record.channels[2].clock.start, 10.0);
  EXPECT_EQ(record.started, "2024-02-29T09:51:40.250000");
}

TEST(Lvm, TimesThatGoOnFromTheFirstSegmentAreNotShiftedToo) {
  const LvmFile file{'\t', "Tab", ".", "No", "Yes", ""};
  const auto record = imported(
      file.header() + file.segment(lvm_two_channels("2", "0", "0.001"), names, "|1|2\n|3|4\n\n") +
      file.segment(lvm_two_channels("2", "10.02", "0.001", "09:51:50.25"), names, "|5|6\n|7|8\n"));
  ASSERT_EQ(record.channels.size(), 4U);
  EXPECT_EQ(record.channels[2].clock.start, 10.02);
}

TEST(Lvm, ASegmentThatGoesOnAlthoughItsTimeIsLaterIsToldOf) {
  const LvmFile file{'\t', "Tab", ".", "No", "Yes", ""};
  const auto record = imported(
      file.header() + file.segment(lvm_two_channels("2", "0", "0.001"), names, "|1|2\n|3|4\n\n") +
      file.segment(lvm_two_channels("2", "0.002", "0.001", "09:51:45.25"), names, "|5|6\n|7|8\n"));
  EXPECT_THAT(record.channels[0].values(), ElementsAre(1, 3, 5, 7));
  EXPECT_THAT(record.warnings,
              ElementsAre("segment 2 goes on where the one before ends by its X values, but its "
                          "date and time are 5 s later: the X values are taken"));
}

// [NI, LabVIEW Measurement File format: date and time of a segment have a cell a channel]
TEST(Lvm, AChannelsOwnDateAndTimeSayWhenItBegins) {
  const std::string keys =
      "Channels|2|||\nSamples|2|2|\nDate|2024/02/29|2024/03/01|\nTime|09:51:40.25|09:51:41.75|\n"
      "X_Dimension|Time|Time|\nX0|0|0.5|\nDelta_X|0.001|0.001|\n";
  const LvmFile file{'\t', "Tab", ".", "No", "Yes", ""};
  const auto record = imported(file.header() + file.segment(keys, names, "|1|2\n|3|4\n"));
  EXPECT_EQ(record.channels[0].clock.start, 0.0);
  EXPECT_EQ(record.channels[1].clock.start, 86402.0);
}

TEST(Lvm, PacketsWithoutHeaderAreAppended) {
  const LvmFile file{'\t', "Tab", ".", "No", "No", ""};
  const auto record = imported(one_segment("|1|2\n|3|4\n|5|6\n", "0.001", file, "2"));
  EXPECT_THAT(record.channels[0].values(), ElementsAre(1, 3, 5));
  EXPECT_THAT(
      record.warnings[0],
      "'force', 'accel': the header declares 2 samples, there are 3: packets without a header of "
      "their own follow, and whether time passed between them is not told");
  // channels of different length leave cells empty in each packet: nothing is missing
  const std::string keys =
      "Channels|2|||\nSamples|1|2|\nX_Dimension|Time|Time|\nX0|0|0|\nDelta_X|0.002|0.001|\n";
  const auto uneven = imported(file.header() + file.segment(keys, names, "|1|2\n||3\n|4|5\n||6\n"));
  EXPECT_THAT(uneven.channels[0].values(), ElementsAre(1, 4));
  EXPECT_THAT(uneven.channels[0].valid, ElementsAre());
  EXPECT_THAT(uneven.channels[1].values(), ElementsAre(2, 3, 5, 6));
}

TEST(Lvm, AValueMissingWithinIsMarkedAndAtTheEndEndsTheChannel) {
  const auto record = imported(one_segment("0|1|2\n0.001||4\n0.002|5|\n"));
  EXPECT_EQ(record.channels[0].size(), 3U);
  EXPECT_THAT(record.channels[0].valid, ElementsAre(1, 0, 1));
  EXPECT_THAT(record.channels[1].values(), ElementsAre(2, 4));
  EXPECT_THAT(record.warnings,
              ElementsAre("'accel': the header declares 3 samples, there are 2",
                          "'force': 1 of 3 values is missing; marked as not valid"));
}

TEST(Lvm, ADeltaOfFewDecimalsIsToldWithTheRateItStandsFor) {
  const LvmFile file{'\t', "Tab", ".", "No", "Yes", ""};
  const auto record = imported(one_segment("|1|2\n|3|4\n|5|6\n", "0.000977", file));
  EXPECT_EQ(record.channels[0].clock.interval, 0.000977);
  EXPECT_THAT(record.warnings,
              ElementsAre("Delta_X is printed as 0.000977, which stands for 1/1024 "
                          "s too: --sample-rate 1024 states that"));
}

TEST(Lvm, SpecialBlocksAreLeftOut) {
  const LvmFile file;
  const auto record =
      imported(file.header() + "***Start_Special***\nanything\t1\n***End_Special***\n" +
               file.segment(lvm_two_channels("1", "0", "0.001"), names, "0|1|2\n"));
  EXPECT_THAT(record.channels[0].values(), ElementsAre(1));
  EXPECT_EQ(record.attributes.at("special blocks left out"), "1");
}

TEST(Lvm, AnotherAbscissaIsNoClock) {
  const LvmFile file;
  const auto record =
      imported(file.header() +
               file.segment("Channels|1|\nSamples|2|\nY_Unit_Label|N|\nX_Dimension|Frequency|\n"
                            "X_Unit_Label|Hz|\nX0|0|\nDelta_X|2|\n",
                            "X_Value|spectrum|Comment", "0|1\n2|2\n"));
  EXPECT_EQ(record.channels[0].clock.interval, 0.0);
  EXPECT_EQ(record.channels[0].attributes.at("domain"), "frequency");
  EXPECT_EQ(record.channels[0].attributes.at("abscissa increment"), "2");
}

TEST(Lvm, CutFilesGiveWhatIsThere) {
  const std::string whole = one_segment("0|1|2\n0.001|3|4\n0.002|5|6\n");
  const auto record = imported(whole.substr(0, whole.size() - 4));
  EXPECT_THAT(record.channels[0].values(), ElementsAre(1, 3));
  EXPECT_THAT(record.warnings[0], HasSubstr("the file ends within the row at "));
  const LvmFile file;
  const auto none = imported(file.header() + file.with_separators("Channels|2|||\nSamples|3|"));
  EXPECT_EQ(none.channels.size(), 0U);
  ASSERT_EQ(none.warnings.size(), 2U);
  EXPECT_THAT(none.warnings[0], HasSubstr("the file ends within the header of segment 1 at "));
  EXPECT_EQ(none.warnings[1],
            "there is no segment with samples in this file: there are no channels");
}

// "-1" may be the beginning of "-1.25": the header announces more rows.
TEST(Lvm, ARowWithoutLineEndMayBeCutWithinItsLastNumber) {
  const LvmFile file;
  const auto with_samples = [&file](const std::string& samples) {
    return imported(file.header() + file.segment(lvm_two_channels(samples, "0", "0.001"), names,
                                                 "0|1|2.25\n0.001|3|4.25\n0.002|5|-1"));
  };
  const auto cut = with_samples("8");
  EXPECT_THAT(cut.channels[0].values(), ElementsAre(1, 3));
  EXPECT_THAT(cut.channels[1].values(), ElementsAre(2.25, 4.25));
  EXPECT_THAT(cut.warnings[0], HasSubstr("the file ends within the row at "));
  const auto whole = with_samples("3");
  EXPECT_THAT(whole.channels[1].values(), ElementsAre(2.25, 4.25, -1));
  EXPECT_TRUE(whole.warnings.empty());
}

// 1.2127 of 1.212775, as the rows above it have six decimals.
TEST(Lvm, ALastNumberOfFewerDigitsIsNone) {
  const std::string rows =
      "|0.394070|1.221011\n|0.741586|1.211888\n|0.680572|1.215311\n|0.5|1.2127";
  const LvmFile no_x{'\t', "Tab", ".", "No", "Yes", ""};
  const auto cut = imported(one_segment(rows, "0.001", no_x, "4"));
  EXPECT_EQ(cut.channels.at(1).size(), 3U);
  EXPECT_THAT(cut.warnings, testing::Contains(HasSubstr("the file ends within the row at ")));
  EXPECT_EQ(imported(one_segment(rows + "75", "0.001", no_x, "4")).channels.at(1).size(), 4U);
}

TEST(Lvm, CountsThatLieChangeNothing) {
  const LvmFile file;
  for (const std::string count : {"9223372036854775808", "-1", "99999999999999999999", "x"}) {
    std::string keys = lvm_two_channels(count, "0", "0.001");
    keys.replace(keys.find("|2|"), 3, "|" + count + "|");
    const auto record = imported(file.header() + file.segment(keys, names, "0|1|2\n0.001|3|4\n"));
    ASSERT_EQ(record.channels.size(), 2U);
    EXPECT_THAT(record.channels[0].values(), ElementsAre(1, 3));
    EXPECT_EQ(
        record.warnings[0],
        fmt::format("segment 1 declares {} channels and names 2: those named are read", count));
  }
}

TEST(Lvm, ErrorsNameThePlace) {
  const LvmFile file;
  ImportOptions decimal_comma;
  decimal_comma.decimal = ',';
  ImportOptions three_units;
  three_units.units = {"N", "g", "s"};
  ImportOptions stated;
  stated.format = "lvm";
  EXPECT_EQ(import_error("LabVIEW Measurement\t\nSeparator\tTab\n"),
            "FILE:3:1 (byte 35): the file ends within its header: no '***End_of_Header***'");
  EXPECT_EQ(import_error("LabVIEW Measurement\t\nSeparator\tTab\nX_Value\ta\n"),
            "FILE:3:1 (byte 35): the file's header does not end before 'X_Value': no "
            "'***End_of_Header***'");
  EXPECT_EQ(import_error("LabVIEW Measurement\t\nDecimal_Separator\tx\n***End_of_Header***\n"),
            "FILE:1:1 (byte 0): Decimal_Separator is 'x', expected '.' or ','");
  EXPECT_EQ(import_error("LabVIEW Measurement,\nDecimal_Separator,,\n***End_of_Header***\n",
                         decimal_comma),
            "FILE:1:1 (byte 0): Separator and Decimal_Separator are both ',': state --decimal");
  EXPECT_EQ(import_error(one_segment("0|1|2\n0.001|3|bad\n")),
            "FILE:24:9 (byte 418): accel: expected a number, found 'bad'");
  EXPECT_EQ(import_error(file.header() + file.with_separators("Channels|1|\nX_Value|a\n")),
            "FILE:14:1 (byte 208): the header of segment 1 does not end before this line: no "
            "'***End_of_Header***'");
  EXPECT_EQ(import_error(file.header() + file.segment("Channels|1|\n", "Value|a", "0|1\n")),
            "FILE:15:1 (byte 229): expected the line of names that begins with 'X_Value', found "
            "'Value'");
  EXPECT_EQ(import_error(one_segment("0|1|2\n0.001|3|4\n"), three_units),
            "FILE: 3 units are stated but the file has 2 channels");
  EXPECT_EQ(import_error("some text\n***End_of_Header***\n", stated),
            "FILE:1:1 (byte 0): expected 'LabVIEW Measurement', found 'some text'");
  std::string wide = "X_Value";
  std::string last = "1";
  for (int i = 0; i < 500; ++i) {
    wide += "|c";
    last += "|1";
  }
  std::string short_rows;
  for (int i = 0; i < 500; ++i) short_rows += "1\n";
  EXPECT_THAT(
      import_error(file.header() + file.segment("Channels|500|\n", wide, short_rows + last)),
      HasSubstr("more values are missing than the file has characters"));
}

TEST(Lvm, WithoutHeaderItIsATableWhoseColumnsEnd) {
  const std::string bytes =
      "0.000000\t1.5\t2.5\t9\n5.0E-6\t1\t2\t\n1.0E-5\t3\t4\t\n1.5E-5\t3\t4\t\n";
  const auto record = imported(bytes, {}, ".lvm");
  ASSERT_EQ(record.channels.size(), 3U);
  EXPECT_EQ(record.channels[0].name, "column 2");
  EXPECT_EQ(record.channels[2].name, "column 4");
  EXPECT_THAT(record.channels[2].values(), ElementsAre(9));
  EXPECT_THAT(record.channels[2].valid, ElementsAre());
  EXPECT_EQ(record.channels[0].clock.interval, 5e-6);
  EXPECT_EQ(record.warnings[0], "the file has no header: it is read as a table of numbers");
  EXPECT_EQ(record.warnings[1],
            "the time column 'column 1' states no unit: it is taken as s "
            "(--units states another)");
  EXPECT_EQ(record.warnings.back(), "'column 4' ends after 1 of 4 rows");
}

TEST(Lvm, AWindowOfAChannelIsThatPartOfTheWhole) {
  const std::string bytes = one_segment("0|1|2\n0.001|3|4\n0.002|5|6\n");
  ImportOptions options;
  options.channels = {"accel"};
  options.from = 0.001;
  const auto part = imported(bytes, options);
  ASSERT_EQ(part.channels.size(), 1U);
  EXPECT_EQ(part.channels[0].clock.start, 0.001);
  EXPECT_THAT(part.channels[0].values(), ElementsAre(4, 6));
}

}  // namespace
}  // namespace impactrig::acquisition
