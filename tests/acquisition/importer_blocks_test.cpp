// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/lvm_headerless.hpp"
#include "acquisition/importers/stored_numbers.hpp"
#include "datasets/input_error.hpp"
#include "datasets/store.hpp"
#include "tests/acquisition/text_bytes.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Channel;
using datasets::Record;

/// A table with so many rows; `time` says when a row was taken.
template <typename Time>
std::string table(std::size_t rows, const Time& time) {
  std::string text = "Time [s],Force [N],Velocity [m/s]\n";
  for (std::size_t i = 0; i < rows; ++i) {
    const std::string force =
        i % 1000 == 7 ? "" : fmt::format("{:.6f}", std::sin(0.01 * double(i)));
    text += fmt::format("{:.7f},{},{}\n", time(i), force, i);
  }
  return text;
}

double microseconds(std::size_t i) {
  return 1e-6 * static_cast<double>(i);
}

/// Steps that no clock explains.
double uneven(std::size_t i) {
  return 1e-6 * static_cast<double>(i) + (i % 2 == 0 ? 0.0 : 4e-7);
}

void expect_same(const Record& found, const Record& expected) {
  ASSERT_EQ(found.channels.size(), expected.channels.size());
  EXPECT_EQ(found.warnings, expected.warnings);
  EXPECT_EQ(found.attributes, expected.attributes);
  for (std::size_t c = 0; c < found.channels.size(); ++c) {
    const Channel& a = found.channels[c];
    const Channel& b = expected.channels[c];
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.unit, b.unit);
    EXPECT_EQ(a.quantity, b.quantity);
    EXPECT_EQ(a.valid, b.valid);
    EXPECT_EQ(a.clock.start, b.clock.start);
    EXPECT_EQ(a.clock.interval, b.clock.interval);
    EXPECT_EQ(a.clock.times, b.clock.times);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      if (!a.is_valid(i)) continue;
      ASSERT_EQ(a.value(i), b.value(i)) << a.name << " " << i;
    }
  }
}

Record by_blocks(const std::string& path, const Selection& wanted = {}) {
  const auto reader = open_csv_by_blocks(path, {});
  EXPECT_FALSE(reader->head().counted);
  return read_into_memory(*reader, wanted);
}

TEST(LargeCsv, IsReadByBlocksAsItIsReadAtOnce) {
  for (const auto time : {microseconds, uneven}) {
    const tests::WrittenFile file(table(150000, time), ".csv");
    expect_same(by_blocks(file.path()), read_into_memory(*open_csv(file.path(), {})));
  }
}

TEST(LargeCsv, CutWithinARowIsReadByBlocksAsItIsReadAtOnce) {
  std::string text = table(40000, microseconds);
  text.resize(text.size() - 5);
  const tests::WrittenFile file(text, ".csv");
  expect_same(by_blocks(file.path()), read_into_memory(*open_csv(file.path(), {})));
}

TEST(LargeCsv, EstimatesRowsAndClockFromFirstAndLastRows) {
  const tests::WrittenFile file(table(150000, microseconds), ".csv");
  const auto reader = open_csv_by_blocks(file.path(), {});
  EXPECT_EQ(reader->head().samples, (std::vector<std::uint64_t>{150000, 150000}));
  EXPECT_NEAR(reader->head().record.channels[0].clock.interval, 1e-6, 1e-18);
}

TEST(LargeCsv, GivesTheChannelsAndTheWindowAskedFor) {
  for (const auto time : {microseconds, uneven}) {
    const tests::WrittenFile file(table(150000, time), ".csv");
    Selection wanted;
    wanted.channels = {1};
    wanted.from = 0.1;
    wanted.to = 0.100099;
    const Record record = by_blocks(file.path(), wanted);
    ASSERT_EQ(record.channels.size(), 1U);
    const Channel& velocity = record.channels[0];
    EXPECT_EQ(velocity.name, "Velocity");
    ASSERT_EQ(velocity.size(), 100U - (time == uneven ? 1U : 0U));
    EXPECT_EQ(velocity.value(0), 100000.0);
    EXPECT_DOUBLE_EQ(velocity.clock.start, 0.1);
    EXPECT_EQ(velocity.clock.uniform(), time == microseconds);
    const Record at_once = read_into_memory(*open_csv(file.path(), {}), wanted);
    EXPECT_EQ(velocity.values(), at_once.channels[0].values());
    EXPECT_EQ(velocity.clock.times, at_once.channels[0].clock.times);
    EXPECT_NEAR(velocity.clock.interval, at_once.channels[0].clock.interval, 1e-15);
  }
}

