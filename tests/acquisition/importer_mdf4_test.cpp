// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <cmath>
#include <functional>

#include "datasets/input_error.hpp"
#include "tests/acquisition/mdf4_bytes.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using tests::bytes_of_number;
using tests::import_error;
using tests::imported;
using tests::mdf_time;
using tests::MdfChannelBlock;
using tests::MdfFile;

MdfChannelBlock described(const std::string& name, std::uint8_t data_type, std::uint32_t bits,
                          std::uint32_t byte, std::uint8_t bit = 0) {
  MdfChannelBlock channel;
  channel.name = name;
  channel.data_type = data_type;
  channel.bits = bits;
  channel.byte = byte;
  channel.bit = bit;
  return channel;
}

/// A file of one group without times.
std::string file_of(const std::vector<MdfChannelBlock>& channels, const std::string& records,
                    std::uint32_t record_bytes) {
  MdfFile file;
  const std::uint64_t data = file.block("DT", {}, records);
  const std::uint64_t group =
      file.group(file.channels(channels), records.size() / record_bytes, record_bytes);
  return file.with(file.data_group(group, data));
}

std::vector<double> read_as(std::uint8_t data_type, std::uint32_t bits, const std::string& records,
                            std::uint8_t bit = 0) {
  const auto bytes = static_cast<std::uint32_t>((bit + bits + 7) / 8);
  return imported(file_of({described("a", data_type, bits, 0, bit)}, records, bytes))
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

TEST_P(MdfInBothByteOrders, ComplexNumbersHaveTwoParts) {
  const std::string records =
      numbers(std::vector<float>{1, 2}) + numbers(std::vector<double>{3, 4});
  const auto record = imported(
      file_of({described("s", complex_, 64, 0), described("d", complex_, 128, 8)}, records, 24));
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(1));
  EXPECT_THAT(record.channels.at(0).imaginary, ElementsAre(2));
  EXPECT_THAT(record.channels.at(1).values(), ElementsAre(3));
  EXPECT_THAT(record.channels.at(1).imaginary, ElementsAre(4));
}

/// Records of a time in ticks of a millisecond (u32) and a value (i16), 7 bytes with a last one
/// that nobody reads.
struct Ticks {
  std::string bytes;
  std::size_t count = 0;

  explicit Ticks(const std::vector<std::uint32_t>& ticks) : count(ticks.size()) {
    for (std::size_t i = 0; i < ticks.size(); ++i)
      bytes +=
          bytes_of_number(ticks[i]) + bytes_of_number(static_cast<std::int16_t>(100 * i)) + "x";
  }

  static std::vector<MdfChannelBlock> channels(MdfFile& file) {
    MdfChannelBlock time = mdf_time();
    time.data_type = 0;
    time.bits = 32;
    time.conversion = file.conversion(1, {0.5, 1e-3});
    MdfChannelBlock force = described("F", 2, 16, 4);
    force.unit = "kN";
    force.conversion = file.conversion(1, {-1, 0.5});
    return {time, force};
  }
};

