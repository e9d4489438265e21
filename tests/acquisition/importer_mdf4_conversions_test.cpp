// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <cstdint>
#include <string>
#include <vector>

#include "tests/acquisition/mdf4_bytes.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using tests::imported;
using tests::mdf_channel;
using tests::MdfChannelBlock;
using tests::MdfFile;

std::vector<double> converted(std::uint8_t type, const std::vector<double>& parameters,
                              const std::vector<double>& raw) {
  MdfFile file;
  MdfChannelBlock channel = mdf_channel("a", 4, 64, 0);
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
    MdfChannelBlock channel = mdf_channel("a", 2, 16, 0);
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
  MdfChannelBlock channel = mdf_channel("a", 0, 8, 0);
  channel.conversion = file.conversion(6, {0, 1, 10, 2, 3, 20, -7});
  const std::uint64_t group = file.group(file.channels({channel}), 5, 1);
  const std::uint64_t data = file.block("DT", {}, std::string("\0\1\2\3\4", 5));
  EXPECT_THAT(imported(file.with(file.data_group(group, data))).channels.at(0).values(),
              ElementsAre(10, 10, 20, 20, -7));
}

TEST(Mdf4Conversions, ThatCannotBeAppliedLeaveTheRawNumbersWithoutUnit) {
  const auto told = [](std::uint8_t type, const std::vector<double>& parameters) {
    MdfFile file;
    MdfChannelBlock channel = mdf_channel("a", 0, 8, 0);
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
    MdfChannelBlock channel = mdf_channel("a", 0, 8, 0);
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

}  // namespace
}  // namespace impactrig::acquisition
