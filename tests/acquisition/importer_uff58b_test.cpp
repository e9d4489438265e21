// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include "acquisition/importer.hpp"
#include "tests/acquisition/uff58_function.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Channel;
using datasets::Record;
using testing::ElementsAre;
using testing::IsEmpty;
using tests::import_error;
using tests::imported;
using tests::uff58::binary;
using tests::uff58::bytes_of;
using tests::uff58::Function;
using tests::uff58::only_channel;

TEST(Uff58b, IsReadInBothByteOrdersAndPrecisions) {
  for (const bool little : {true, false}) {
    for (const int type : {2, 4}) {
      Function function;
      function.type = type;
      function.data = type == 2 ? bytes_of<float>({1.5F, -2.5F, 0.1F}, little)
                                : bytes_of<double>({1.5, -2.5, 0.1}, little);
      function.identifier = binary(little ? 1 : 2, 2, static_cast<long>(function.data.size()));
      const Record record = imported(function.text());
      EXPECT_EQ(record.provenance.importer, "uff58b");
      EXPECT_THAT(record.channels.front().values(),
                  ElementsAre(1.5, -2.5, type == 2 ? static_cast<double>(0.1F) : 0.1));
      EXPECT_EQ(std::holds_alternative<std::vector<float>>(record.channels.front().raw), type == 2);
      EXPECT_THAT(record.warnings, IsEmpty());
    }
  }
}

// The numbers themselves tell: 1.5 read the wrong way round is 3e-319 or 7e-41.
TEST(Uff58b, AByteOrderThatIsStatedWronglyIsToldOf) {
  for (const bool little : {true, false})
    for (const int type : {2, 4}) {
      Function function;
      function.type = type;
      function.data = type == 2 ? bytes_of<float>({1.5F, -2.5F, 0.1F}, little)
                                : bytes_of<double>({1.5, -2.5, 0.1}, little);
      const auto size = static_cast<long>(function.data.size());
      function.identifier = binary(little ? 2 : 1, 2, size);
      EXPECT_THAT(
          imported(function.text()).warnings,
          ElementsAre(fmt::format(
              "'Hammer': the identifier line says that bytes are {}-endian, and the values are "
              "numbers of a measurement only the other way round: correct the byte order in "
              "columns 8 to 13 of that line",
              little ? "big" : "little")));
      function.data = std::string(function.data.size(), '\0');
      EXPECT_THAT(imported(function.text()).warnings, IsEmpty());
    }
}

TEST(Uff58b, MayCloseDirectlyOrAfterALineEnd) {
  for (const char* end : {"    -1\n", "\n    -1\n", "\r\n    -1\r\n", "    -1"}) {
    Function function;
    function.data = bytes_of<float>({1.0F, 2.0F, 3.0F}, true);
    function.identifier = binary(1, 2, 12);
    function.end = end;
    const Record record =
        imported(function.text() + (std::string_view(end).back() == '\n' ? Function{}.text() : ""));
    ASSERT_FALSE(record.channels.empty());
    EXPECT_THAT(record.channels.front().values(), ElementsAre(1.0, 2.0, 3.0));
    if (std::string_view(end).back() == '\n') {
      EXPECT_EQ(record.channels.size(), 2U);
    }
  }
}

TEST(Uff58b, DataMayContainWhatLooksLikeAnEnd) {
  Function function;
  function.points = 4;
  function.data = "\n    -1\n" + bytes_of<float>({3.0F, 4.0F}, true);
  function.identifier = binary(1, 2, 16);
  const Record record = imported(function.text());
  ASSERT_EQ(record.channels.size(), 1U);
  EXPECT_EQ(record.channels.front().size(), 4U);
  EXPECT_EQ(record.channels.front().value(3), 4.0);
}

TEST(Uff58b, ComplexAndUnevenDataAreTakenApart) {
  Function function;
  function.type = 6;
  function.points = 2;
  function.data = bytes_of<double>({1.0, -1.0, 2.0, -2.0}, false);
  function.identifier = binary(2, 2, 32);
  Channel channel = only_channel(function);
  EXPECT_THAT(channel.values(), ElementsAre(1.0, 2.0));
  EXPECT_THAT(channel.imaginary, ElementsAre(-1.0, -2.0));

  function.type = 2;
  function.even = 0;
  function.points = 3;
  function.data = bytes_of<float>({0.0F, 1.0F, 0.5F, 2.0F, 2.0F, 3.0F}, true);
  function.identifier = binary(1, 2, 24);
  channel = only_channel(function);
  EXPECT_THAT(channel.values(), ElementsAre(1.0, 2.0, 3.0));
  EXPECT_THAT(channel.clock.times, ElementsAre(0.0, 0.5, 2.0));
}

