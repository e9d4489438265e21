// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include "tests/acquisition/tdms_bytes.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using testing::HasSubstr;
using tests::import_error;
using tests::TdmsParts;

const TdmsParts little;

std::string error_of(const std::vector<std::string>& objects, const std::string& data,
                     std::uint32_t flags = 0) {
  const std::string error = import_error(little.segment(objects, data, flags));
  const std::size_t colon = error.find("): ");
  return colon == std::string::npos ? error : error.substr(colon + 3);
}

TEST(TdmsErrors, NameThePlaceAndWhatWasFound) {
  ImportOptions tdms;
  tdms.format = "tdms";
  EXPECT_EQ(
      import_error("TDSm\x0E"),
      "FILE (byte 5): the file ends within the lead-in of the first segment, after 5 of 28 bytes");
  EXPECT_EQ(import_error(std::string(40, 'x'), tdms),
            "FILE (byte 0): expected a segment, which begins with 'TDSm', found 'xxxx'");
  EXPECT_EQ(import_error(little.segment({}, "1234567", 0, 10, 20)),
            "FILE (byte 28): the raw data of a segment are announced 20 bytes behind its head, the "
            "segment "
            "has 10");
  EXPECT_EQ(import_error(little.segment({}, "", 0, 100, 90)),
            "FILE (byte 32): the file ends within the head of the first segment");
  const std::string channel = little.channel("a", little.index(2, 1));
  EXPECT_EQ(import_error(little.segment({channel}, "ab", 0, {}, 6)),
            "FILE (byte 34): the head of the segment at byte 0 is 34 bytes longer than announced");
  EXPECT_EQ(import_error("TDSh\x0E and so on, an index"),
            "FILE: this is the index of an NI TDMS file (.tdms_index), which is not read: state "
            "the .tdms "
            "file beside it, which holds the samples");
}

TEST(TdmsErrors, OfObjectsNameThem) {
  EXPECT_EQ(error_of({little.object("G", little.none())}, ""),
            "expected the path of a group or channel, found 'G'");
  EXPECT_EQ(error_of({little.object("/'a'/'b'/'c'", little.none())}, ""),
            "expected the path of a group or channel, found '/'a'/'b'/'c''");
  EXPECT_EQ(error_of({little.channel("a", little.same())}, ""),
            "/'G'/'a' refers to an earlier raw data index and there is none");
  EXPECT_EQ(error_of({little.channel("a", little.index(0x77, 1))}, ""),
            "/'G'/'a' has data of the unknown type 0x77");
  EXPECT_EQ(error_of({little.channel("a", little.index(2, 1, 2))}, ""),
            "/'G'/'a' has data of 2 dimensions, 1 is expected");
  EXPECT_EQ(
      error_of({little.channel("a", little.index(0x0B, 1))}, ""),
      "/'G'/'a' has numbers of extended precision, whose width in a file is not published: convert "
      "the channel to double precision with the program that wrote it");
  for (const std::uint64_t count : {std::uint64_t{1} << 63, ~std::uint64_t{0}})
    EXPECT_EQ(error_of({little.channel("a", little.index(2, count))}, "ab"),
              fmt::format("/'G'/'a' announces {} values of 2 bytes in a chunk", count));
  EXPECT_EQ(error_of({little.channel("a", little.text_index(1, std::uint64_t{1} << 50))}, "ab"),
            "/'G'/'a' announces 1125899906842624 bytes of text in a chunk");
  EXPECT_EQ(
      error_of({little.channel("a", little.none(), {little.raw_property("p", 0x4F, "")})}, ""),
      "the property 'p' of /'G'/'a' is of the type 0x4F, which is not read");
}