TEST(Mdf4, TheMasterGivesTheClock) {
  for (const bool even : {true, false}) {
    const Ticks ticks(even ? std::vector<std::uint32_t>{0, 2, 4, 6}
                           : std::vector<std::uint32_t>{0, 1, 5, 6});
    MdfFile file;
    const std::uint64_t comment = file.text(
        "<HDcomment><TX>run &lt;7&gt; &amp;lt; 5 &#181;m &#x2264; &#xb0;&nix; &</TX></HDcomment>",
        "MD");
    const std::uint64_t group = file.group(file.channels(Ticks::channels(file)), 4, 7);
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
      file.group(file.channels({mdf_time(), described("F", 0, 8, 8)}), 3, 9);
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
  const std::uint64_t group = file.group(file.channels({master, described("a", 0, 8, 0)}), 3, 1);
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
  const std::uint64_t group = file.group(file.channels({master, described("a", 0, 8, 0)}), 3, 1);
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
  const Ticks ticks({0, 1, 5, 6, 9, 10});
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
    const std::uint64_t group =
        file.group(file.channels(Ticks::channels(file)), ticks.count, 7, 0, form == 4 ? empty : 0);
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
  const Ticks ticks({0, 2, 4, 6});
  MdfFile file;
  const std::uint64_t group = file.group(file.channels(Ticks::channels(file)), 4, 7);
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
  MdfChannelBlock channel = described("a", 0, 8, 0);
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
  MdfChannelBlock channel = described("a", 0, 8, 0);
  channel.flags = 1;
  const std::uint64_t group = file.group(file.channels({channel}), 2, 1);
  const auto record = imported(file.with(file.data_group(group, file.block("DT", {}, "\5\6"))));
  EXPECT_THAT(record.channels.at(0).valid, ElementsAre(0, 0));
  EXPECT_EQ(record.warnings.at(0),
            "'a': the file says that none of its values is valid: all are marked");
}

std::vector<double> converted(std::uint8_t type, const std::vector<double>& parameters,
                              const std::vector<double>& raw) {
  MdfFile file;
  MdfChannelBlock channel = described("a", 4, 64, 0);
  channel.conversion = file.conversion(type, parameters, file.text("mV"));
  const std::uint64_t group = file.group(file.channels({channel}), raw.size(), 8);
  const auto record = imported(
      file.with(file.data_group(group, file.block("DT", {}, tests::bytes_of_numbers(raw)))));
  EXPECT_EQ(record.channels.at(0).unit, "mV");
  return record.channels.at(0).values();
}

TEST(Mdf4Conversions, FollowTheirDefinition) {
  EXPECT_THAT(converted(0, {}, {1, 2}), ElementsAre(1, 2));
  EXPECT_THAT(converted(1, {3, 2}, {1, 2}), ElementsAre(5, 7));
  EXPECT_THAT(converted(2, {1, 2, 3, 0, 1, 1}, {1, 2}), ElementsAre(3, 11.0 / 3.0));
  EXPECT_THAT(converted(2, {0, 6, 4, 0, 0, 2}, {1, 2}), ElementsAre(5, 8));
  const std::vector<double> table = {0, 0, 1, 10, 3, 50};
  EXPECT_THAT(converted(4, table, {-1, 0, 0.5, 2, 3, 9}), ElementsAre(0, 0, 5, 30, 50, 50));
  EXPECT_THAT(converted(5, table, {-1, 0.4, 0.6, 1.9, 2.1, 9}), ElementsAre(0, 0, 10, 10, 50, 50));
  EXPECT_THAT(converted(6, {0, 1, 10, 1, 3, 20, -7}, {0, 0.5, 1, 2, 3, 9}),
              ElementsAre(10, 10, 20, 20, -7, -7));
}

TEST(Mdf4Conversions, AFormulaIsCalculated) {
  const auto read = [](const std::string& text) {
    MdfFile file;
    MdfChannelBlock channel = described("a", 2, 16, 0);
    channel.unit = "N";
    channel.conversion = file.formula(text);
    const std::uint64_t group = file.group(file.channels({channel}), 2, 2);
    return imported(
        file.with(file.data_group(group, file.block("DT", {}, std::string("\3\0\5\0", 4)))));
  };
  const auto record = read("2 * X1 ** 2 - X");
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(15, 45));
  EXPECT_EQ(record.channels.at(0).unit, "N");
  for (const std::string& warning : record.warnings)
    EXPECT_EQ(warning.find("unscaled"), std::string::npos) << warning;
  const auto unread = read("X^2");
  EXPECT_THAT(unread.channels.at(0).values(), ElementsAre(3, 5));
  EXPECT_EQ(unread.channels.at(0).unit, "");
  EXPECT_EQ(
      unread.warnings.at(0),
      "'a' is read unscaled, without its unit 'N': its conversion is the formula 'X^2': '^' is "
      "a power to some programs and an exclusive or to others");
}

// The upper end of a range of integers is part of it, of floating-point numbers it is not.
TEST(Mdf4Conversions, RangesOfIntegersHoldTheirUpperEnds) {
  MdfFile file;
  MdfChannelBlock channel = described("a", 0, 8, 0);
  channel.conversion = file.conversion(6, {0, 1, 10, 2, 3, 20, -7});
  const std::uint64_t group = file.group(file.channels({channel}), 5, 1);
  const std::uint64_t data = file.block("DT", {}, std::string("\0\1\2\3\4", 5));
  EXPECT_THAT(imported(file.with(file.data_group(group, data))).channels.at(0).values(),
              ElementsAre(10, 10, 20, 20, -7));
}

TEST(Mdf4Conversions, ThatCannotBeAppliedLeaveTheRawNumbersWithoutUnit) {
  const auto told = [](std::uint8_t type, const std::vector<double>& parameters) {
    MdfFile file;
    MdfChannelBlock channel = described("a", 0, 8, 0);
    channel.unit = "N";
    channel.conversion = file.conversion(type, parameters);
    const std::uint64_t group = file.group(file.channels({channel}), 1, 1);
    const auto record = imported(file.with(file.data_group(group, file.block("DT", {}, "\5"))));
    EXPECT_THAT(record.channels.at(0).values(), ElementsAre(5));
    EXPECT_EQ(record.channels.at(0).unit, "");
    return record.warnings.at(0);
  };
  const std::string begin = "'a' is read unscaled, without its unit 'N': its conversion ";
  EXPECT_EQ(told(3, {}), begin + "is a formula and states none");
  EXPECT_EQ(told(7, {1}), begin + "gives texts");
  EXPECT_EQ(told(9, {}), begin + "is of the type 9");
  EXPECT_EQ(told(1, {NAN, 1}), begin + "is not finite");
  EXPECT_EQ(told(4, {1, 1, 1, 2}), begin + "is a table whose keys do not increase");
}