// The standard stores the abscissa of double precision data in single precision; some writers in
// double.
TEST(Uff58b, UnevenDoubleDataHaveTimesOfEitherPrecision) {
  Function function;
  function.type = 4;
  function.even = 0;
  function.points = 2;
  function.data = bytes_of<float>({0.25F}, true) + bytes_of<double>({1.0}, true) +
                  bytes_of<float>({0.5F}, true) + bytes_of<double>({2.0}, true);
  function.identifier = binary(1, 2, 24);
  Channel channel = only_channel(function);
  EXPECT_EQ(channel.clock.start, 0.25);
  EXPECT_EQ(channel.clock.interval, 0.25);
  EXPECT_THAT(channel.values(), ElementsAre(1.0, 2.0));

  function.data = bytes_of<double>({0.1, 1.0, 0.3, 2.0}, true);
  function.identifier = binary(1, 2, 16);  // one writer announces the ordinates alone
  channel = only_channel(function);
  EXPECT_EQ(channel.clock.start, 0.1);
  EXPECT_THAT(channel.values(), ElementsAre(1.0, 2.0));
}

TEST(Uff58b, TheBytesThatAreThereCountNotTheAnnouncedOnes) {
  Function function;
  function.data = bytes_of<float>({1.0F, 2.0F, 3.0F}, true);
  for (const long announced : {0L, 8L, 9999L, -5L}) {
    function.identifier = binary(1, 2, announced);
    const Record record = imported(function.text());
    ASSERT_EQ(record.channels.size(), 1U) << announced;
    EXPECT_THAT(record.channels.front().values(), ElementsAre(1.0, 2.0, 3.0));
    if (announced > 0) {
      EXPECT_THAT(record.warnings,
                  ElementsAre(fmt::format(
                      "'Hammer': the identifier line announces {} bytes of data, 12 are there",
                      announced)));
    }
  }
}

// Of a type of eight bytes, and the announced points and bytes are those of four.
TEST(Uff58b, BytesThatContradictTheOrdinateTypeAreBelievedWhereOneTypeFits) {
  for (const bool little : {true, false}) {
    Function function;
    function.type = 4;
    function.points = 4;
    function.data = bytes_of<float>({1.0F, -2.0F, 3.0F, 1234.5F}, little);
    function.identifier = binary(little ? 1 : 2, 2, 16);
    const Record record = imported(function.text());
    EXPECT_THAT(record.channels.front().values(), ElementsAre(1.0, -2.0, 3.0, 1234.5));
    EXPECT_THAT(record.warnings,
                ElementsAre("'Hammer': ordinate type 4 takes 8 bytes a point, and the header's "
                            "points and bytes give 4, as many as are there: the numbers are read "
                            "in single precision"));
  }
  Function function;
  function.type = 5;
  function.points = 2;
  function.data = bytes_of<double>({1.0, -1.0, 2.0, -2.0}, true);
  function.identifier = binary(1, 2, 32);
  const Channel channel = only_channel(function);
  EXPECT_THAT(channel.values(), ElementsAre(1.0, 2.0));
  EXPECT_THAT(channel.imaginary, ElementsAre(-1.0, -2.0));
}

TEST(Uff58b, BytesThatFitSeveralOtherTypesAreRefused) {
  Function function;  // eight bytes a point: a double, or a complex number in single precision
  function.data = bytes_of<double>({1.0, -2.0, 3.0}, true);
  function.identifier = binary(1, 2, 24);
  EXPECT_EQ(import_error(function.text()),
            fmt::format("FILE (byte {}): ordinate type 2 takes 4 bytes a point, and the header's "
                        "points and bytes give 8: which is wrong cannot be told; correct the "
                        "ordinate type in columns 1 to 10 of record 7 or the number of points "
                        "behind it",
                        function.text().find(function.data)));
}

// Two doubles that are announced as four points: as floats some are of no measurement.
TEST(Uff58b, BytesThatAreNoMeasurementAsTheOtherTypeAreRefused) {
  Function function;
  function.type = 4;
  function.points = 4;
  function.data = bytes_of<double>({2.718281828459045, 3.141592653589793}, true);
  function.identifier = binary(1, 2, 16);
  EXPECT_THAT(import_error(function.text()), testing::HasSubstr("which is wrong cannot be told"));
}

