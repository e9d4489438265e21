// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/acquisition/mdf4_bytes.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using testing::ElementsAre;
using tests::bytes_of_number;
using tests::imported;
using tests::mdf_channel;
using tests::mdf_file_of;
using tests::mdf_time;
using tests::MdfChannelBlock;
using tests::MdfFile;
using tests::MdfTicks;

std::vector<double> read_as(std::uint8_t data_type, std::uint32_t bits, const std::string& records,
                            std::uint8_t bit = 0) {
  const auto bytes = static_cast<std::uint32_t>((bit + bits + 7) / 8);
  return imported(mdf_file_of({mdf_channel("a", data_type, bits, 0, bit)}, records, bytes))
      .channels.at(0)
      .values();
}

class MdfInBothByteOrders : public testing::TestWithParam<bool> {
 protected:
  template <typename Number>
  std::string numbers(const std::vector<Number>& values) const {
    return tests::bytes_of_numbers(values, GetParam());
  }

  std::uint8_t unsigned_{GetParam()};
  std::uint8_t signed_ = static_cast<std::uint8_t>(2 + unsigned_);
  std::uint8_t float_ = static_cast<std::uint8_t>(4 + unsigned_);
  std::uint8_t complex_ = static_cast<std::uint8_t>(15 + unsigned_);
};

INSTANTIATE_TEST_SUITE_P(Mdf4, MdfInBothByteOrders, testing::Bool());

TEST_P(MdfInBothByteOrders, EveryKindOfNumberIsRead) {
  EXPECT_THAT(read_as(unsigned_, 8, numbers(std::vector<std::uint8_t>{200, 1})),
              ElementsAre(200, 1));
  EXPECT_THAT(read_as(signed_, 8, numbers(std::vector<std::int8_t>{-100, 1})),
              ElementsAre(-100, 1));
  EXPECT_THAT(read_as(unsigned_, 16, numbers(std::vector<std::uint16_t>{60000})),
              ElementsAre(60000));
  EXPECT_THAT(read_as(signed_, 16, numbers(std::vector<std::int16_t>{-30000})),
              ElementsAre(-30000));
  EXPECT_THAT(read_as(unsigned_, 32, numbers(std::vector<std::uint32_t>{4000000000})),
              ElementsAre(4000000000));
  EXPECT_THAT(read_as(signed_, 32, numbers(std::vector<std::int32_t>{-70000})),
              ElementsAre(-70000));
  EXPECT_THAT(read_as(unsigned_, 64, numbers(std::vector<std::uint64_t>{5000000000})),
              ElementsAre(5000000000));
  EXPECT_THAT(read_as(signed_, 64, numbers(std::vector<std::int64_t>{-5000000000})),
              ElementsAre(-5000000000));
  EXPECT_THAT(read_as(float_, 32, numbers(std::vector<float>{0.5F})), ElementsAre(0.5));
  EXPECT_THAT(read_as(float_, 64, numbers(std::vector<double>{0.1})), ElementsAre(0.1));
  // half precision: 1, -2, the largest, the smallest (IEEE 754: 0x3C00, 0xC000, 0x7BFF, 0x0001)
  EXPECT_THAT(read_as(float_, 16, numbers(std::vector<std::uint16_t>{0x3C00, 0xC000, 0x7BFF, 1})),
              ElementsAre(1, -2, 65504, 5.9604644775390625e-08));
}

