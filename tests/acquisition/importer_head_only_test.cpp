// SPDX-License-Identifier: BSD-3-Clause
// Large texts of which only the head is wanted: a file that is damaged behind its first MB is
// refused where it is read through, and a text to be rewritten cannot be where there is no folder.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <random>
#include <stdexcept>

#include "acquisition/importer.hpp"
#include "datasets/input_error.hpp"
#include "tests/acquisition/lvm_bytes.hpp"
#include "tests/acquisition/numpy_bytes.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

constexpr std::size_t large = 34'000'000;  ///< [bytes], more than is read at once
const std::string row = "\t1.500000\t12345\n";

/// No folder for temporary files while this lives.
class NoTemporaryFolder {
 public:
  NoTemporaryFolder() { ::setenv("TMPDIR", "/there/is/no/such/folder", 1); }

  ~NoTemporaryFolder() { ::unsetenv("TMPDIR"); }
};

std::unique_ptr<RecordingReader> opened(const tests::WrittenFile& file, bool head_only) {
  ImportOptions options;
  options.head_only = head_only;
  options.require_clock = false;
  return open_recording(file.path(), options);
}

/// So many of the same rows.
std::string rows(std::size_t count) {
  std::string text;
  text.reserve(count * row.size());
  for (std::size_t i = 0; i < count; ++i) text += row;
  return text;
}

/// A segment of two channels without X.
std::string segment(const tests::LvmFile& file, const std::string& samples, std::size_t count,
                    const std::string& time = "09:51:40") {
  return file.segment(tests::lvm_two_channels(samples, "0", "0.000001", time),
                      "X_Value|Force|Velocity|Comment", rows(count));
}

const tests::LvmFile without_x{'\t', "Tab", ".", "No", "Yes", ""};

TEST(HeadOnly, OfOneLabViewSegmentIsWhatItDeclaresWhereItsSizeAgrees) {
  constexpr std::size_t n = large / 16;
  std::string text = without_x.header() + segment(without_x, std::to_string(n), n);
  text.replace(text.size() - 10, 4, "oops");
  const tests::WrittenFile file(text, ".lvm");
  EXPECT_THROW(opened(file, false), datasets::InputError);
  const auto reader = opened(file, true);
  const RecordingHead& head = reader->head();
  EXPECT_FALSE(head.counted);
  EXPECT_EQ(head.samples, (std::vector<std::uint64_t>{n, n}));
  ASSERT_EQ(head.record.channels.size(), 2U);
  EXPECT_EQ(head.record.channels[1].name, "Velocity");
  EXPECT_EQ(head.record.channels[1].unit, "m/s^2");
  EXPECT_EQ(head.record.channels[1].clock.interval, 1e-6);
  EXPECT_THAT(head.record.warnings, testing::IsEmpty());
  EXPECT_THROW(read_into_memory(*reader), std::logic_error);
}

TEST(HeadOnly, OfALabViewSegmentThatDeclaresNothingIsEstimatedByTheSizeOfRows) {
  constexpr std::size_t n = large / 16;
  std::string text = without_x.header() + segment(without_x, "", n);
  text.replace(text.size() - 10, 4, "oops");
  const tests::WrittenFile file(text, ".lvm");
  const auto reader = opened(file, true);
  EXPECT_FALSE(reader->head().counted);
  for (const std::uint64_t samples : reader->head().samples) EXPECT_EQ(samples, n);
  EXPECT_THAT(reader->head().record.warnings, testing::IsEmpty());
}