/// Two passes over the same times.
double twice(std::size_t i) {
  return 1e-6 * static_cast<double>(i % 75000);
}

TEST(LargeCsv, WhoseTimesGoBackIsNotCut) {
  const tests::WrittenFile file(table(150000, twice), ".csv");
  Selection wanted;
  wanted.from = 0.01;
  wanted.to = 0.02;
  const Record record = by_blocks(file.path(), wanted);
  EXPECT_EQ(record.channels[0].size(), 150000U);
  EXPECT_THAT(record.warnings, testing::Contains(testing::HasSubstr("time does not increase")));
  const Record whole = import_recording(file.path());
  const tests::WrittenFile ours("", ".h5");
  datasets::write_record(whole, ours.path());
  EXPECT_EQ(read_into_memory(*open_recording(ours.path()), wanted).channels[0].size(), 150000U);
}

// Times of 1 us steps printed with so few digits that 37 or 3 rows share one: the window's own
// times do not tell the step, all of them do.
TEST(LargeCsv, WithRoundedTimesHasTheStepOfTheWholeInAWindow) {
  for (const char* format : {"{:.5f}", "{:.6f}"}) {
    std::string text = "Time [s],Force [N]\n";
    for (int i = 0; i < 150000; ++i)
      text += fmt::format(fmt::runtime(std::string(format) + ",{}\n"), 2.7e-7 * i, i);
    const tests::WrittenFile file(text, ".csv");
    Selection wanted;
    wanted.from = 0.0300005;
    wanted.to = 0.0300205;
    const Record part = by_blocks(file.path(), wanted);
    expect_same(part, read_into_memory(*open_csv(file.path(), {}), wanted));
    ASSERT_GT(part.channels[0].size(), 70U);
    EXPECT_NEAR(part.channels[0].clock.interval, 2.7e-7, 1e-11);
    EXPECT_NEAR(part.channels[0].value(0), 0.0300005 / 2.7e-7, 20.0);
    expect_same(by_blocks(file.path()), read_into_memory(*open_csv(file.path(), {})));
  }
}

TEST(LargeCsv, AColumnWithoutAnyValueIsAChannelWithoutSamples) {
  for (const bool late : {false, true})
    for (const auto time : {microseconds, uneven}) {
      std::string text = "Time [s],Nothing [N],Velocity [m/s],More [V]\n";
      for (std::size_t i = 0; i < 120000; ++i)
        text += fmt::format("{:.7f},{},{},\n", time(i), late && i == 110000 ? "5" : "", i);
      const tests::WrittenFile file(text, ".csv");
      const Record found = by_blocks(file.path());
      expect_same(found, read_into_memory(*open_csv(file.path(), {})));
      EXPECT_EQ(found.channels[0].size(), late ? 120000U : 0U);
      EXPECT_EQ(found.channels[1].size(), 120000U);
      EXPECT_EQ(found.channels[2].size(), 0U);
      Selection wanted;
      wanted.from = 0.05;
      wanted.to = 0.06;
      const Record part = by_blocks(file.path(), wanted);
      const Record expected = read_into_memory(*open_csv(file.path(), {}), wanted);
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_EQ(part.channels[c].valid, expected.channels[c].valid) << c;
    }
}

TEST(LargeCsv, MarksTheRowsThatItsHeadNames) {
  for (const auto time : {microseconds, uneven}) {
    const tests::WrittenFile file(
        "# invalid samples of column 2: 3 5-6 16380-16390 100000 149999\n"
        "# invalid samples of column 1: 7-5\n" +
            table(150000, time),
        ".csv");
    const Record small = read_into_memory(*open_csv(file.path(), {}));
    EXPECT_EQ(std::ranges::count(small.channels[0].valid, 0), 150);  // the empty cells only
    EXPECT_EQ(small.attributes.at("invalid samples of column 1"), "7-5");
    EXPECT_EQ(std::ranges::count(small.channels[1].valid, 0), 16);
    EXPECT_FALSE(small.channels[1].is_valid(16390));
    expect_same(by_blocks(file.path()), small);
    Selection wanted;
    wanted.from = 0.099;
    wanted.to = 0.101;
    const Record part = by_blocks(file.path(), wanted);
    EXPECT_EQ(part.channels[1].valid,
              read_into_memory(*open_csv(file.path(), {}), wanted).channels[1].valid);
    EXPECT_EQ(std::ranges::count(part.channels[1].valid, 0), 1);
  }
}