TEST_P(MdfInBothByteOrders, BitsMayBeginAndEndWithinABytes) {
  // 12 bits from bit 4 on of 0xABCD are 0xABC, from bit 2 on 10 bits are 0x2F3
  const std::string word = numbers(std::vector<std::uint16_t>{0xABCD});
  EXPECT_THAT(read_as(unsigned_, 12, word, 4), ElementsAre(0xABC));
  EXPECT_THAT(read_as(signed_, 12, word, 4), ElementsAre(0xABC - 0x1000));
  EXPECT_THAT(read_as(unsigned_, 10, word, 2), ElementsAre(0x2F3));
  EXPECT_THAT(read_as(unsigned_, 1, "\x20", 5), ElementsAre(1));
  EXPECT_THAT(read_as(signed_, 1, "\x20", 5), ElementsAre(-1));
  // 64 bits from bit 1 on take nine bytes: (2^64 - 2) / 2 with the ninth's lowest bit
  const std::string nine = GetParam() ? std::string("\x01") + std::string(8, '\0')
                                      : std::string(8, '\0') + std::string("\x01");
  EXPECT_THAT(read_as(unsigned_, 64, nine, 1), ElementsAre(9223372036854775808.0));
  EXPECT_THAT(read_as(signed_, 64, nine, 1), ElementsAre(-9223372036854775808.0));
}

TEST_P(MdfInBothByteOrders, IntegersThatADoubleDoesNotHoldAreToldOf) {
  const std::string records = numbers(std::vector<std::uint64_t>{9007199254740995, 7});
  EXPECT_THAT(imported(mdf_file_of({mdf_channel("a", unsigned_, 64, 0)}, records, 8)).warnings,
              testing::Contains("'a': 1 sample is beyond 2^53, where doubles do not hold every "
                                "integer: it is rounded to 16 digits"));
}

TEST_P(MdfInBothByteOrders, ComplexNumbersHaveTwoParts) {
  const std::string records =
      numbers(std::vector<float>{1, 2}) + numbers(std::vector<double>{3, 4});
  const auto record = imported(mdf_file_of(
      {mdf_channel("s", complex_, 64, 0), mdf_channel("d", complex_, 128, 8)}, records, 24));
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(1));
  EXPECT_THAT(record.channels.at(0).imaginary, ElementsAre(2));
  EXPECT_THAT(record.channels.at(1).values(), ElementsAre(3));
  EXPECT_THAT(record.channels.at(1).imaginary, ElementsAre(4));
}

// IEEE 754: 1, -2, 0.5, 65504
TEST_P(MdfInBothByteOrders, ComplexHalfPrecisionIsRead) {
  const auto record =
      imported(mdf_file_of({mdf_channel("h", complex_, 32, 0)},
                           numbers(std::vector<std::uint16_t>{0x3C00, 0xC000, 0x3800, 0x7BFF}), 4));
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(1, 0.5));
  EXPECT_THAT(record.channels.at(0).imaginary, ElementsAre(-2, 65504));
}

TEST(Mdf4, TheMasterGivesTheClock) {
  for (const bool even : {true, false}) {
    const MdfTicks ticks(even ? std::vector<std::uint32_t>{0, 2, 4, 6}
                              : std::vector<std::uint32_t>{0, 1, 5, 6});
    MdfFile file;
    const std::uint64_t comment = file.text(
        "<HDcomment><TX>run &lt;7&gt; &amp;lt; 5 &#181;m &#x2264; &#xb0;&nix; &</TX></HDcomment>",
        "MD");
    const std::uint64_t group = file.group(file.channels(MdfTicks::channels(file)), 4, 7);
    const std::uint64_t data = file.block("DT", {}, ticks.bytes);
    const auto record =
        imported(file.with(file.data_group(group, data), 1500000000250000000, 0, comment));
    ASSERT_EQ(record.channels.size(), 1U);
    const datasets::Channel& force = record.channels[0];
    EXPECT_EQ(force.name, "F");
    EXPECT_EQ(force.unit, "kN");
    EXPECT_EQ(force.quantity, datasets::Quantity::force);
    EXPECT_EQ(force.scale, 0.5);
    EXPECT_THAT(force.values(), ElementsAre(-1, 49, 99, 149));
    EXPECT_EQ(force.attributes.at("group"), "group 0");
    EXPECT_EQ(force.attributes.at("acquisition"), "10ms");
    EXPECT_EQ(record.started, "2017-07-14T02:40:00.25Z");
    EXPECT_EQ(record.attributes.at("comment"), "run <7> &lt; 5 µm ≤ °&nix; &");
    EXPECT_EQ(record.attributes.at("version"), "4.10");
    EXPECT_EQ(record.attributes.at("written by"), "tests");
    EXPECT_EQ(force.clock.start, 0.5);
    EXPECT_EQ(force.clock.uniform(), even);
    if (even)
      EXPECT_DOUBLE_EQ(force.clock.interval, 2e-3);
    else
      EXPECT_THAT(force.clock.times, ElementsAre(0.5, 0.501, 0.505, 0.506));
  }
}

