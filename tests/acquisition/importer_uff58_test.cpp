// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include "acquisition/importer.hpp"
#include "acquisition/uff58_codes.hpp"
#include "tests/acquisition/uff58_function.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Channel;
using datasets::Quantity;
using datasets::Record;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using tests::import_error;
using tests::imported;
using tests::uff58::Function;
using tests::uff58::only_channel;
using tests::uff58::place;

TEST(Uff58, IsReadWithNameUnitQuantityAndClock) {
  const Record record = imported(Function{}.text());
  ASSERT_EQ(record.channels.size(), 1U);
  const Channel& channel = record.channels.front();
  EXPECT_EQ(channel.name, "Hammer");
  EXPECT_EQ(channel.unit, "N");
  EXPECT_EQ(channel.quantity, Quantity::force);
  EXPECT_EQ(channel.clock.start, 0.0);
  EXPECT_EQ(channel.clock.interval, 1e-3);
  EXPECT_THAT(channel.values(), ElementsAre(1.0, -2.0, 3.0));
  EXPECT_EQ(channel.attributes.at("response entity"), "Stop");
  EXPECT_EQ(channel.attributes.at("response node"), "7");
  EXPECT_EQ(channel.attributes.at("response direction"), "-3");
  EXPECT_EQ(channel.attributes.at("function"), "time response");
  EXPECT_EQ(record.started, "2020-04-30T19:12:52");
  EXPECT_EQ(record.provenance.importer, "uff58");
  EXPECT_THAT(record.warnings, IsEmpty());
}

// A mobility is no velocity.
TEST(Uff58, TheUnitOfAFrequencyResponseHasItsDenominators) {
  Function function;
  function.dof.replace(0, 5, "    4");
  function.abscissa.replace(8, 2, "18");
  function.abscissa.replace(45, 2, "Hz");
  function.ordinate = "        12    0    0    0 Acceleration         m/s^2               ";
  function.denominator = Function{}.ordinate;
  const Record record = imported(function.text());
  EXPECT_EQ(record.channels.at(0).unit, "(m/s^2)/(N)");
  EXPECT_NE(record.channels.at(0).quantity, Quantity::acceleration);
  function.denominator = Function{}.denominator;
  EXPECT_EQ(imported(function.text()).channels.at(0).unit, "m/s^2");
}

// --- Data as text
// ---------------------------------------------------------------------------------

// Frequency responses, each of another time, have no time to go wrong by it.
TEST(Uff58, TimeRecordsOfDifferentStartsAreTold) {
  Function second;
  second.id1 = "Beam";
  second.date = "30-Apr-20 19:20:00";
  EXPECT_THAT(imported(Function{}.text() + second.text()).warnings,
              testing::ElementsAre(testing::HasSubstr("(the first at 2020-04-30T19:12:52, another "
                                                      "at 2020-04-30T19:20:00): each counts")));
  second.date = "30-Apr-20 19:12:54";
  EXPECT_THAT(imported(Function{}.text() + second.text()).warnings, testing::IsEmpty());
  second.date = "30-Apr-20 19:20:00";
  second.dof.replace(0, 5, "    4");
  second.abscissa = "        18    0    0    0 Frequency            Hz                  ";
  EXPECT_THAT(imported(Function{}.text() + second.text()).warnings,
              testing::Each(testing::StartsWith("'Beam' is no time record")));
}

TEST(Uff58, NumbersAreInColumnsAndMayTouch) {
  Function function;
  function.points = 7;
  function.data =
      "-1.00000E-100-2.00000E-100  3.00000D+00         4.0   5.00000E+00 -6.00000E+00\n"
      "  7.00000+100\n";
  EXPECT_THAT(only_channel(function).values(),
              ElementsAre(-1e-100, -2e-100, 3.0, 4.0, 5.0, -6.0, 7e100));
}

TEST(Uff58, DoublePrecisionHasColumnsOfTwenty) {
  Function function;
  function.type = 4;
  function.points = 5;
  function.data =
      "  1.234567890123E+00 -1.000000000000D-02  3.000000000000E+00  4.000000000000E+00\r\n"
      "  5.000000000000E+00                                                            \r\n";
  EXPECT_THAT(only_channel(function).values(), ElementsAre(1.234567890123, -0.01, 3.0, 4.0, 5.0));
}