// As signals have it that keep some of their numbers for "not available" and "error".
TEST(Mdf4Conversions, TextsForSomeNumbersLeaveTheOthersScaled) {
  const auto read = [](const auto& conversion_in) {
    MdfFile file;
    MdfChannelBlock channel = described("a", 0, 8, 0);
    channel.unit = "";
    channel.conversion = conversion_in(file);
    const std::uint64_t group = file.group(file.channels({channel}), 4, 1);
    return imported(file.with(file.data_group(group, file.block("DT", {}, "\1\2\3\5"))));
  };
  const auto default_scale = read([](MdfFile& file) {
    return file.text_or_scale(7, {3},
                              {file.text("error"), file.conversion(1, {1, 2}, file.text("N"))});
  });
  EXPECT_EQ(default_scale.channels.at(0).unit, "N");
  EXPECT_THAT(default_scale.channels[0].values(),
              ElementsAre(3, 5, testing::NanSensitiveDoubleEq(NAN), 11));
  EXPECT_THAT(default_scale.channels[0].valid, ElementsAre(1, 1, 0, 1));
  const auto range_scale = read([](MdfFile& file) {
    return file.text_or_scale(8, {0, 2, 3, 4}, {file.conversion(1, {0, 10}), file.text("error")});
  });
  EXPECT_THAT(
      range_scale.channels.at(0).values(),
      ElementsAre(10, 20, testing::NanSensitiveDoubleEq(NAN), testing::NanSensitiveDoubleEq(NAN)));
  const auto texts = read([](MdfFile& file) {
    const std::uint64_t no_numbers = file.text_or_scale(7, {1}, {file.text("on")});
    return file.text_or_scale(7, {3}, {file.text("error"), no_numbers});
  });
  EXPECT_THAT(texts.channels.at(0).values(), ElementsAre(1, 2, 3, 5));
  EXPECT_THAT(texts.warnings.at(0), HasSubstr("its conversion gives texts"));
}

TEST(Mdf4, WhatIsNoNumberIsLeftOutAndTold) {
  MdfChannelBlock variable = described("v", 0, 64, 0);
  variable.type = 1;
  const auto record = imported(file_of({described("s", 6, 8, 0), variable, described("b", 10, 8, 0),
                                        described("c", 14, 8, 0), described("a", 0, 8, 0)},
                                       "12345678", 8));
  EXPECT_EQ(record.channels.size(), 1U);
  EXPECT_EQ(record.warnings.at(0),
            "4 channels of texts or byte arrays are left out: 's', 'v', 'b', ...");
}

// Two records of eight bytes, 0 to 7 and 8 to 15.
datasets::Record of_bytes(MdfFile& file, const std::vector<MdfChannelBlock>& channels,
                          std::uint32_t invalid_bytes = 0) {
  std::string records;
  for (char i = 0; i < 16; ++i) records += i;
  const std::uint64_t group =
      file.group(file.channels(channels), 16 / (8 + invalid_bytes), 8, invalid_bytes);
  return imported(file.with(file.data_group(group, file.block("DT", {}, records))));
}

std::vector<std::string> names_of(const datasets::Record& record) {
  std::vector<std::string> names;
  for (const datasets::Channel& channel : record.channels) names.push_back(channel.name);
  return names;
}

TEST(Mdf4Structures, AreReadMemberByMember) {
  MdfFile file;
  MdfChannelBlock inner = described("s.inner", 10, 16, 4);
  inner.composition = file.channels({described("deep", 0, 8, 5)});
  MdfChannelBlock structure = described("s", 10, 64, 0);
  MdfChannelBlock text = described("s.text", 6, 8, 1);
  structure.composition =
      file.channels({described("s.a", 0, 8, 2), described("b", 0, 8, 3), text, inner});
  const auto record = of_bytes(file, {structure, described("z", 0, 8, 7)});
  EXPECT_THAT(names_of(record), ElementsAre("s.a", "s.b", "s.inner.deep", "z"));
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(2, 10));
  EXPECT_THAT(record.channels.at(1).values(), ElementsAre(3, 11));
  EXPECT_THAT(record.channels.at(2).values(), ElementsAre(5, 13));
  EXPECT_EQ(record.warnings.at(0), "1 channel of texts or byte arrays is left out: 's.text'");
}

TEST(Mdf4Structures, MayBeAWordAndItsBits) {
  MdfFile file;
  MdfChannelBlock word = described("status", 0, 8, 6);
  word.composition =
      file.channels({described("status.odd", 0, 1, 6), described("two", 0, 1, 6, 1)});
  const auto record = of_bytes(file, {word});
  EXPECT_THAT(names_of(record), ElementsAre("status", "status.odd", "status.two"));
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(6, 14));
  EXPECT_THAT(record.channels.at(1).values(), ElementsAre(0, 0));
  EXPECT_THAT(record.channels.at(2).values(), ElementsAre(1, 1));
}