TEST(HeadOnly, OfSeveralLabViewSegmentsSaysWhatItAssumes) {
  constexpr std::size_t n = large / 16 / 4;
  std::string text = without_x.header();
  for (const char* time : {"09:00:00", "09:00:00.53125", "09:00:01.0625", "09:00:01.59375"})
    text += segment(without_x, std::to_string(n), n, time) + "\n";
  const tests::WrittenFile file(text, ".lvm");
  EXPECT_EQ(opened(file, false)->head().samples, (std::vector<std::uint64_t>{4 * n, 4 * n}));
  const auto reader = opened(file, true);
  EXPECT_FALSE(reader->head().counted);
  for (const std::uint64_t samples : reader->head().samples)
    EXPECT_NEAR(static_cast<double>(samples), 4.0 * n, 100.0);  // rows as long as three headers
  ASSERT_EQ(reader->head().record.warnings.size(), 1U);
  EXPECT_EQ(reader->head().record.warnings[0],
            fmt::format("only the first MB was looked at, whose segment declares 531250 samples, "
                        "while the file has room for about {} like them: it is assumed that those "
                        "behind have the same channels and go on where the one before ends",
                        reader->head().samples[0]));
}

TEST(HeadOnly, OfLabViewSegmentsThatFollowEachOtherCountsThoseBehind) {
  constexpr std::size_t n = 10000;
  constexpr std::size_t segments = large / 16 / n;
  std::string text = without_x.header();
  for (std::size_t i = 0; i < segments; ++i)
    text +=
        segment(without_x, std::to_string(n), n, fmt::format("09:00:{:05.2f}", 0.01 * double(i))) +
        "\n";
  const tests::WrittenFile file(text, ".lvm");
  EXPECT_EQ(opened(file, false)->head().samples, (std::vector<std::uint64_t>(2, n * segments)));
  const RecordingHead head = opened(file, true)->head();
  ASSERT_EQ(head.record.channels.size(), 2U);
  for (const std::uint64_t samples : head.samples)
    EXPECT_NEAR(static_cast<double>(samples), double(n * segments), 0.01 * double(n * segments));
  EXPECT_THAT(head.record.warnings,
              testing::ElementsAre(
                  "only the first MB was looked at, which has 7 segments: it is assumed that those "
                  "behind have the same channels and go on where the one before ends"));
}

TEST(HeadOnly, OfLabViewSegmentsThatDoNotFollowEachOtherListsTheFirst) {
  constexpr std::size_t n = 10000;
  constexpr std::size_t segments = large / 16 / n;
  std::string text = without_x.header();
  for (std::size_t i = 0; i < segments; ++i)
    text +=
        segment(without_x, std::to_string(n), n, fmt::format("10:{:02}:{:02}", i / 60, i % 60)) +
        "\n";
  const tests::WrittenFile file(text, ".lvm");
  const RecordingHead all = opened(file, false)->head();
  ASSERT_EQ(all.record.channels.size(), 2 * segments);
  const RecordingHead head = opened(file, true)->head();
  ASSERT_EQ(head.record.channels.size(), 14U);
  for (std::size_t c = 0; c < 14; ++c) {
    EXPECT_EQ(head.record.channels[c].name, all.record.channels[c].name);
    EXPECT_EQ(head.record.channels[c].clock.start, all.record.channels[c].clock.start);
    EXPECT_EQ(head.samples[c], n);
  }
  ASSERT_EQ(head.record.warnings.size(), 1U);
  EXPECT_THAT(head.record.warnings[0],
              testing::MatchesRegex(
                  "only the first MB was looked at, which has 7 segments that do not continue each "
                  "other in time: about 2[0-9][0-9] more are behind it, whose channels are not "
                  "listed"));
}

// Only all of it tells where its first row is.
TEST(HeadOnly, OfALabViewFileWithoutARowInItsFirstMegabyteIsCounted) {
  constexpr std::size_t n = large / 16;
  tests::LvmFile talkative = without_x;
  for (int i = 0; i < 40000; ++i)
    talkative.more_keys += fmt::format("Remark {}|nothing at all\n", i);
  const tests::WrittenFile file(talkative.header() + segment(talkative, "", n), ".lvm");
  const auto reader = opened(file, true);
  EXPECT_TRUE(reader->head().counted);
  EXPECT_EQ(reader->head().samples, (std::vector<std::uint64_t>{n, n}));
}