TEST(Uff58, UnevenSinglePrecisionHasTimesBeforeValues) {
  Function function;
  function.even = 0;
  function.data =
      "  0.00000E+00  1.00000E+00  1.00000E+00  2.00000E+00  4.00000E+00  3.00000E+00\n";
  const Channel channel = only_channel(function);
  EXPECT_THAT(channel.values(), ElementsAre(1.0, 2.0, 3.0));
  EXPECT_THAT(channel.clock.times, ElementsAre(0.0, 1.0, 4.0));
}

TEST(Uff58, UnevenDoublePrecisionMixesColumnsOfThirteenAndTwenty) {
  Function function;
  function.type = 4;
  function.even = 0;
  function.data =
      "  0.00000E+00  1.000000000001E+00  1.00000E+00  2.000000000002E+00\n"
      "  2.00000E+00  3.000000000003E+00\n";
  const Channel channel = only_channel(function);
  EXPECT_THAT(channel.values(), ElementsAre(1.000000000001, 2.000000000002, 3.000000000003));
  EXPECT_TRUE(channel.clock.uniform());  // the times are even after all
  EXPECT_EQ(channel.clock.interval, 1.0);
}

TEST(Uff58, ComplexNumbersComeInPairs) {
  for (const int type : {5, 6}) {
    Function function;
    function.type = type;
    function.points = 2;
    function.data =
        type == 5
            ? "  1.00000E+00 -1.00000E+00  2.00000E+00 -2.00000E+00\n"
            : "  1.000000000000E+00 -1.000000000000E+00  2.000000000000E+00 -2.000000000000E+00\n";
    const Channel channel = only_channel(function);
    EXPECT_THAT(channel.values(), ElementsAre(1.0, 2.0));
    EXPECT_THAT(channel.imaginary, ElementsAre(-1.0, -2.0));
  }
}

TEST(Uff58, UnevenComplexNumbersComeInThrees) {
  for (const int type : {5, 6}) {
    Function function;
    function.type = type;
    function.points = 2;
    function.even = 0;
    function.data =
        type == 5
            ? "  0.00000E+00  1.00000E+00 -1.00000E+00  5.00000E-01  2.00000E+00 -2.00000E+00\n"
            : "  0.00000E+00  1.000000000000E+00 -1.000000000000E+00\n"
              "  5.00000E-01  2.000000000000E+00 -2.000000000000E+00\n";
    const Channel channel = only_channel(function);
    EXPECT_THAT(channel.values(), ElementsAre(1.0, 2.0));
    EXPECT_THAT(channel.imaginary, ElementsAre(-1.0, -2.0));
    EXPECT_EQ(channel.clock.interval, 0.5);
  }
}

TEST(Uff58, LinesMayBePaddedAndEndInEitherWay) {
  Function function;
  std::string padded;
  const std::string text = function.text();
  for (std::size_t start = 0; start < text.size();) {
    const std::size_t end = text.find('\n', start);
    padded += fmt::format("{:<80}\r\n", text.substr(start, end - start));
    start = end + 1;
  }
  const Record record = imported(padded);
  ASSERT_EQ(record.channels.size(), 1U);
  EXPECT_THAT(record.channels.front().values(), ElementsAre(1.0, -2.0, 3.0));
  EXPECT_EQ(record.channels.front().name, "Hammer");
  EXPECT_THAT(record.warnings, IsEmpty());
}

TEST(Uff58, NumbersOutOfColumnsAreReadByBlanksWithAWarning) {
  Function function;
  function.data = "1.0 -2.0 3.0\n";
  const Record record = imported(function.text());
  EXPECT_THAT(record.channels.front().values(), ElementsAre(1.0, -2.0, 3.0));
  EXPECT_THAT(
      record.warnings,
      ElementsAre(HasSubstr("are not in columns of the standard's width: they are read by the "
                            "blanks between them")));
}

TEST(Uff58, ALongNumberIsNotCutInTwo) {
  Function function;
  function.data = "   1.2345678901\n  -2.3456789012\n   3.0\n";
  EXPECT_THAT(only_channel(function).values(), ElementsAre(1.2345678901, -2.3456789012, 3.0));
}

TEST(Uff58, AFilledUpLastLineIsCutToTheAnnouncedPoints) {
  Function function;
  function.data =
      "  1.00000E+00 -2.00000E+00  3.00000E+00  0.00000E+00  0.00000E+00  0.00000E+00\n";
  EXPECT_THAT(only_channel(function).values(), ElementsAre(1.0, -2.0, 3.0));
}