TEST(Uff58b, OneDelimiterMayCloseADatasetAndOpenTheNext) {
  Function function;
  function.data = bytes_of<float>({1.0F, 2.0F, 3.0F}, true);
  function.identifier = binary(1, 2, 12);
  const Record record = imported(function.text() + function.text().substr(7));
  ASSERT_EQ(record.channels.size(), 2U);
  EXPECT_THAT(record.channels[1].values(), ElementsAre(1.0, 2.0, 3.0));
  EXPECT_THAT(record.warnings, ElementsAre(testing::HasSubstr(" begins without a -1 of its own"),
                                           testing::HasSubstr("2 channels are called 'Hammer'")));
}

TEST(Uff58b, ACutFileGivesWhatIsThere) {
  Function function;
  function.points = 2000000000;
  function.data = bytes_of<float>({1.0F, 2.0F, 3.0F}, true).substr(0, 10);
  function.identifier = binary(1, 2, 8000000000);
  function.end = "";
  const Record record = imported(function.text());
  EXPECT_THAT(record.channels.front().values(), ElementsAre(1.0, 2.0));
  EXPECT_THAT(
      record.warnings,
      ElementsAre("'Hammer': the file ends without the closing -1: it may have been cut off",
                  "'Hammer': the identifier line announces 8000000000 bytes of data, 10 are there",
                  "'Hammer': the header announces 2000000000 points, 2 are there: these are read",
                  "the last dataset is not closed by -1: the file may have been cut off"));
}

// The bytes that the identifier line announces tell the abscissa's precision: what is left of the
// data does not.
TEST(Uff58b, ACutFileHasTimesOfEitherPrecision) {
  Function function;
  function.type = 4;
  function.even = 0;
  function.points = 4;
  function.end = "";
  function.data = bytes_of<double>({0.1, 1.0, 0.3, 2.0, 0.4, 3.0, 0.9}, true);
  function.identifier = binary(1, 2, 64);
  Channel channel = only_channel(function);
  EXPECT_THAT(channel.values(), ElementsAre(1.0, 2.0, 3.0));
  EXPECT_THAT(channel.clock.times, ElementsAre(0.1, 0.3, 0.4));

  function.points = 1000;  // more than bytes that are there
  function.identifier = binary(1, 2, 16000);
  EXPECT_THAT(only_channel(function).values(), ElementsAre(1.0, 2.0, 3.0));

  function.points = 4;
  function.data = bytes_of<float>({0.25F}, true) + bytes_of<double>({1.0}, true) +
                  bytes_of<float>({0.5F}, true) + bytes_of<double>({2.0}, true);
  function.identifier = binary(1, 2, 48);
  EXPECT_THAT(only_channel(function).values(), ElementsAre(1.0, 2.0));
}

TEST(Uff58b, WithoutDataIsAnError) {
  Function function;
  function.identifier = binary(1, 2, 12);
  function.data = "";
  EXPECT_EQ(import_error(function.text()),
            fmt::format("FILE (byte {})", function.text().size() - 7) +
                ": 3 points are announced and no data are there");
}

TEST(Uff58b, FloatsOfOtherMachinesAreNamedAndRefused) {
  Function function;
  function.identifier = binary(1, 1, 12);
  EXPECT_EQ(import_error(function.text()),
            "FILE:2:1 (byte 7): UFF 58b with DEC VAX floating-point numbers is not read: export it "
            "with IEEE numbers or as "
            "text (dataset 58)");
  function.identifier = binary(2, 3, 12);
  EXPECT_EQ(import_error(function.text()),
            "FILE:2:1 (byte 7): UFF 58b with IBM 370 floating-point numbers is not read: export it "
            "with IEEE numbers or as "
            "text (dataset 58)");
  function.identifier = binary(1, 7, 12);
  EXPECT_EQ(import_error(function.text()),
            "FILE:2:1 (byte 7): floating-point format 7 is unknown: expected 2 (IEEE)");
  function.identifier = binary(3, 2, 12);
  EXPECT_EQ(import_error(function.text()),
            "FILE:2:1 (byte 7): byte order 3 is unknown: expected 1 (little) or 2 (big)");
}

}  // namespace
}  // namespace impactrig::acquisition
