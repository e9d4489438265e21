// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "acquisition/importers/formats.hpp"
#include "tests/acquisition/large_texts.hpp"
#include "tests/acquisition/text_bytes.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Record;
using tests::expect_same;
using tests::uneven;

/// A dataset 58 in text with so many points; `even` or with stated times that no clock explains.
std::string uff58(std::size_t points, bool even) {
  std::string data;
  for (std::size_t i = 0; i < points; ++i) {
    if (!even) data += fmt::format("{:13.5E}", uneven(i));
    data += fmt::format("{:13.5E}", std::sin(0.1 * static_cast<double>(i)));
    if ((i + 1) % (even ? 6 : 3) == 0) data += '\n';
  }
  if (data.back() != '\n') data += '\n';
  return tests::uff58_dataset(
      "    58",
      fmt::format("         2{:10}{:10}  0.00000E+00  1.00000E-06  0.00000E+00", points,
                  even ? 1 : 0),
      data);
}

TEST(LargeUff, IsReadByBlocksAsWhereItsNumbersAreCounted) {
  for (const bool even : {true, false}) {
    for (const std::size_t points : {5U, 6U, 7U, 100001U}) {
      const tests::WrittenFile file(uff58(points, even) + uff58(10, even), ".uff");
      const auto reader = open_uff58_by_blocks(file.path(), {});
      EXPECT_FALSE(reader->head().counted);
      EXPECT_EQ(reader->head().samples, (std::vector<std::uint64_t>{points, 10}));
      expect_same(read_into_memory(*reader), read_into_memory(*open_uff58(file.path(), {})));
      Selection wanted;
      wanted.channels = {0};
      wanted.from = 2e-6;
      wanted.to = 50000e-6;
      const Record part = read_into_memory(*reader, wanted);
      ASSERT_EQ(part.channels.size(), 1U);
      EXPECT_EQ(part.channels[0].size(), std::min<std::size_t>(points, 50001) - 2);
      EXPECT_NEAR(part.channels[0].clock.start, 2e-6, 1e-15);
      EXPECT_NEAR(part.channels[0].value(0), std::sin(0.2), 1e-6);
      if (!even) continue;
      for (const std::size_t first : {3U, 4U, 90001U}) {  // in lines of six
        if (first >= points) continue;
        wanted.from = 1e-6 * static_cast<double>(first);
        wanted.to = 1.0;
        const Record rest = read_into_memory(*reader, wanted);
        ASSERT_EQ(rest.channels[0].size(), points - first);
        EXPECT_NEAR(rest.channels[0].value(0), std::sin(0.1 * static_cast<double>(first)), 1e-5);
      }
    }
  }
}

TEST(LargeUff, WhoseLinesAreNotTheAnnouncedOnesIsCounted) {
  std::string text = uff58(100, true);
  text.insert(text.find("  0.00000E+00", text.find("NONE                \n  0.0")), "\n");
  const tests::WrittenFile file(text, ".uff");
  const auto reader = open_uff58_by_blocks(file.path(), {});
  EXPECT_TRUE(reader->head().counted);
  expect_same(read_into_memory(*reader), read_into_memory(*open_uff58(file.path(), {})));
}

TEST(LargeUff, WhoseNumbersAreFewerThanAnnouncedTellsAfterReading) {
  std::string text = uff58(100, true);
  text.replace(text.find("  9.98334E-02"), 13, std::string(13, ' '));
  text.replace(text.find("  1.98669E-01"), 52, std::string(52, ' '));
  const tests::WrittenFile file(text, ".uff");
  const auto reader = open_uff58_by_blocks(file.path(), {});
  const Record record = read_into_memory(*reader);
  EXPECT_EQ(record.channels[0].size(), 95U);
  EXPECT_THAT(record.warnings,
              testing::ElementsAre(
                  "'Force': the header announces 100 points, 95 are there: these are read"));
}

TEST(LargeUff, InBinaryIsReadByWindows) {
  std::string data;
  for (std::size_t i = 0; i < 100000; ++i) {
    const float number = static_cast<float>(i);
    data.append(reinterpret_cast<const char*>(&number), 4);
  }
  const tests::WrittenFile file(
      tests::uff58_dataset(
          "    58b     1     2          11      400000     0     0           0           0",
          "         2    100000         1  0.00000E+00  1.00000E-06  0.00000E+00", data),
      ".uff");
  const auto reader = open_uff58(file.path(), {});
  Selection wanted;
  wanted.from = 0.07;
  wanted.to = 0.08;
  const Record part = read_into_memory(*reader, wanted);
  ASSERT_EQ(part.channels.at(0).size(), 10001U);
  EXPECT_EQ(part.channels[0].value(0), 70000.0);
  EXPECT_DOUBLE_EQ(part.channels[0].clock.start, 0.07);
}

}  // namespace
}  // namespace impactrig::acquisition