TEST(HeadOnly, OfALabViewTextInUtf16IsNotRewritten) {
  constexpr std::size_t n = large / 32;
  const tests::WrittenFile file(tests::utf16(without_x.header() + segment(without_x, "", n)),
                                ".lvm");
  const NoTemporaryFolder nowhere;
  EXPECT_EQ(opened(file, true)->head().samples, (std::vector<std::uint64_t>{n, n}));
}

// Its last segment in the first MB says that it is longer than the file.
TEST(HeadOnly, OfALabViewSegmentThatDeclaresTooMuchHasWhatTheFileHasRoomFor) {
  constexpr std::size_t n = large / 16;
  const tests::WrittenFile file(without_x.header() + segment(without_x, "1000", 1000, "09:00:00") +
                                    "\n" + segment(without_x, "9000000000000000000", n, "10:00:00"),
                                ".lvm");
  const RecordingHead head = opened(file, true)->head();
  ASSERT_EQ(head.record.channels.size(), 4U);
  EXPECT_EQ(head.samples[0], 1000U);
  EXPECT_NEAR(static_cast<double>(head.samples[2]), n, 0.01 * n);
}

// Bytes of the head replaced, left out or doubled: a head whose parts fit together, or an error.
TEST(HeadOnly, OfADamagedLabViewFileIsAHeadOrAnError) {
  const std::string head = without_x.header() + segment(without_x, "20000", 20000, "09:00:00") +
                           "\n" + segment(without_x, "30000", 0, "09:00:01");
  const std::string more = rows(50000);
  std::mt19937 random(7);
  int heads = 0;
  for (int i = 0; i < 60; ++i) {
    std::string text = head;
    for (int damage = 0; damage < 4; ++damage) {
      const std::size_t second = text.size() - 300 + random() % 300;
      const std::size_t at = random() % 2 == 0 ? random() % 600 : second;
      if (random() % 3 == 0)
        text.erase(at, random() % 20);
      else if (random() % 2 == 0)
        text.insert(at, text.substr(random() % 600, random() % 40));
      else
        text[at] = static_cast<char>(random() % 256);
    }
    const tests::WrittenFile file(text + more, ".lvm");
    std::filesystem::resize_file(file.path(), large);
    ImportOptions options;
    options.format = "lvm";
    options.head_only = true;
    options.require_clock = false;
    try {
      const RecordingHead found = open_recording(file.path(), options)->head();
      EXPECT_EQ(found.samples.size(), found.record.channels.size());
      for (const std::uint64_t samples : found.samples) EXPECT_LT(samples, large) << i;
      ++heads;
    } catch (const datasets::InputError& error) {
      EXPECT_NE(error.what(), std::string()) << i;
    }
  }
  EXPECT_GT(heads, 10);
}

/// A table of two channels over time, its lines ending so.
std::string table(std::size_t bytes, char line_end) {
  std::string text = "Time [s],Force [N],Velocity [m/s]";
  text += line_end;
  for (std::size_t i = 0; text.size() < bytes; ++i)
    text += fmt::format("{}.{:06},1.5,{}{}", i / 1000000, i % 1000000, 1000 + i % 9000, line_end);
  return text;
}

TEST(HeadOnly, OfATableToBeRewrittenIsThatOfItsFirstRows) {
  for (const bool wide : {true, false}) {
    const std::string text = wide ? tests::utf16(table(large / 2, '\n')) : table(large, '\r');
    const std::size_t n = ((wide ? text.size() / 2 : text.size()) - 34) / 18;
    const tests::WrittenFile file(text, ".csv");
    const NoTemporaryFolder nowhere;
    EXPECT_THROW(opened(file, false), datasets::FileError);
    const auto reader = opened(file, true);
    const RecordingHead& head = reader->head();
    EXPECT_FALSE(head.counted);
    ASSERT_EQ(head.record.channels.size(), 2U);
    EXPECT_EQ(head.record.channels[0].name, "Force");
    EXPECT_EQ(head.record.channels[0].clock.start, 0.0);
    EXPECT_NEAR(head.record.channels[0].clock.interval, 1e-6, 1e-12);
    for (const std::uint64_t samples : head.samples)
      EXPECT_NEAR(static_cast<double>(samples), static_cast<double>(n), 2.0);
    EXPECT_THROW(read_into_memory(*reader), std::logic_error);
  }
}