TEST(Uff58, MorePointsThanAnnouncedAreReadWithAWarning) {
  Function function;
  for (int line = 0; line < 3; ++line) function.data += "  1.00000E+00 -2.00000E+00  3.00000E+00\n";
  const Record record = imported(function.text());
  EXPECT_EQ(record.channels.front().size(), 12U);
  EXPECT_THAT(record.warnings,
              ElementsAre("'Hammer': the header announces 3 points, 12 are there: these are read"));
}

// A line that is not the last of those announced fills nothing up.
TEST(Uff58, PointsOnFurtherLinesAreNoFillingUp) {
  Function function;
  function.data =
      "  1.00000E+00 -2.00000E+00  3.00000E+00  4.00000E+00  5.00000E+00  6.00000E+00\n"
      "  7.00000E+00\n";
  const Record record = imported(function.text());
  EXPECT_EQ(record.channels.front().size(), 7U);
  EXPECT_THAT(record.warnings,
              ElementsAre("'Hammer': the header announces 3 points, 7 are there: these are read"));
}

TEST(Uff58, ACutFileGivesWhatIsThere) {
  Function function;
  function.points = 1000000000;  // must not be allocated either
  function.data = "  1.00000E+00 -2.00000E+00  3.000";
  function.end = "";
  const Record record = imported(function.text());
  EXPECT_THAT(record.channels.front().values(), ElementsAre(1.0, -2.0));
  EXPECT_THAT(
      record.warnings,
      ElementsAre("'Hammer': the header announces 1000000000 points, 2 are there: these are read",
                  "the last dataset is not closed by -1: the file may have been cut off"));
}

TEST(Uff58, ACutSecondDatasetLeavesTheFirst) {
  const std::string first = Function{}.text();
  const std::string second = Function{}.text();
  for (const std::size_t kept : {30U, 100U, 200U, 470U}) {
    const Record record = imported(first + second.substr(0, kept));
    EXPECT_EQ(record.channels.size(), 1U);
    EXPECT_THAT(record.warnings, Contains(HasSubstr("it is left out"))) << kept;
  }
}

TEST(Uff58, WithoutAnyNumberIsAnError) {
  Function function;
  function.data = "";
  EXPECT_EQ(import_error(function.text()),
            fmt::format("FILE:14:1 (byte {})", function.text().size() - 7) +
                ": 3 points are announced and no number is there");
}

TEST(Uff58, CutWithinItsOnlyHeaderIsAnError) {
  EXPECT_EQ(import_error(Function{}.text().substr(0, 100)),
            "FILE:8:46 (byte 100): the file ends within the header of a dataset 58");
}

TEST(Uff58, WithTextForANumberIsAnErrorAtItsPlace) {
  Function function;
  function.data = "  1.00000E+00        *****  3.00000E+00\n  1.00000E+00\n";
  EXPECT_EQ(import_error(function.text()), place(function.text(), "        *****") +
                                               ": expected a number in 13 columns, found '*****'");
  function.data =
      "  1.00000E+00  1.00000E+00  1.00000E+00  1.00000E+00  1.00000E+00  1.00000E+00 x\n    \n";
  EXPECT_EQ(import_error(function.text()), place(function.text(), "  1.00000E+00  1.0") +
                                               ": the line goes on after its last column");
}

// --- The header
// -----------------------------------------------------------------------------------

TEST(Uff58, WithoutANameIsNamedByEntityLabelOrNumber) {
  Function function;
  function.id1 = "NONE";
  EXPECT_EQ(only_channel(function).name, "Stop");
  function.dof = "    1         0    0         0 NONE               0   0 NONE               0   0";
  EXPECT_EQ(only_channel(function).name, "Force");
  function.ordinate = "        13    0    0    0 NONE                 N                   ";
  EXPECT_EQ(only_channel(function).name, "function 1");
}