TEST(LargeCsv, WithoutATimeColumnCountsItsRows) {
  std::string text = "Sample Interval,1e-3\nForce [N],Velocity [m/s]\n";
  for (int i = 0; i < 50000; ++i) text += fmt::format("{},{}\n", 3 * i, -i);
  const tests::WrittenFile file(text, ".csv");
  expect_same(by_blocks(file.path()), read_into_memory(*open_csv(file.path(), {})));
  Selection wanted;
  wanted.from = 40.0;
  wanted.to = 40.001;
  const Record record = by_blocks(file.path(), wanted);
  ASSERT_EQ(record.channels[0].size(), 2U);
  EXPECT_EQ(record.channels[0].value(0), 120000.0);
  EXPECT_EQ(record.channels[0].clock.start, 40.0);
}

/// A Polytec export with so many rows over this; every thousandth cell is empty.
template <typename Abscissa>
std::string polytec(const std::string& domain, const std::string& unit, std::size_t rows,
                    const Abscissa& abscissa) {
  std::string text = "Source File Name:\tx.pvd\nSignal:\t" + domain +
                     " - Vib Velocity - Samples\n\nX\tVibrometer\tRef1\n[ " + unit +
                     " ]\t[ m/s ]\t[ V ]\n";
  for (std::size_t i = 0; i < rows; ++i)
    text += fmt::format("{:.7E}\t{}\t{:.6E}\n", abscissa(i),
                        i % 1000 == 7 ? "" : fmt::format("{:.6E}", std::sin(0.01 * double(i))),
                        double(i));
  return text;
}

TEST(LargePolytecText, IsReadByBlocksAsItIsReadAtOnce) {
  const auto hertz = [](std::size_t i) { return 0.5 * static_cast<double>(i); };
  const auto squares = [](std::size_t i) { return static_cast<double>(i * i); };
  for (const std::string& text :
       {polytec("Time", "s", 120000, microseconds), polytec("Time", "ms", 120000, uneven),
        polytec("FFT", "Hz", 60000, hertz), polytec("FFT", "Hz", 60000, squares),
        polytec("Time", "s", 120000, twice), polytec("Time", "s", 1, microseconds),
        polytec("Time", "s", 30000, microseconds) + "1.0E+00\t2"}) {
    SCOPED_TRACE(text.substr(0, 40) + fmt::format(" {} bytes", text.size()));
    const tests::WrittenFile file(text, ".txt");
    const auto reader = open_polytec_ascii_by_blocks(file.path(), {});
    expect_same(read_into_memory(*reader), read_into_memory(*open_polytec_ascii(file.path(), {})));
  }
  const tests::WrittenFile file(polytec("Time", "s", 120000, microseconds), ".txt");
  Selection wanted;
  wanted.channels = {1};
  wanted.from = 0.1;
  wanted.to = 0.100099;
  const Record part = read_into_memory(*open_polytec_ascii_by_blocks(file.path(), {}), wanted);
  ASSERT_EQ(part.channels[0].size(), 100U);
  EXPECT_EQ(part.channels[0].value(0), 100000.0);
}

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

/// Numbers 0, 1, 2, ... of a kind, one byte between two of them.
template <typename Number>
std::string spaced(std::size_t n, bool big_endian) {
  std::string bytes;
  for (std::size_t i = 0; i < n; ++i) {
    const auto number = static_cast<Number>(i);
    std::string raw(reinterpret_cast<const char*>(&number), sizeof(Number));
    if (big_endian) std::reverse(raw.begin(), raw.end());
    bytes += raw + "-";
  }
  return bytes;
}

template <typename Number>
void expect_read(NumberKind kind) {
  for (const bool big_endian : {false, true}) {
    const std::size_t n = 100;  // fits a byte with sign
    const tests::WrittenFile file(spaced<Number>(n, big_endian), ".bin");
    StoredNumbers numbers(kind, big_endian);
    numbers.add({0, n, sizeof(Number) + 1});
    Record record;
    record.channels.resize(1);
    const auto reader =
        reader_of_numbers(std::make_unique<MappedFile>(file.path()), record, {{numbers}});
    const Channel channel = read_into_memory(*reader).channels[0];
    ASSERT_EQ(channel.size(), n);
    for (std::size_t i = 0; i < n; ++i) ASSERT_EQ(channel.value(i), static_cast<double>(i));
  }
}

TEST(StoredNumbers, AreReadInEveryKindAndByteOrder) {
  expect_read<std::int8_t>(NumberKind::i8);
  expect_read<std::uint8_t>(NumberKind::u8);
  expect_read<std::int16_t>(NumberKind::i16);
  expect_read<std::uint16_t>(NumberKind::u16);
  expect_read<std::int32_t>(NumberKind::i32);
  expect_read<std::uint32_t>(NumberKind::u32);
  expect_read<std::int64_t>(NumberKind::i64);
  expect_read<std::uint64_t>(NumberKind::u64);
  expect_read<float>(NumberKind::f32);
  expect_read<double>(NumberKind::f64);
}