TEST(TdmsErrors, OfRawDataNameTheChannel) {
  EXPECT_EQ(
      error_of({little.channel("a", little.index(2, 1)), little.channel("b", little.index(2, 2))},
               "abcdef", TdmsParts::interleaved),
      "/'G'/'b' has 2 values in a chunk of interleaved data, the channels before it 1");
  EXPECT_EQ(error_of({little.channel("a", little.text_index(1, 6)),
                      little.channel("b", little.index(2, 1))},
                     "abcdefgh", TdmsParts::interleaved),
            "/'G'/'a' has texts among interleaved data");
  const std::string one = little.segment({little.channel("a", little.index(2, 1))}, "ab");
  EXPECT_THAT(
      import_error(one + little.segment({little.channel("a", little.index(3, 1))}, "abcd")),
      HasSubstr("the type of /'G'/'a' changes within the file, from 16-bit integer to 32-bit "
                "integer"));
  EXPECT_THAT(import_error(one + little.segment(
                                     {little.channel("a", little.daqmx_index(1, {{2, 0, 0}}, {2}))},
                                     "ab", 0x80)),
              HasSubstr("the type of /'G'/'a' changes within the file"));
  const TdmsParts big(true);
  EXPECT_THAT(
      import_error(little.segment({little.channel("t", little.index(0x44, 1))}, little.time(1)) +
                   big.segment({}, big.time(2), TdmsParts::bare)),
      HasSubstr("the byte order of the time stamps /'G'/'t' changes within the file"));
}

TEST(TdmsErrors, OfDaqmxDataNameTheChannel) {
  const auto daqmx = [](const std::vector<tests::TdmsScaler>& scalers,
                        const std::vector<std::uint32_t>& widths, std::uint64_t count = 1) {
    return little.daqmx_index(count, scalers, widths);
  };
  const std::string a = little.channel("a", daqmx({{3, 0, 0, 0}}, {4}));
  EXPECT_EQ(error_of({little.channel("a", daqmx({{12, 0, 0, 0}}, {2}))}, "ab", 0x80),
            "/'G'/'a' has a DAQmx scaler of the unknown type 12");
  EXPECT_EQ(error_of({little.channel("a", daqmx({{3, 1, 0, 0}}, {2}))}, "ab", 0x80),
            "/'G'/'a' is in the raw buffer 1 of 1");
  EXPECT_EQ(error_of({little.channel("a", daqmx({{3, 0, 1, 0}}, {2}))}, "ab", 0x80),
            "/'G'/'a' lies in bytes 1 to 2 of the rows of a raw buffer, which have 2");
  EXPECT_EQ(error_of({little.channel("a", daqmx({{3, 0, 0, 0}}, {2}, std::uint64_t{1} << 62))},
                     "ab", 0x80),
            "/'G'/'a' announces 4611686018427387904 values of 2 bytes in a chunk");
  EXPECT_EQ(error_of({a, little.channel("b", daqmx({{3, 0, 0, 0}}, {2}))}, "abcd", 0x80),
            "/'G'/'b' states rows of 2 bytes in the DAQmx raw data, the channels before it 4");
  EXPECT_EQ(error_of({a, little.channel("b", daqmx({{3, 0, 2, 0}}, {4}, 2))}, "abcd", 0x80),
            "/'G'/'b' states 2 rows in a DAQmx raw buffer, the channels before it 1");
  EXPECT_EQ(error_of({a, little.channel("b", little.index(2, 1))}, "abcdef", 0x80),
            "a segment mixes DAQmx raw data with other data");
  std::vector<tests::TdmsScaler> many;
  for (std::uint32_t i = 0; i < 65; ++i) many.push_back({3, 0, 0, i});
  EXPECT_EQ(error_of({little.channel("a", daqmx(many, {2}))}, "ab", 0x80),
            "/'G'/'a' has more than 64 DAQmx scalers");
}

TEST(TdmsErrors, TellOfATimeColumnThatIsNotThere) {
  ImportOptions options;
  options.time_column = "clock";
  EXPECT_EQ(import_error(little.segment({little.channel("a", little.index(2, 1))}, "ab"), options),
            "FILE (byte 0): there is no channel 'clock' to take times from");
}

}  // namespace
}  // namespace impactrig::acquisition