TEST(Uff58, TheUnitDecidesAndTheSpecificDataTypeHelps) {
  Function function;
  function.ordinate = "        13    0    0    0 Force                V                   ";
  Channel channel = only_channel(function);
  EXPECT_EQ(channel.quantity, Quantity::voltage);
  EXPECT_EQ(channel.attributes.at("stated quantity"), "force");
  function.ordinate = "        12    0    0    0 Accel                gizmo               ";
  EXPECT_EQ(only_channel(function).quantity, Quantity::acceleration);
  function.ordinate = "        11    0    0    0 NONE                 NONE                ";
  const Record record = imported(function.text());
  EXPECT_EQ(record.channels.front().unit, "");
  EXPECT_EQ(record.channels.front().quantity, Quantity::velocity);
  EXPECT_THAT(record.warnings, ElementsAre("'Hammer' states no unit"));
}

TEST(Uff58, TextMayBeUtf8OrLatin1) {
  Function function;
  function.id1 = "Beschl\xE4ufer";
  function.ordinate = "        12    0    0    0 x                    m/s\xB2                ";
  const Channel channel = only_channel(function);
  EXPECT_EQ(channel.name, "Beschl\u00E4ufer");
  EXPECT_EQ(channel.unit, "m/s\u00B2");
  EXPECT_EQ(channel.quantity, Quantity::acceleration);
}

TEST(Uff58, AnIntervalOfSixDigitsIsKeptAndTheRoundRateOffered) {
  Function function;
  function.increment = "  1.52588E-05";
  const Record record = imported(function.text());
  EXPECT_EQ(record.channels.front().clock.interval, 1.52588e-05);
  EXPECT_EQ(record.channels.front().attributes.at("nearest round rate"), "65536 Hz");
  EXPECT_THAT(record.warnings, ElementsAre("the stated interval of 1.52588E-05 s has six digits "
                                           "and gives 65535.953 Hz; --sample-rate 65536 "
                                           "sets the round rate it probably stands for"));
  ImportOptions options;
  options.sample_rate = 65536.0;
  EXPECT_EQ(imported(function.text(), options).channels.front().clock.interval, 1.0 / 65536.0);
}

TEST(Uff58, AnExactClockInIdLine5CountsWhileItAgrees) {
  Function function;
  function.increment = "  1.52588E-05";
  function.id5 = "clock: start 0 s, interval 1.52587890625e-05 s";
  EXPECT_EQ(only_channel(function).clock.interval, 1.0 / 65536.0);
  function.increment = "  3.05176E-05";  // resampled by somebody who left the line
  EXPECT_EQ(only_channel(function).clock.interval, 3.05176e-05);
  // of one sample there is no interval
  function.start = "  1.23457E+04";
  function.increment = "  0.00000E+00";
  function.id5 = "clock: start 12345.678 s, interval 0 s";
  EXPECT_EQ(only_channel(function).clock.start, 12345.678);
}

TEST(Uff58, TimesInMillisecondsBecomeSeconds) {
  Function function;
  function.abscissa = "        17    0    0    0 Time                 ms                  ";
  function.start = " -2.00000E+00";
  const Channel channel = only_channel(function);
  EXPECT_DOUBLE_EQ(channel.clock.interval, 1e-6);
  EXPECT_DOUBLE_EQ(channel.clock.start, -2e-3);
}

TEST(Uff58, RevolutionsAreNoTime) {
  Function function;
  function.abscissa = "         0    0    0    0 Shaft                rev                 ";
  const Channel channel = only_channel(function);
  EXPECT_EQ(channel.attributes.at("domain"), "other");
  EXPECT_EQ(channel.clock.interval, 0.0);
}

TEST(Uff58, ASpectrumHasNoClock) {
  Function function;
  function.dof = "    4         0    0         0 NONE               0   0 NONE               0   0";
  function.abscissa = "        18    0    0    0 Frequency            Hz                  ";
  function.start = "  1.00000E+01";
  function.increment = "  2.50000E+00";
  const Record record = imported(function.text());
  const Channel& channel = record.channels.front();
  EXPECT_EQ(channel.clock.interval, 0.0);
  EXPECT_EQ(channel.attributes.at("domain"), "frequency");
  EXPECT_EQ(channel.attributes.at("abscissa unit"), "Hz");
  EXPECT_EQ(channel.attributes.at("abscissa first"), "10");
  EXPECT_EQ(channel.attributes.at("abscissa increment"), "2.5");
  EXPECT_THAT(
      record.warnings,
      ElementsAre("'Hammer' is no time record: frequency response function over Frequency"));
}