TEST(StoredNumbers, Of24BitsKeepTheirSign) {
  const std::string bytes("\x01\x00\x00\xFF\xFF\xFF\x00\x00\x80", 9);
  const tests::WrittenFile file(bytes, ".bin");
  for (const bool big_endian : {false, true}) {
    StoredNumbers numbers(NumberKind::i24, big_endian);
    numbers.add({0, 3, 3});
    Record record;
    record.channels.resize(1);
    const auto reader =
        reader_of_numbers(std::make_unique<MappedFile>(file.path()), record, {{numbers}});
    const std::vector<double> expected = big_endian ? std::vector<double>{65536.0, -1.0, 128.0}
                                                    : std::vector<double>{1.0, -1.0, -8388608.0};
    EXPECT_EQ(read_into_memory(*reader).channels[0].values(), expected);
  }
}

/// Two channels of doubles in chunks: channel c's sample i is i + c/2.
struct Chunks {
  std::string bytes;
  std::vector<StoredChannel> channels{2};
};

Chunks chunks(std::size_t chunks, std::size_t samples) {
  Chunks made;
  for (StoredChannel& channel : made.channels) channel.samples = StoredNumbers(NumberKind::f64);
  for (std::size_t k = 0; k < chunks; ++k)
    for (std::size_t c = 0; c < 2; ++c) {
      made.channels[c].samples.add({made.bytes.size(), samples, 8});
      for (std::size_t i = 0; i < samples; ++i) {
        const double value = static_cast<double>(k * samples + i) + 0.5 * static_cast<double>(c);
        made.bytes.append(reinterpret_cast<const char*>(&value), 8);
      }
    }
  return made;
}

TEST(StoredNumbers, EqualChunksTakeNoMemory) {
  const Chunks made = chunks(1000, 3);
  ASSERT_EQ(made.channels[0].samples.runs().size(), 1U);
  EXPECT_EQ(made.channels[1].samples.runs()[0].repeats, 1000U);
  EXPECT_EQ(made.channels[1].samples.size(), 3000U);
}

TEST(StoredNumbers, AWindowIsAPartOfTheWhole) {
  const Chunks made = chunks(700, 301);
  const tests::WrittenFile file(made.bytes, ".bin");
  Record record;
  record.channels.resize(2);
  for (Channel& channel : record.channels) channel.clock = {1.0, 0.5, {}};
  const auto reader =
      reader_of_numbers(std::make_unique<MappedFile>(file.path()), record, made.channels);
  const Record whole = read_into_memory(*reader);
  ASSERT_EQ(whole.channels[1].size(), 210700U);
  for (std::size_t i = 0; i < 210700; ++i)
    ASSERT_EQ(whole.channels[1].value(i), static_cast<double>(i) + 0.5);
  for (const std::size_t first : {0U, 1U, 300U, 301U, 302U, 90000U, 210699U}) {
    Selection wanted;
    wanted.channels = {1};
    wanted.from = 1.0 + 0.5 * static_cast<double>(first);
    wanted.to = wanted.from + 40000.0;
    const Record part = read_into_memory(*reader, wanted);
    ASSERT_EQ(part.channels.size(), 1U);
    ASSERT_EQ(part.channels[0].size(), std::min<std::size_t>(80001, 210700 - first));
    EXPECT_EQ(part.channels[0].clock.start, wanted.from);
    for (std::size_t i = 0; i < part.channels[0].size(); ++i)
      ASSERT_EQ(part.channels[0].value(i), whole.channels[1].value(first + i));
  }
}

TEST(StoredNumbers, OutsideOfTheFileAreRefused) {
  const tests::WrittenFile file("0123456789", ".bin");
  Record record;
  record.channels.resize(1);
  const auto read = [&](const NumberRun& run) {
    StoredNumbers numbers(NumberKind::i16);
    numbers.add(run);
    reader_of_numbers(std::make_unique<MappedFile>(file.path()), record, {{numbers}});
  };
  EXPECT_NO_THROW(read({0, 5, 2}));
  EXPECT_THROW(read({1, 5, 2}), datasets::InputError);
  EXPECT_THROW(read({11, 1, 2}), datasets::InputError);
  EXPECT_THROW(read({0, std::uint64_t{1} << 63, 2}), datasets::InputError);
  EXPECT_THROW(read({0, 1, 2, std::uint64_t{1} << 62, std::uint64_t{1} << 62}),
               datasets::InputError);
  const MappedFile mapped(file.path());
  EXPECT_EQ(numbers_there(mapped, 0, 2, NumberKind::i16, 1000), 5U);
  EXPECT_EQ(numbers_there(mapped, 1, 2, NumberKind::i16, 1000), 4U);
  EXPECT_EQ(numbers_there(mapped, 9, 2, NumberKind::i16, 1000), 0U);
  EXPECT_EQ(numbers_there(mapped, 0, 2, NumberKind::i16, 3), 3U);
}