TEST(Mdf4, AStatedRateCountsFromZeroWhereTimesAreNoNumbers) {
  MdfFile file;
  const std::uint64_t group =
      file.group(file.channels({mdf_time(), mdf_channel("F", 0, 8, 8)}), 3, 9);
  std::string records;
  for (const std::int8_t value : std::vector<std::int8_t>{1, 2, 3})
    records += bytes_of_number(std::nan("")) + bytes_of_number(value);
  const std::string bytes = file.with(file.data_group(group, file.block("DT", {}, records)));
  ImportOptions options;
  options.sample_rate = 1000.0;
  EXPECT_EQ(imported(bytes, options).channels.at(0).clock.start, 0.0);
  options.from = 1.5e-3;
  const auto part = imported(bytes, options);
  EXPECT_EQ(part.channels.at(0).clock.start, 2e-3);
  EXPECT_THAT(part.channels[0].values(), ElementsAre(3));
}

TEST(Mdf4, LocalTimeHasNoZone) {
  MdfFile file;
  EXPECT_EQ(imported(file.with(0, 1500000000000000000, 1)).started, "2017-07-14T02:40:00");
}

TEST(Mdf4, AVirtualMasterCountsRecords) {
  MdfFile file;
  MdfChannelBlock master = mdf_time();
  master.type = 3;
  master.conversion = file.conversion(1, {-1, 0.25});
  const std::uint64_t group = file.group(file.channels({master, mdf_channel("a", 0, 8, 0)}), 3, 1);
  const auto record = imported(file.with(file.data_group(group, file.block("DT", {}, "abc"))));
  EXPECT_EQ(record.channels.at(0).clock.start, -1.0);
  EXPECT_EQ(record.channels.at(0).clock.interval, 0.25);
}

TEST(Mdf4, AVirtualMasterMayBeInMilliseconds) {
  MdfFile file;
  MdfChannelBlock master = mdf_time();
  master.type = 3;
  master.unit = "ms";
  master.conversion = file.conversion(1, {500, 1});
  const std::uint64_t group = file.group(file.channels({master, mdf_channel("a", 0, 8, 0)}), 3, 1);
  const auto record = imported(file.with(file.data_group(group, file.block("DT", {}, "abc"))));
  EXPECT_DOUBLE_EQ(record.channels.at(0).clock.start, 0.5);
  EXPECT_DOUBLE_EQ(record.channels.at(0).clock.interval, 0.001);
}

TEST(Mdf4, AMasterThatIsNoTimeIsAChannelOfItsOwn) {
  MdfFile file;
  MdfChannelBlock master = mdf_time();
  master.name = "crank";
  master.sync = 2;
  const std::uint64_t group = file.group(file.channels({master}), 1, 8);
  const auto record =
      imported(file.with(file.data_group(group, file.block("DT", {}, bytes_of_number(1.5)))));
  EXPECT_EQ(record.channels.at(0).name, "crank");
  EXPECT_EQ(record.channels.at(0).attributes.at("domain"), "angle");
  EXPECT_EQ(record.channels.at(0).clock.interval, 0.0);
}