TEST(Uff58, AnUnevenSpectrumBringsItsFrequenciesAsAChannel) {
  Function function;
  function.even = 0;
  function.abscissa = "        18    0    0    0 Frequency            Hz                  ";
  function.data =
      "  1.00000E+00  1.00000E+00  2.00000E+00  2.00000E+00  4.00000E+00  3.00000E+00\n";
  const Record record = imported(function.text());
  ASSERT_EQ(record.channels.size(), 2U);
  EXPECT_EQ(record.channels[0].name, "Hammer (abscissa)");
  EXPECT_EQ(record.channels[0].quantity, Quantity::frequency);
  EXPECT_THAT(record.channels[0].values(), ElementsAre(1.0, 2.0, 4.0));
  EXPECT_THAT(record.channels[1].values(), ElementsAre(1.0, 2.0, 3.0));
}

TEST(Uff58, WithoutPointsIsAnEmptyChannel) {
  Function function;
  function.points = 0;
  function.data = "";
  const Record record = imported(function.text());
  EXPECT_EQ(record.channels.front().size(), 0U);
  EXPECT_THAT(record.warnings, ElementsAre("'Hammer' has no samples"));
}

ImportOptions stated_format(const std::string& id) {
  ImportOptions options;
  options.format = id;
  return options;
}

TEST(Uff58, WithABrokenHeaderIsAnErrorThatNamesTheRecord) {
  Function function;
  function.type = 3;
  EXPECT_EQ(import_error(function.text()),
            place(function.text(), "         3         3") +
                ": ordinate type 3 is unknown: expected 2, 4, 5 or 6");
  function.type = 2;
  function.points = -7;
  EXPECT_EQ(import_error(function.text()), place(function.text(), "         2        -7") +
                                               ": the number of points is -7: expected 0 or more");
  function.points = 3;
  function.increment = "          abc";
  EXPECT_EQ(import_error(function.text()),
            place(function.text(), "         2         3") +
                ": record 7 of a dataset 58: expected ordinate type, points, "
                "spacing, start and increment, "
                "found '2         3         1  0.00000E+00          abc  0.00000E+00'");
  function = Function{};
  function.ordinate = "   force!!    0    0    0 Force                N                   ";
  EXPECT_EQ(import_error(function.text()),
            place(function.text(), "   force!!") +
                ": specific data type: expected an integer in columns 1 to 10, "
                "found 'force!!'");
  EXPECT_EQ(import_error("    -1\n  text\n    -1\n", stated_format("uff58")),
            "FILE:2:1 (byte 7): expected the number of a dataset in columns 1 to 6, found 'text'");
}

TEST(Uff58, RecordSevenMayBeOutOfColumns) {
  std::string text = Function{}.text();
  const std::string record =
      fmt::format("{:10}{:10}{:10}{}{}", 2, 3, 1, "  0.00000E+00", "  1.00000E-03");
  text.replace(text.find(record), record.size(), "2 3 1 0.5 1.0E-3");
  const Record read = imported(text);
  EXPECT_EQ(read.channels.front().clock.interval, 1e-3);
  EXPECT_EQ(read.channels.front().clock.start, 0.5);
}

TEST(Uff58, OtherDatasetsAreSkippedAndTheirTitleAndUnitsKept) {
  const std::string others =
      "    -1\n   151\nBeam rig\nsecond mount\nTest.Lab\n    -1\n"
      "    -1\n   164\n         1SI - mKs\n  1.00000000000000000D+00  1.00000000000000000D+00  "
      "1.00000000000000000D+00\n"
      "  2.73149999999999980D+02\n    -1\n"
      "    -1\n  1858\n         0\n    -1\n";
  const Record record = imported(others + Function{}.text());
  EXPECT_EQ(record.title, "Beam rig");
  EXPECT_EQ(record.attributes.at("model description"), "second mount");
  EXPECT_EQ(record.attributes.at("written by"), "Test.Lab");
  EXPECT_EQ(record.attributes.at("units code"), "1");
  EXPECT_EQ(record.attributes.at("units"), "SI - mKs");
  EXPECT_EQ(record.attributes.at("length factor"), "1");
  EXPECT_EQ(record.attributes.at("temperature offset"), "273.15");
  EXPECT_EQ(record.channels.size(), 1U);
  EXPECT_THAT(record.warnings, IsEmpty());
}