// Later rows are longer than those that are looked at: the last time counts them.
TEST(HeadOnly, OfATableToBeRewrittenHasTheRowsThatItsLastTimeTells) {
  const auto made = [](std::string_view line_end) {
    std::string text = "Time [s],Force [N]" + std::string(line_end);
    std::size_t n = 0;
    for (; text.size() < large; ++n)
      text += fmt::format("{:.3f},{}{}", 1e-3 * double(n), n, line_end);
    return std::pair(text, n);
  };
  for (const bool wide : {true, false}) {
    const auto [text, n] = made(wide ? "\r\n" : "\r");
    const std::string bytes = wide ? tests::utf16(text) : text;
    const tests::WrittenFile file(bytes, ".csv");
    EXPECT_EQ(opened(file, true)->head().samples, std::vector<std::uint64_t>{n});
    const std::string remark = wide ? tests::utf16("end of run 7\r\n").substr(2) : "end of run 7\r";
    const tests::WrittenFile with_remark(bytes + remark, ".txt");
    const double estimate = static_cast<double>(opened(with_remark, true)->head().samples.at(0));
    EXPECT_GT(estimate, 1.02 * static_cast<double>(n));
    EXPECT_LT(estimate, 1.5 * static_cast<double>(n));
  }
}

TEST(HeadOnly, OfALabViewTableWithoutHeaderInUtf16IsNotRewritten) {
  std::string text = rows(large / 32);
  for (char& c : text)
    if (c == '\t') c = ' ';
  const tests::WrittenFile file(tests::utf16(text), ".lvm");
  const NoTemporaryFolder nowhere;
  const auto reader = opened(file, true);
  EXPECT_EQ(reader->head().samples, (std::vector<std::uint64_t>(2, large / 32)));
  EXPECT_THROW(read_into_memory(*reader), std::logic_error);
}

TEST(HeadOnly, OfASmallFileIsCounted) {
  const tests::WrittenFile file(tests::utf16(table(100000, '\n')), ".csv");
  const auto reader = opened(file, true);
  EXPECT_TRUE(reader->head().counted);
  EXPECT_EQ(reader->head().samples, opened(file, false)->head().samples);
}

// Which the first and the last stand for: a spoilt one between them is seen when they are read.
TEST(HeadOnly, OfAnArrayItsTimesAreNotReadThrough) {
  static constexpr int n = 200000;
  const auto array = [](int spoilt) {
    std::string bytes;
    for (int k = 0; k < n; ++k)
      bytes += tests::little(k == spoilt ? 0.0 : 0.25 * k) + tests::little(1.0 - k % 7);
    return tests::npy("'<f8'", fmt::format("({}, 2)", n), bytes);
  };
  const auto interval = [](const std::string& bytes, bool head_only) {
    const tests::WrittenFile file(bytes, ".npy");
    return opened(file, head_only)->head().record.channels.at(1).clock.interval;
  };
  EXPECT_EQ(interval(array(-1), false), 0.25);
  EXPECT_EQ(interval(array(-1), true), 0.25);
  EXPECT_EQ(interval(array(n / 2), false), 0.0);
  EXPECT_EQ(interval(array(n / 2), true), 0.25);
  EXPECT_EQ(interval(array(n - 5), true), 0.0);
  EXPECT_EQ(interval(array(5), true), 0.0);
}

}  // namespace
}  // namespace impactrig::acquisition
