// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/lvm_headerless.hpp"
#include "tests/acquisition/large_texts.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Record;
using tests::expect_same;
using tests::microseconds;
using tests::uneven;

/// A LabVIEW file of one segment with two channels, the second of which ends earlier.
std::string lvm(const std::string& x_columns, std::size_t rows, std::size_t shorter,
                const std::string& delta) {
  std::string text =
      "LabVIEW Measurement\t\nWriter_Version\t2\nSeparator\tTab\nDecimal_Separator\t.\n"
      "Multi_Headings\tNo\nX_Columns\t" +
      x_columns + "\nDate\t2020/01/01\nTime\t10:00:00\n***End_of_Header***\t\n\t\n";
  const bool multi = x_columns == "Multi";
  const auto line = [&](const std::string& key, const std::string& a, const std::string& b) {
    text += multi ? key + "\t" + a + "\t\t" + b + "\n" : key + "\t" + a + "\t" + b + "\n";
  };
  line("Channels", "2", "");
  line("Samples", std::to_string(rows), std::to_string(shorter));
  line("Y_Unit_Label", "N", "V");
  line("X_Dimension", "Time", "Time");
  line("X0", "0.0", "0.0");
  line("Delta_X", delta, delta);
  text += "***End_of_Header***\t\t\n";
  text += multi ? "X_Value\tForce\tX_Value\tVolt\tComment\n" : "X_Value\tForce\tVolt\tComment\n";
  for (std::size_t i = 0; i < rows; ++i) {
    const std::string x = x_columns == "No" ? "" : fmt::format("{:.6f}", 1e-6 * double(i));
    text += fmt::format("{}\t{:.6f}", x, std::sin(0.01 * double(i)));
    if (i < shorter) text += multi ? fmt::format("\t{}\t{}", x, i) : fmt::format("\t{}", i);
    if (i == 5) text += i < shorter ? "\tbang" : "";
    text += '\n';
  }
  return text;
}

TEST(LargeLvm, IsReadByBlocksAsItIsReadAtOnce) {
  std::string gap = lvm("One", 40000, 40000, "0.000001");
  const std::size_t row = gap.find("\t10\n");
  gap.erase(row, 3);
  for (const std::string& text :
       {lvm("One", 50000, 50000, "0.000001"), lvm("Multi", 50000, 50000, "0.000001"),
        lvm("Multi", 50000, 20000, "0.000001"), lvm("No", 50000, 50000, "0.000977"),
        lvm("One", 50000, 50000, "0.000002"), gap,  // the last two as a whole
        lvm("One", 50000, 50000, "0.000001") + "***Start_Special***\nx\n***End_Special***\n",
        lvm("One", 30000, 30000, "0.000001") + "0.03\t1"}) {
    SCOPED_TRACE(text.substr(90, 20) + fmt::format(" {} bytes", text.size()));
    const tests::WrittenFile file(text, ".lvm");
    const auto reader = open_lvm_by_blocks(file.path(), {});
    const auto at_once = open_lvm(file.path(), {});
    EXPECT_EQ(reader->head().samples, at_once->head().samples);
    expect_same(read_into_memory(*reader), read_into_memory(*at_once));
    Selection wanted;
    wanted.channels = {1, 0};
    wanted.from = 0.017;
    wanted.to = 0.0179;
    expect_same(read_into_memory(*reader, wanted), read_into_memory(*at_once, wanted));
  }
}

/// Segments of one LabVIEW file, by the time of day each began at; rows of two channels, one value
/// of which is missing in each segment.
std::string lvm_segments(const std::vector<std::string>& times, std::size_t rows) {
  const std::string one = lvm("No", rows, rows, "0.000001");
  const std::size_t header = one.find("Channels");
  std::string text = one.substr(0, header);
  for (const std::string& time : times) {
    std::string segment = one.substr(header);
    segment.insert(segment.find("Y_Unit"),
                   "Date\t2020/01/01\t2020/01/01\nTime\t" + time + "\t" + time + "\n");
    segment.erase(segment.find("\t10\n"), 3);
    text += segment + "\n";
  }
  return text;
}