// The same records in one block, cut at every place into a list, compressed, transposed, with
// record ids: all windows are parts of the whole.
TEST(Mdf4, RecordsAreTheSameHoweverTheyAreStored) {
  const MdfTicks ticks({0, 1, 5, 6, 9, 10});
  const auto made = [&](int form, std::size_t cut) {
    MdfFile file;
    std::uint64_t data = 0;
    if (form == 0) data = file.block("DT", {}, ticks.bytes);
    if (form == 1) data = file.compressed(ticks.bytes);
    if (form == 2) data = file.compressed(ticks.bytes, 7);
    if (form == 3) {
      const std::uint64_t second =
          file.list({file.compressed(ticks.bytes.substr(cut), static_cast<std::uint32_t>(5))});
      const std::uint64_t first =
          file.list({file.block("DT", {}, ticks.bytes.substr(0, cut))}, second);
      data = file.block("HL", {first}, std::string(8, '\0'));
    }
    if (form == 4) {
      std::string with_ids;
      for (std::size_t i = 0; i < ticks.count; ++i) with_ids += "\1" + ticks.bytes.substr(7 * i, 7);
      data = file.block("DT", {}, with_ids);
    }
    const std::uint64_t empty = file.group(0, 0, 3);
    const std::uint64_t group = file.group(file.channels(MdfTicks::channels(file)), ticks.count, 7,
                                           0, form == 4 ? empty : 0);
    return file.with(file.data_group(group, data, form == 4 ? 1 : 0));
  };
  for (int form = 0; form < 5; ++form)
    for (std::size_t cut = 1; cut < (form == 3 ? ticks.bytes.size() : 2); ++cut) {
      SCOPED_TRACE(fmt::format("form {}, cut at {}", form, cut));
      const std::string file = made(form, cut);
      EXPECT_THAT(imported(file).channels.at(0).values(), ElementsAre(-1, 49, 99, 149, 199, 249));
      ImportOptions options;
      options.from = 0.501;
      options.to = 0.5065;
      options.channels = {"F"};
      const auto part = imported(file, options);
      EXPECT_THAT(part.channels.at(0).values(), ElementsAre(49, 99, 149));
      EXPECT_THAT(part.channels.at(0).clock.times, ElementsAre(0.501, 0.505, 0.506));
    }
}

TEST(Mdf4, AWindowOfAUniformClockIsCounted) {
  const MdfTicks ticks({0, 2, 4, 6});
  MdfFile file;
  const std::uint64_t group = file.group(file.channels(MdfTicks::channels(file)), 4, 7);
  ImportOptions options;
  options.from = 0.502;
  options.to = 0.504;
  const auto record =
      imported(file.with(file.data_group(group, file.block("DT", {}, ticks.bytes))), options);
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(49, 99));
  EXPECT_DOUBLE_EQ(record.channels.at(0).clock.start, 0.502);
}

TEST(Mdf4, InvalidationBitsMarkSamples) {
  MdfFile file;
  MdfChannelBlock channel = mdf_channel("a", 0, 8, 0);
  channel.flags = 2;
  channel.invalid_bit = 9;
  const std::uint64_t group = file.group(file.channels({channel}), 3, 1, 2);
  const std::uint64_t data =
      file.block("DT", {}, std::string("\x0A\xFF\x00\x0B\x00\x02\x0C\x00\xFD", 9));
  const auto record = imported(file.with(file.data_group(group, data)));
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(10, 11, 12));
  EXPECT_THAT(record.channels.at(0).valid, ElementsAre(1, 0, 1));
}

TEST(Mdf4, AChannelWithoutAValidValueIsMarked) {
  MdfFile file;
  MdfChannelBlock channel = mdf_channel("a", 0, 8, 0);
  channel.flags = 1;
  const std::uint64_t group = file.group(file.channels({channel}), 2, 1);
  const auto record = imported(file.with(file.data_group(group, file.block("DT", {}, "\5\6"))));
  EXPECT_THAT(record.channels.at(0).valid, ElementsAre(0, 0));
  EXPECT_EQ(record.warnings.at(0),
            "'a': the file says that none of its values is valid: all are marked");
}