TEST(Uff58, AFileWithoutFunctionsHasNoChannelsAndSaysSo) {
  const Record record = imported(
      "    -1\n    15\n         1\n    -1\n    -1\n    15\n         1\n    -1\n    -1\n    82\n "
      "x\n    -1\n");
  EXPECT_THAT(record.channels, IsEmpty());
  EXPECT_THAT(
      record.warnings,
      ElementsAre("no recordings in this file: it has no dataset 58, only 15 (2 times), 82"));
}

TEST(Uff58, ADoubledDelimiterOpensOneDataset) {
  EXPECT_EQ(imported("    -1\n" + Function{}.text() + "    -1\n").channels.size(), 1U);
}

/// A function behind the closing -1 of another, which is to open it too.
std::string without_opening(const Function& function) {
  return function.text().substr(std::string_view("    -1\n").size());
}

TEST(Uff58, OneDelimiterMayCloseADatasetAndOpenTheNext) {
  Function second;
  second.id1 = "Velocity";
  const std::string title = "    -1\n   151\nBeam rig\n    -1\n";
  const std::string bytes =
      title + without_opening(Function{}) + without_opening(second) + "\n" + Function{}.text();
  const Record record = imported(bytes);
  ASSERT_EQ(record.channels.size(), 3U);
  EXPECT_EQ(record.title, "Beam rig");
  EXPECT_EQ(record.channels[1].name, "Velocity");
  EXPECT_THAT(record.channels[1].values(), ElementsAre(1.0, -2.0, 3.0));
  EXPECT_THAT(
      record.warnings,
      ElementsAre(
          HasSubstr(fmt::format(
              ":5:1 (byte {}), begin without a -1 of their own, behind the one that closes the "
              "dataset before: they are read",
              title.size())),
          HasSubstr("2 channels are called 'Hammer'")));
}

TEST(Uff58, LinesOutsideOfDatasetsAreToldOf) {
  const std::string stray = "   100 points\n  1.00000E+00\n";
  const Record record = imported(Function{}.text() + stray + Function{}.text() + "\n   \n" +
                                 std::string("\x1A\0", 2));
  EXPECT_EQ(record.channels.size(), 2U);
  EXPECT_THAT(record.warnings,
              ElementsAre(HasSubstr(":16:1 (byte"), HasSubstr("2 channels are called 'Hammer'")));
  EXPECT_THAT(record.warnings[0], testing::StartsWith("2 lines outside of datasets are not read"));
  EXPECT_THAT(record.warnings[0], testing::EndsWith(" on: '100 points'"));
}

// A lone number may be a dataset's; where it is not, nothing behind it is lost.
TEST(Uff58, ANumberOutsideOfDatasetsHidesNothing) {
  const Record record = imported(Function{}.text() + "    12\n" + Function{}.text());
  EXPECT_EQ(record.channels.size(), 2U);
  EXPECT_THAT(record.warnings, ElementsAre(HasSubstr("begin without a -1 of their own"),
                                           HasSubstr("2 channels are called 'Hammer'")));
}

TEST(Uff58Codes, ComeBackFromTheirQuantityAndName) {
  for (const Quantity quantity : {Quantity::force, Quantity::velocity, Quantity::displacement,
                                  Quantity::acceleration, Quantity::pressure, Quantity::strain,
                                  Quantity::temperature, Quantity::time, Quantity::frequency})
    EXPECT_EQ(uff58_quantity(uff58_type(quantity)), quantity);
  EXPECT_EQ(uff58_quantity(uff58_type(Quantity::voltage)), Quantity::unknown);
  for (int type = 0; type <= 28; ++type) EXPECT_EQ(uff58_function(uff58_function_name(type)), type);
  EXPECT_EQ(uff58_function_name(99), "function type 99");
  EXPECT_EQ(uff58_function("function type 99"), 0);
}

// The increment was taken in seconds without a word.
TEST(Uff58, ALabelMayTellTheUnitOfTheTimes) {
  Function function;
  function.abscissa = "        17    0    0    0 Time [ms]            NONE                ";
  const datasets::Record record = imported(function.text());
  EXPECT_DOUBLE_EQ(record.channels.at(0).clock.interval, 1e-6);
  EXPECT_THAT(record.warnings, testing::Contains(testing::HasSubstr("its label is 'Time [ms]'")));
}

}  // namespace
}  // namespace impactrig::acquisition