TEST(LargeLvm, OfSeveralSegmentsIsReadAsItIsReadAtOnce) {
  const std::vector<std::string> follow = {"10:00:00", "10:00:00.03", "10:00:00.06"};
  const std::vector<std::string> apart = {"10:00:00", "10:00:07", "11:00:00.25"};
  for (const auto& times : {follow, apart}) {
    SCOPED_TRACE(times.back());
    const tests::WrittenFile file(lvm_segments(times, 30000), ".lvm");
    const auto reader = open_lvm_by_blocks(file.path(), {});
    const auto at_once = open_lvm(file.path(), {});
    EXPECT_EQ(reader->head().samples, at_once->head().samples);
    expect_same(read_into_memory(*reader), read_into_memory(*at_once));
    Selection wanted;
    wanted.channels = {1};
    wanted.from = 0.0299;
    wanted.to = 0.0301;
    expect_same(read_into_memory(*reader, wanted), read_into_memory(*at_once, wanted));
  }
  const tests::WrittenFile joined(lvm_segments(follow, 30000), ".lvm");
  const Record record = read_into_memory(*open_lvm_by_blocks(joined.path(), {}));
  ASSERT_EQ(record.channels.size(), 2U);
  ASSERT_EQ(record.channels[1].size(), 90000U);
  EXPECT_EQ(record.channels[1].value(89999), 29999.0);
  EXPECT_FALSE(record.channels[1].is_valid(30010));
  EXPECT_EQ(std::ranges::count(record.channels[1].valid, 0), 3);
  const tests::WrittenFile alone(lvm_segments(apart, 30000), ".lvm");
  const Record separate = read_into_memory(*open_lvm_by_blocks(alone.path(), {}));
  ASSERT_EQ(separate.channels.size(), 6U);
  EXPECT_EQ(separate.channels[5].name, "Volt (segment 3)");
  EXPECT_EQ(separate.channels[5].clock.start, 3600.25);
}

TEST(LargeLvm, WithXColumnsOfItsOwnThatNoStepExplainsKeepsTheTimes) {
  std::string text = lvm("Multi", 0, 0, "0.000001");
  for (std::size_t i = 0; i < 20000; ++i) {
    text += fmt::format("{:.9f}\t{}", uneven(i), i);
    text += i % 2 == 0 ? fmt::format("\t{:.9f}\t{}\n", 1e-3 + 2.0 * uneven(i), 2 * i) : "\n";
  }
  const tests::WrittenFile file(text, ".lvm");
  const Record record = read_into_memory(*open_lvm_by_blocks(file.path(), {}));
  expect_same(record, read_into_memory(*open_lvm(file.path(), {})));
  ASSERT_EQ(record.channels[0].clock.times.size(), 20000U);
  EXPECT_DOUBLE_EQ(record.channels[0].clock.times[19999], uneven(19999));
}

TEST(LargeLvm, WithoutHeaderEndsItsColumnsAsTheSmallOneDoes) {
  std::string text;
  for (std::size_t i = 0; i < 60000; ++i) {
    text += fmt::format("{:.6f}\t{}\t", microseconds(i), i);
    if (i < 30000 && i % 1000 != 7) text += fmt::format("{}", 2 * i);
    if (i < 100) text += fmt::format("\t{}", 3 * i);
    text += i < 100 ? "\n" : "\t\n";
  }
  const tests::WrittenFile file(text, ".lvm");
  const auto reader = open_lvm_without_header(file.path(), {}, true);
  const auto at_once = open_lvm_without_header(file.path(), {}, false);
  const Record record = read_into_memory(*reader);
  expect_same(record, read_into_memory(*at_once));
  ASSERT_EQ(record.channels.size(), 3U);
  EXPECT_EQ(record.channels[1].name, "column 3");
  EXPECT_EQ(record.channels[1].size(), 30000U);
  EXPECT_EQ(record.channels[2].size(), 100U);
  EXPECT_THAT(record.warnings,
              testing::Contains("'column 3' ends after 30000 of 60000 rows, 30 values within are "
                                "missing"));
  Selection wanted;
  wanted.channels = {1};
  wanted.from = 0.0299;
  wanted.to = 0.0301;
  expect_same(read_into_memory(*reader, wanted), read_into_memory(*at_once, wanted));
}

}  // namespace
}  // namespace impactrig::acquisition