TEST(Mdf4, WhatIsNoNumberIsLeftOutAndTold) {
  MdfChannelBlock variable = mdf_channel("v", 0, 64, 0);
  variable.type = 1;
  const auto record =
      imported(mdf_file_of({mdf_channel("s", 6, 8, 0), variable, mdf_channel("b", 10, 8, 0),
                            mdf_channel("c", 14, 8, 0), mdf_channel("a", 0, 8, 0)},
                           "12345678", 8));
  EXPECT_EQ(record.channels.size(), 1U);
  EXPECT_EQ(record.warnings.at(0),
            "4 channels of texts, byte arrays or record numbers are left out: 's', 'v', 'b', ...");
}

// They were left out without a word.
TEST(Mdf4, RecordsBeyondTheCountAreToldOf) {
  const MdfTicks ticks({0, 2, 4, 6});
  for (const std::uint64_t count : {2U, 0U}) {
    MdfFile file;
    const std::uint64_t group = file.group(file.channels(MdfTicks::channels(file)), count, 7);
    const std::uint64_t header = file.data_group(group, 0);
    file.put(header + 24 + 16, bytes_of_number(file.block("DT", {}, ticks.bytes)));
    const auto record = imported(file.with(header));
    EXPECT_EQ(record.channels.at(0).size(), count);
    EXPECT_THAT(record.warnings,
                testing::Contains(fmt::format("group 0 announces {} records, 4 are there: the last "
                                              "ones are not read",
                                              count)));
  }
}

TEST(Mdf4, CutAndUnfinishedFilesGiveWhatIsThere) {
  const MdfTicks ticks({0, 2, 4, 6});
  MdfFile cut;
  const std::uint64_t group = cut.group(cut.channels(MdfTicks::channels(cut)), 4, 7);
  const std::uint64_t header = cut.data_group(group, 0);
  const std::uint64_t data = cut.block("DT", {}, ticks.bytes);
  cut.put(header + 24 + 16, bytes_of_number(data));
  const std::string bytes = cut.with(header);
  const auto record = imported(bytes.substr(0, bytes.size() - 8));
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(-1, 49));
  EXPECT_EQ(record.warnings.at(0), "group 0 announces 4 records, 2 are there");
  const auto nothing = imported(bytes.substr(0, data));
  EXPECT_EQ(nothing.channels.at(0).size(), 0U);
  EXPECT_EQ(nothing.warnings.at(0), "the file ends before its data do");

  MdfFile open("4.10    ", "UnFinMF ", 5);  // records not counted, length of data not written
  const std::uint64_t open_group = open.group(open.channels(MdfTicks::channels(open)), 0, 7);
  const std::uint64_t open_header = open.data_group(open_group, 0);
  const std::uint64_t open_data = open.block("DT", {}, ticks.bytes);
  open.put(open_data + 8, bytes_of_number(std::uint64_t{24}));
  open.put(open_header + 24 + 16, bytes_of_number(open_data));
  const auto unfinished = imported(open.with(open_header));
  EXPECT_THAT(unfinished.channels.at(0).values(), ElementsAre(-1, 49, 99, 149));
  EXPECT_EQ(unfinished.warnings.at(0),
            "the recording was not finished (aborted?): what is there is read");
}

TEST(Mdf4, CountsThatAreNotUpToDateGiveWayToTheData) {
  const MdfTicks ticks({0, 2, 4, 6});
  for (const std::uint64_t count : {2, 9}) {
    MdfFile file("4.10    ", "UnFinMF ", 1);
    const std::uint64_t group = file.group(file.channels(MdfTicks::channels(file)), count, 7);
    const std::uint64_t data = file.block("DT", {}, ticks.bytes);
    const auto record = imported(file.with(file.data_group(group, data)));
    EXPECT_THAT(record.channels.at(0).values(), ElementsAre(-1, 49, 99, 149));
    EXPECT_THAT(record.warnings,
                ElementsAre("the recording was not finished (aborted?): what is there is read"));
  }
}

}  // namespace
}  // namespace impactrig::acquisition