TEST(Mdf4Arrays, AreReadElementByElement) {
  MdfFile file;
  MdfChannelBlock row = described("row", 0, 8, 1);
  row.composition = file.array({3}, 2);
  MdfChannelBlock matrix = described("m", 0, 8, 0);
  matrix.composition = file.array({2, 3}, 1);
  MdfChannelBlock columns = described("c", 0, 8, 0);
  columns.composition = file.array({2, 3}, 1, 0, 0x40);
  MdfChannelBlock nested = described("n", 0, 8, 0);
  nested.composition = file.array({2}, 4, 0, 0, file.array({2}, 1));
  const auto record = of_bytes(file, {row, matrix, columns, nested});
  const auto first = [&](const std::string& name) {
    const datasets::Channel* const channel = record.find(name);
    return channel == nullptr ? -1.0 : channel->value(0);
  };
  EXPECT_EQ(record.channels.size(), 3U + 6 + 6 + 4);
  EXPECT_THAT(record.channels.at(2).values(), ElementsAre(5, 13));
  EXPECT_EQ(first("row[0]"), 1);
  EXPECT_EQ(first("row[2]"), 5);
  EXPECT_EQ(first("m[0][2]"), 2);
  EXPECT_EQ(first("m[1][0]"), 3);
  EXPECT_EQ(first("c[0][2]"), 4);
  EXPECT_EQ(first("c[1][0]"), 1);
  EXPECT_EQ(first("n[0][1]"), 1);
  EXPECT_EQ(first("n[1][0]"), 4);
}

TEST(Mdf4Arrays, OfStructuresAreReadMemberByMember) {
  MdfFile file;
  MdfChannelBlock structures = described("s", 10, 32, 0);
  structures.composition = file.array(
      {2}, 4, 0, 0, file.channels({described("s.a", 0, 8, 1), described("b", 0, 16, 2)}));
  const auto record = of_bytes(file, {structures});
  EXPECT_THAT(names_of(record), ElementsAre("s[0].a", "s[0].b", "s[1].a", "s[1].b"));
  EXPECT_EQ(record.channels.at(2).value(0), 5);
  EXPECT_EQ(record.channels.at(3).value(0), 6 + 256 * 7);
}

TEST(Mdf4Arrays, HaveAnInvalidationBitAnElement) {
  MdfFile file;
  MdfChannelBlock row = described("row", 0, 8, 0);
  row.flags = 2;
  row.invalid_bit = 1;
  row.composition = file.array({3}, 1, 1);
  const auto record = of_bytes(file, {row}, 8);    // one record; its invalidation bytes are 8 to 15
  EXPECT_TRUE(record.channels.at(0).is_valid(0));  // bits 1 to 3 of 8
  EXPECT_TRUE(record.channels.at(1).is_valid(0));
  EXPECT_FALSE(record.channels.at(2).is_valid(0));
}

TEST(Mdf4Arrays, WhoseElementsAreNotToldApartAreLeftOut) {
  const auto told = [](const auto& array) {
    MdfFile file;
    MdfChannelBlock row = described("row", 0, 8, 0);
    row.composition = array(file);
    const auto record = of_bytes(file, {row, described("z", 0, 8, 7)});
    EXPECT_THAT(names_of(record), ElementsAre("z"));
    return record.warnings.at(0);
  };
  const std::string begin = "'row' is left out: ";
  EXPECT_EQ(told([](MdfFile& f) { return f.array({1001}, 0); }),
            begin + "its array has no elements, or more than 1000");
  EXPECT_EQ(told([](MdfFile& f) { return f.array({0}, 1); }),
            begin + "its array has no elements, or more than 1000");
  EXPECT_EQ(told([](MdfFile& f) { return f.array({40}, 0, 0, 0, f.array({40}, 0)); }),
            begin + "its array has no elements, or more than 1000");
  EXPECT_EQ(told([](MdfFile& f) { return f.array({2}, 1, 0, 1); }),
            begin + "its array has another size from record to record");
  EXPECT_EQ(told([](MdfFile& f) { return f.array({2}, 1, 0, 0, 0, 2); }),
            begin + "the elements of its array lie in other groups");
}