TEST(StoredNumbers, StatedTimesCutTheWindow) {
  const std::vector<double> times = {0.0, 0.1, 0.3, 0.35, 0.9};
  std::string bytes;
  for (const double time : times) bytes.append(reinterpret_cast<const char*>(&time), 8);
  const tests::WrittenFile file(bytes, ".bin");
  StoredChannel channel;
  channel.samples = StoredNumbers(NumberKind::f64);
  channel.samples.add({0, times.size(), 8});
  channel.times = channel.samples;
  Record record;
  record.channels.resize(1);
  const auto reader =
      reader_of_numbers(std::make_unique<MappedFile>(file.path()), record, {channel});
  Selection wanted;
  wanted.from = 0.2;
  wanted.to = 0.35;
  const Record part = read_into_memory(*reader, wanted);
  EXPECT_EQ(part.channels[0].values(), (std::vector<double>{0.3, 0.35}));
  EXPECT_EQ(part.channels[0].clock.times, (std::vector<double>{0.3, 0.35}));
  EXPECT_EQ(part.channels[0].clock.start, 0.3);
}

TEST(OurRecording, IsReadByWindows) {
  for (const auto time : {microseconds, uneven}) {
    const tests::WrittenFile table_file(table(150000, time), ".csv");
    const Record whole = import_recording(table_file.path());
    const tests::WrittenFile file("", ".h5");
    datasets::write_record(whole, file.path());
    const auto reader = open_recording(file.path());
    EXPECT_EQ(reader->head().samples, (std::vector<std::uint64_t>{150000, 150000}));
    const Record again = read_into_memory(*reader);
    EXPECT_EQ(again.channels[0].clock.times, whole.channels[0].clock.times);
    EXPECT_EQ(again.channels[0].valid, whole.channels[0].valid);
    EXPECT_EQ(again.channels[1].raw, whole.channels[1].raw);
    Selection wanted;
    wanted.channels = {1};
    wanted.from = 0.1;
    wanted.to = 0.100099;
    const Record part = read_into_memory(*reader, wanted);
    ASSERT_EQ(part.channels.size(), 1U);
    EXPECT_EQ(part.channels[0].size(), time == uneven ? 99U : 100U);
    EXPECT_NEAR(part.channels[0].clock.interval, 1e-6, 1e-13);
    EXPECT_EQ(part.channels[0].value(0), 100000.0);
    EXPECT_DOUBLE_EQ(part.channels[0].clock.start, 0.1);
  }
}

TEST(Import, OfChannelsByNameAndAWindow) {
  const tests::WrittenFile file(table(1000, microseconds), ".csv");
  ImportOptions options;
  options.channels = {"velocity"};
  options.from = 100e-6;
  options.to = 199e-6;
  const Record record = import_recording(file.path(), options);
  ASSERT_EQ(record.channels.size(), 1U);
  EXPECT_EQ(record.channels[0].size(), 100U);
  EXPECT_EQ(record.channels[0].value(0), 100.0);
  EXPECT_DOUBLE_EQ(record.channels[0].clock.start, 1e-4);
  options.sample_rate = 1e5;  // the window is that of the stated rate
  options.from = 1e-3;
  options.to = 1.99e-3;
  const Record rated = import_recording(file.path(), options);
  ASSERT_EQ(rated.channels[0].size(), 100U);
  EXPECT_EQ(rated.channels[0].value(0), 100.0);
  EXPECT_DOUBLE_EQ(rated.channels[0].clock.start, 1e-3);
  EXPECT_EQ(rated.channels[0].clock.interval, 1e-5);
  options.sample_rate.reset();
  options.from = 5.0;
  options.to = 6.0;
  EXPECT_EQ(tests::import_error(table(1000, microseconds), options, ".csv"),
            "FILE: there is no sample between 5 and 6 s: the recording goes from 0 to 0.000999 s");
  options.channels = {"Torque"};
  EXPECT_EQ(tests::import_error(table(3, microseconds), options, ".csv"),
            "FILE: there is no channel 'Torque'; the channels are 'Force', 'Velocity'");
}

}  // namespace
}  // namespace impactrig::acquisition