TEST(Mdf4Arrays, OutsideOfTheRecordsAreErrors) {
  const auto failure = [](const auto& change) {
    MdfFile file;
    MdfChannelBlock row = described("row", 0, 8, 4);
    change(file, row);
    try {
      of_bytes(file, {row});
    } catch (const datasets::InputError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(failure([](MdfFile& f, MdfChannelBlock& c) { c.composition = f.array({5}, 1); }),
              HasSubstr("'row[4]' lies in bytes 8 to 8 of records that have 8"));
  EXPECT_THAT(failure([](MdfFile& f, MdfChannelBlock& c) { c.composition = f.array({6}, -1); }),
              HasSubstr("'row[5]' lies in bytes -1 to -1 of records that have 8"));
  EXPECT_THAT(failure([](MdfFile& f, MdfChannelBlock& c) { c.composition = f.text("a"); }),
              HasSubstr("expected an array (CA) or channels (CN), found a block TX"));
}

TEST(Mdf4, CutAndUnfinishedFilesGiveWhatIsThere) {
  const Ticks ticks({0, 2, 4, 6});
  MdfFile cut;
  const std::uint64_t group = cut.group(cut.channels(Ticks::channels(cut)), 4, 7);
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
  const std::uint64_t open_group = open.group(open.channels(Ticks::channels(open)), 0, 7);
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
  const Ticks ticks({0, 2, 4, 6});
  for (const std::uint64_t count : {2, 9}) {
    MdfFile file("4.10    ", "UnFinMF ", 1);
    const std::uint64_t group = file.group(file.channels(Ticks::channels(file)), count, 7);
    const std::uint64_t data = file.block("DT", {}, ticks.bytes);
    const auto record = imported(file.with(file.data_group(group, data)));
    EXPECT_THAT(record.channels.at(0).values(), ElementsAre(-1, 49, 99, 149));
    EXPECT_THAT(record.warnings,
                ElementsAre("the recording was not finished (aborted?): what is there is read"));
  }
}

/// Records of three groups by turns: ticks at uneven times (id 1), values at even ones (id 2, twice
/// as often), and texts of variable length (id 77).
struct MixedRecords {
  Ticks ticks{{0, 1, 5, 6, 9, 10}};
  std::string even;  ///< time (f64), value (u8), a byte whose lowest bit marks what is not valid
  std::string mixed;

  explicit MixedRecords(std::uint8_t id_bytes) {
    for (std::size_t i = 0; i < 12; ++i) {
      even += bytes_of_number(0.5 + 0.001 * static_cast<double>(i)) + static_cast<char>('a' + i) +
              static_cast<char>(i % 5 == 2 ? 1 : 0);
      if (i % 2 == 0)
        mixed += tests::mdf_record_id(1, id_bytes) + ticks.bytes.substr(7 * (i / 2), 7);
      mixed += tests::mdf_record_id(2, id_bytes) + even.substr(10 * i, 10);
      mixed += tests::mdf_record_id(77, id_bytes) +
               bytes_of_number(static_cast<std::uint32_t>(3 * i)) + std::string(3 * i, '\1');
    }
  }

  static std::vector<MdfChannelBlock> even_channels() {
    MdfChannelBlock value = described("value", 0, 8, 8);
    value.flags = 2;
    return {mdf_time(), value};
  }

  /// All in one data group; `stored` makes the data of the mixed records. `counts`: what the groups
  /// state of ticks and values; nothing: the truth.
  std::string file(std::uint8_t id_bytes,
                   const std::function<std::uint64_t(MdfFile&, const std::string&)>& stored,
                   std::vector<std::uint64_t> counts = {}, MdfFile to = MdfFile()) const {
    if (counts.empty()) counts = {ticks.count, 12};
    const std::uint64_t data = stored(to, mixed);
    const std::uint64_t texts = to.group(0, 12, 0, 0, 0, 77, 1);
    const std::uint64_t second = to.group(to.channels(even_channels()), counts[1], 9, 1, texts, 2);
    const std::uint64_t first =
        to.group(to.channels(Ticks::channels(to)), counts[0], 7, 0, second, 1);
    return to.with(to.data_group(first, data, id_bytes));
  }

  /// The same, a data group a channel group.
  std::string sorted() const {
    MdfFile to;
    const std::uint64_t second =
        to.data_group(to.group(to.channels(even_channels()), 12, 9, 1), to.block("DT", {}, even));
    const std::uint64_t first = to.group(to.channels(Ticks::channels(to)), ticks.count, 7);
    return to.with(to.data_group(first, to.block("DT", {}, ticks.bytes), 0, second));
  }
};

std::uint64_t one_block(MdfFile& file, const std::string& records) {
  return file.block("DT", {}, records);
}

void expect_same(const datasets::Record& record, const datasets::Record& twin) {
  ASSERT_EQ(record.channels.size(), twin.channels.size());
  for (std::size_t i = 0; i < twin.channels.size(); ++i) {
    EXPECT_EQ(record.channels[i].name, twin.channels[i].name);
    EXPECT_EQ(record.channels[i].values(), twin.channels[i].values());
    EXPECT_EQ(record.channels[i].valid, twin.channels[i].valid);
    EXPECT_EQ(record.channels[i].clock.start, twin.channels[i].clock.start);
    EXPECT_EQ(record.channels[i].clock.interval, twin.channels[i].clock.interval);
    EXPECT_EQ(record.channels[i].clock.times, twin.channels[i].clock.times);
  }
  EXPECT_EQ(record.warnings, twin.warnings);
}

// Channels, windows and clocks are those of the sorted file, however records are numbered and cut.
TEST(Mdf4Unsorted, RecordsAreThoseOfTheSortedFile) {
  for (const std::uint8_t id_bytes : std::vector<std::uint8_t>{1, 2, 4, 8}) {
    const MixedRecords records(id_bytes);
    const std::string sorted = records.sorted();
    ImportOptions window;
    window.from = 0.501;
    window.to = 0.5065;
    ImportOptions one = window;
    one.channels = {"value"};
    const std::size_t n = records.mixed.size();
    for (std::size_t cut = 0; cut < n; cut += cut < 40 ? 1 : 7) {
      SCOPED_TRACE(fmt::format("ids of {} bytes, cut at {}", id_bytes, cut));
      const std::string file = records.file(id_bytes, [cut](MdfFile& to, const std::string& mixed) {
        if (cut == 0) return one_block(to, mixed);
        const std::uint64_t end =
            to.list({to.compressed(mixed.substr(cut), static_cast<std::uint32_t>(cut % 6))});
        return to.list({to.block("DT", {}, mixed.substr(0, cut / 2)), 0,
                        to.block("DT", {}, mixed.substr(cut / 2, cut - cut / 2))},
                       end);
      });
      for (const ImportOptions& options : {ImportOptions{}, window, one})
        expect_same(imported(file, options), imported(sorted, options));
    }
    const auto record = imported(records.file(id_bytes, one_block));
    EXPECT_EQ(record.channels.at(0).attributes.at("group"), "group 0.1");
    EXPECT_EQ(record.channels.at(1).attributes.at("group"), "group 0.2");
  }
}

// texts of variable length stand among the records whether or not their group counts them
TEST(Mdf4Unsorted, TextsAmongTheRecordsOfOneGroupAreNoNumbers) {
  MdfFile file;
  const std::string records = "\1a\2" + bytes_of_number(std::uint32_t{3}) + "xyz\1b\2" +
                              bytes_of_number(std::uint32_t{0}) + "\1c";
  const std::uint64_t data = file.block("DT", {}, records);
  const std::uint64_t texts = file.group(0, 0, 0, 0, 0, 2, 1);
  const std::uint64_t group =
      file.group(file.channels({described("a", 0, 8, 0)}), 3, 1, 0, texts, 1);
  const auto record = imported(file.with(file.data_group(group, data, 1)));
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre('a', 'b', 'c'));
}

TEST(Mdf4Unsorted, EmptyGroupsMayHaveTheIdsOfOthers) {
  MdfFile file;
  const std::uint64_t data = file.block("DT", {}, "\1a\2b\1c");
  std::uint64_t next = file.group(file.channels({described("empty", 0, 16, 0)}), 0, 2, 0, 0, 2);
  next = file.group(file.channels({described("b", 0, 8, 0)}), 1, 1, 0, next, 2);
  next = file.group(file.channels({described("a", 0, 8, 0)}), 2, 1, 0, next, 1);
  next = file.group(file.channels({described("nothing", 0, 16, 0)}), 0, 2, 0, next, 1);
  const auto record = imported(file.with(file.data_group(next, data, 1)));
  ASSERT_EQ(record.channels.size(), 4U);
  EXPECT_EQ(record.channels[0].size(), 0U);
  EXPECT_THAT(record.channels[1].values(), ElementsAre('a', 'c'));
  EXPECT_THAT(record.channels[2].values(), ElementsAre('b'));
  EXPECT_EQ(record.channels[3].size(), 0U);
}

TEST(Mdf4Unsorted, CutAndUnfinishedFilesGiveWhatIsThere) {
  const MixedRecords records(1);
  // the last two texts and values, and a part of the tick before them
  const auto cut = [](MdfFile& to, const std::string& mixed) {
    return to.block("DT", {}, mixed.substr(0, mixed.size() - 98));
  };
  const auto short_one = imported(records.file(1, cut));
  EXPECT_EQ(short_one.channels.at(0).size(), 5U);
  EXPECT_EQ(short_one.channels.at(1).size(), 10U);
  EXPECT_THAT(short_one.warnings,
              testing::IsSupersetOf({"group 0.1 announces 6 records, 5 are there",
                                     "group 0.2 announces 12 records, 10 are there"}));
  const auto fewer = imported(records.file(1, one_block, {4, 3}));
  EXPECT_EQ(fewer.channels.at(0).size(), 4U);
  EXPECT_EQ(fewer.channels.at(1).size(), 3U);
  const auto stale =
      imported(records.file(1, one_block, {0, 1}, MdfFile("4.10    ", "UnFinMF ", 1)));
  EXPECT_EQ(stale.channels.at(0).size(), 6U);
  EXPECT_EQ(stale.channels.at(1).size(), 12U);
}

TEST(Mdf4Unsorted, AnUnknownRecordEndsTheData) {
  const MixedRecords records(1);
  const auto record = imported(records.file(1, [](MdfFile& to, const std::string& mixed) {
    return to.block("DT", {}, mixed.substr(0, 24) + "\5" + mixed.substr(24));
  }));
  EXPECT_EQ(record.channels.at(0).size(), 1U);
  EXPECT_EQ(record.channels.at(1).size(), 1U);
  EXPECT_THAT(record.warnings,
              testing::Contains("byte 24 of the data of group 0 begins a record of the id 5, which "
                                "no channel group has: what follows is left out"));
}

/// A file of more than is gone through when it is opened: two channels of bytes, one in every
/// record but those that the other has, `slow_at`, at times of milliseconds.
class LargeMixed {
 public:
  explicit LargeMixed(std::vector<std::size_t> slow_at, bool stale = false,
                      std::uint64_t more = 0) {
    constexpr std::size_t wide = 500;  // bytes of a record, so that there are few
    std::string mixed;
    mixed.reserve(count * (wide + 1));
    std::vector<char> record(wide, 'x');
    std::uint64_t slow = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const bool is_slow = std::ranges::find(slow_at, i) != slow_at.end();
      slow += is_slow ? 1 : 0;
      const std::string time = bytes_of_number(1e-3 * static_cast<double>(i));
      std::ranges::copy(time, record.begin());
      record[8] = static_cast<char>(i % 100);
      mixed += is_slow ? '\2' : '\1';
      mixed.append(record.begin(), record.end());
    }
    MdfFile file("4.10    ", stale ? "UnFinMF " : "MDF     ", stale ? 1 : 0);
    const std::uint64_t second = file.group(file.channels({mdf_time(), described("slow", 0, 8, 8)}),
                                            stale ? 0 : slow, wide, 0, 0, 2);
    const std::uint64_t first = file.group(file.channels({mdf_time(), described("fast", 0, 8, 8)}),
                                           stale ? 0 : count - slow + more, wide, 0, second);
    bytes_ = file.with(file.data_group(first, file.block("DT", {}, mixed), 1));
  }

  const std::string& bytes() const { return bytes_; }

  static constexpr std::size_t count = 150000;  ///< 75 MB

 private:
  std::string bytes_;
};

TEST(Mdf4Unsorted, OfLargeFilesTheHeadIsWhatTheFileAnnounces) {
  const LargeMixed made({140000, 149000}, false, 5);
  const tests::WrittenFile file(made.bytes());
  const auto reader = open_recording(file.path());
  const RecordingHead& head = reader->head();
  EXPECT_FALSE(head.counted);
  EXPECT_THAT(head.samples, ElementsAre(LargeMixed::count, 2));  // no more than have room
  EXPECT_NEAR(head.record.channels.at(0).clock.interval, 1e-3, 1e-9);
  EXPECT_GT(head.record.channels.at(1).clock.interval, 10.0);  // two in about 150 s
  const auto record = read_into_memory(*reader);
  EXPECT_EQ(record.channels.at(0).size(), LargeMixed::count - 2);
  EXPECT_EQ(record.channels.at(0).values().at(140000), 1);
  EXPECT_EQ(record.channels.at(0).clock.times.at(140000), 1e-3 * 140001);
  EXPECT_THAT(record.channels.at(1).clock.times, ElementsAre(1e-3 * 140000, 1e-3 * 149000));
  EXPECT_DOUBLE_EQ(record.channels.at(1).clock.start, 140);
  EXPECT_DOUBLE_EQ(record.channels.at(1).clock.interval, 9);
  EXPECT_THAT(record.warnings,
              testing::Contains("group 0.1 announces 150003 records, 149998 are there"));
  Selection window;
  window.from = 139.999;
  window.to = 140.002;
  const auto part = read_into_memory(*reader, window);
  EXPECT_THAT(part.channels.at(0).values(), ElementsAre(99, 1, 2));
  EXPECT_THAT(part.channels.at(1).values(), ElementsAre(0));
}

TEST(Mdf4Unsorted, OfLargeUnfinishedFilesTheHeadIsAnEstimate) {
  const LargeMixed made({3, 149000}, true);
  const tests::WrittenFile file(made.bytes());
  const auto reader = open_recording(file.path());
  EXPECT_FALSE(reader->head().counted);
  EXPECT_NEAR(static_cast<double>(reader->head().samples.at(0)), 150000, 2);
  const auto record = read_into_memory(*reader);
  EXPECT_EQ(record.channels.at(0).size(), LargeMixed::count - 2);
  EXPECT_EQ(record.channels.at(1).size(), 2U);
}

TEST(Mdf4Unsorted, WhatCannotBeToldApartIsRefusedOrLeftOut) {
  const auto unsorted = [](MdfFile& file, std::uint8_t id_bytes, std::uint64_t second_id) {
    const std::uint64_t second =
        file.group(file.channels({described("b", 0, 8, 0)}), 2, 1, 0, 0, second_id);
    const std::uint64_t first =
        file.group(file.channels({described("a", 0, 8, 0)}), 2, 1, 0, second);
    return file.data_group(first, 0, id_bytes);
  };
  const auto refused = [&](std::uint8_t id_bytes, std::uint64_t second_id, const std::string& why) {
    const std::string sentence = "channel groups that share a block of data " + why +
                                 " are not read: sort the file with the program that wrote it";
    MdfFile file;
    const std::uint64_t at = unsorted(file, id_bytes, second_id);
    EXPECT_EQ(import_error(file.with(at)), fmt::format("FILE (byte {}): {}", at, sentence));
    const std::uint64_t group = file.group(file.channels({described("c", 0, 8, 0)}), 2, 1);
    const auto record =
        imported(file.with(file.data_group(group, file.block("DT", {}, "ab"), 0, at)));
    EXPECT_EQ(record.channels.at(0).name, "c");
    EXPECT_EQ(record.warnings.at(0), sentence);
  };
  refused(0, 2, "without record ids");
  refused(3, 2, "with record ids of 3 bytes");
  refused(1, 1, "and the record id 1");
}

std::string error_in(const std::string& bytes) {
  ImportOptions options;
  options.require_clock = false;
  const std::string error = import_error(bytes, options);
  const std::size_t colon = error.find("): ");
  return colon == std::string::npos ? error : error.substr(colon + 3);
}

std::string data_error(const std::function<std::uint64_t(MdfFile&)>& data) {
  MdfFile file;
  const std::uint64_t at = data(file);
  const std::uint64_t group = file.group(file.channels({described("a", 0, 8, 0)}), 8, 1);
  return error_in(file.with(file.data_group(group, at)));
}

TEST(Mdf4Errors, OfDataSayWhatWasFound) {
  EXPECT_EQ(data_error([](MdfFile& f) { return f.compressed("12345678", 0, 9); }),
            "the compressed data are damaged, or are not the 9 bytes announced");
  EXPECT_EQ(data_error([](MdfFile& f) { return f.compressed("12345678", 0, 7); }),
            "the compressed data are damaged, or are not the 7 bytes announced");
  EXPECT_EQ(data_error([](MdfFile& f) { return f.compressed("12345678", 0, 20000000); }),
            "a compressed block of 19 bytes announces 20000000 bytes: it is refused");
  EXPECT_EQ(
      data_error([](MdfFile& f) { return f.compressed(std::string(70000, 'x'), 0, 67108865); }),
      "a compressed block of 70016 bytes announces 67108865 bytes: it is refused");
  EXPECT_EQ(data_error([](MdfFile& f) { return f.compressed("12345678", 0, 0, 2); }),
            "the data are compressed by method 2, which is not read: save the file with deflate or "
            "uncompressed");
  EXPECT_EQ(data_error([](MdfFile& f) {
              return f.block("DZ", {}, std::string("SD") + std::string(22, '\0'));
            }),
            "expected compressed records (DT), found a compressed block SD");
  EXPECT_EQ(
      data_error([](MdfFile& f) { return f.block("DV", {}, "12345678"); }),
      "the data are stored by columns (MDF 4.2), which is not read: save the file as MDF 4.1 with "
      "the program that wrote it");
  EXPECT_EQ(data_error([](MdfFile& f) { return f.text("12345678"); }),
            "expected a block of data (DT, DZ, DL, HL), found a block TX");
  EXPECT_EQ(data_error([](MdfFile& f) {
              const std::uint64_t data = f.block("DT", {}, "1234");
              return f.list({data, data});
            }),
            "a block of data is referred to twice: blocks are chained in a circle");
}

TEST(Mdf4Errors, OfBlocksSayWhatWasFound) {
  ImportOptions mdf;
  mdf.format = "mdf4";
  EXPECT_EQ(import_error("not an MDF file at all", mdf),
            "FILE (byte 0): expected 'MDF' at the start, found 'not an M'");
  EXPECT_EQ(import_error(MdfFile("3.30    ").with(0), mdf),
            "FILE (byte 8): this is MDF version 3.30, which is not read: save it as MDF 4 with the "
            "program "
            "that wrote it");
  EXPECT_EQ(import_error(MdfFile().with(0).substr(0, 70)),
            "FILE (byte 70): the file ends within the header of an MDF file");
  MdfFile file;
  const std::uint64_t text = file.text("text");
  EXPECT_EQ(error_in(file.with(text)), "expected a data group (DG), found a block TX");
  EXPECT_EQ(error_in(file.with(8)), "expected a data group, found '4.10'");
  EXPECT_EQ(error_in(file.with(64)),
            "a data group is referred to twice: blocks are chained in a circle");
  const std::uint64_t loop = file.data_group(0, 0);
  file.put(loop + 24, bytes_of_number(loop));
  EXPECT_EQ(error_in(file.with(loop)),
            "a data group is referred to twice: blocks are chained in a circle");
  MdfFile lying;
  const std::uint64_t group = lying.data_group(0, 0);
  lying.put(group + 16, bytes_of_number(~std::uint64_t{0}));
  EXPECT_EQ(error_in(lying.with(group)), "a block DG of 64 bytes with 18446744073709551615 links");
  lying.put(group + 8, bytes_of_number(~std::uint64_t{0}));
  lying.put(group + 16, bytes_of_number(std::uint64_t{1} << 60));
  EXPECT_EQ(error_in(lying.with(group)), "the file ends within a data group");
}

TEST(Mdf4Errors, OfChannelsNameThem) {
  EXPECT_EQ(error_in(file_of({described("a", 0, 16, 1)}, "1234", 2)),
            "'a' lies in bytes 1 to 2 of records that have 2");
  EXPECT_EQ(error_in(file_of({described("a", 0, 65, 0)}, "1234", 2)),
            "'a' has numbers of type 0 with 65 bits from bit 0 on");
  EXPECT_EQ(error_in(file_of({described("a", 4, 24, 0)}, "1234", 4)),
            "'a' has numbers of type 4 with 24 bits from bit 0 on");
  MdfChannelBlock flagged = described("a", 0, 8, 0);
  flagged.flags = 2;
  flagged.invalid_bit = 8;
  EXPECT_EQ(error_in(file_of({flagged}, "1234", 1)),
            "the invalidation bit 8 of 'a' lies outside of the records");
  EXPECT_EQ(error_in(file_of({}, "1", 0x2000000)), "a channel group has records of 33554432 bytes");
  MdfFile file;
  MdfChannelBlock channel = described("a", 0, 8, 0);
  channel.conversion = file.text("x");
  EXPECT_EQ(error_in(file.with(file.data_group(file.group(file.channels({channel}), 1, 1), 0))),
            "expected a conversion (CC), found a block TX");
  channel.conversion = file.conversion(1, {1});
  EXPECT_EQ(error_in(file.with(file.data_group(file.group(file.channels({channel}), 1, 1), 0))),
            "a conversion of type 1 states 1 parameters");
}

}  // namespace
}  // namespace impactrig::acquisition
