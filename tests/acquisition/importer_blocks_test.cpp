// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "acquisition/importers/formats.hpp"
#include "datasets/input_error.hpp"
#include "datasets/store.hpp"
#include "tests/acquisition/large_texts.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Channel;
using datasets::Record;
using tests::expect_same;
using tests::microseconds;
using tests::table;
using tests::uneven;

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

TEST(LargeCsv, WithMarksAndWordsBehindTheRowsIsReadByBlocksAsItIsReadAtOnce) {
  std::string text = table(40000, microseconds) + "\nEnd of data\n";
  const std::size_t row = text.find("0.0200000,") + 10;
  text.replace(row, text.find(',', row) - row, "OVL");
  const tests::WrittenFile file(text, ".csv");
  const Record record = by_blocks(file.path());
  expect_same(record, read_into_memory(*open_csv(file.path(), {})));
  EXPECT_EQ(record.channels[0].size(), 40000U);
  EXPECT_FALSE(record.channels[0].is_valid(20000));
  EXPECT_THAT(record.warnings, testing::Contains(testing::HasSubstr("'End of data'")));
  const auto reader = open_csv_by_blocks(file.path(), {});
  EXPECT_EQ(reader->head().samples, (std::vector<std::uint64_t>{40000, 40000}));
  const Record part = by_blocks(file.path(), {{}, 0.0399, 1.0});
  EXPECT_EQ(part.channels[0].size(), 100U);
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

/// Channels of two clocks; the times of the second are by `other`.
template <typename Time>
std::string two_clocks(std::size_t rows, const Time& other) {
  std::string text = "Time A [s],Force [N],Comment,Time B [ms],Vel [m/s],Nothing [V]\n";
  for (std::size_t i = 0; i < rows; ++i)
    text += fmt::format("{:.6f},{},{},{:.4f},{},\n", 1e-6 * static_cast<double>(i), i % 7,
                        i == 3 ? "hit" : "", 1e3 * (5e-6 + 2.0 * other(i)),
                        i % 1000 == 7 ? "" : fmt::format("{}", i % 5));
  return text;
}

TEST(LargeCsv, WithTwoTimeColumnsIsReadByBlocksAsItIsReadAtOnce) {
  for (const auto time : {microseconds, uneven}) {
    for (const std::string& end : {std::string(), std::string("0.040,3")}) {
      const tests::WrittenFile file(two_clocks(120000, time) + end, ".csv");
      const Record at_once = read_into_memory(*open_csv(file.path(), {}));
      expect_same(by_blocks(file.path()), at_once);
      ASSERT_EQ(at_once.channels.size(), 3U);
      EXPECT_EQ(at_once.channels[1].clock.uniform(), time == microseconds);
      EXPECT_NEAR(at_once.channels[1].clock.interval, 2e-6, 1e-10);
      Selection wanted;
      wanted.channels = {1, 0};
      wanted.from = 0.1;
      wanted.to = 0.11;
      const Record part = by_blocks(file.path(), wanted);
      const Record expected = read_into_memory(*open_csv(file.path(), {}), wanted);
      ASSERT_EQ(part.channels.size(), 2U);
      for (std::size_t c = 0; c < 2; ++c) {
        EXPECT_EQ(part.channels[c].name, expected.channels[c].name);
        EXPECT_EQ(part.channels[c].valid, expected.channels[c].valid);
        EXPECT_EQ(part.channels[c].values().size(), expected.channels[c].values().size());
        EXPECT_NEAR(part.channels[c].clock.start, expected.channels[c].clock.start, 1e-12);
        EXPECT_EQ(part.channels[c].clock.times, expected.channels[c].clock.times);
      }
      EXPECT_NEAR(double(part.channels[0].size()), 5000.0, 2.0);
      EXPECT_NEAR(double(part.channels[1].size()), 10000.0, 2.0);
    }
  }
}

TEST(LargeCsv, ShowsEachClockInItsHead) {
  const tests::WrittenFile file(two_clocks(40000, microseconds), ".csv");
  for (const bool head_only : {false, true}) {
    ImportOptions options;
    options.head_only = head_only;
    const auto reader = open_csv_by_blocks(file.path(), options);
    const Record& record = reader->head().record;
    ASSERT_EQ(record.channels.size(), 3U);
    EXPECT_NEAR(record.channels[0].clock.interval, 1e-6, 1e-15);
    EXPECT_NEAR(record.channels[1].clock.interval, 2e-6, 1e-15);
    EXPECT_EQ(reader->head().samples, (std::vector<std::uint64_t>{40000, 40000, 40000}));
  }
}

// Where the times of a group end before the others', or go back, they are a channel: behind the
// first rows that say what columns are, only reading on tells.
/// Two clocks in 120000 rows, and ten more rows that begin with times and end with `last`.
Record ended_by(const std::string& last) {
  std::string text = two_clocks(120000, microseconds);
  for (int i = 120000; i < 120010; ++i) text += fmt::format("{:.6f}", i * 1e-6) + last + "\n";
  const tests::WrittenFile file(text, ".csv");
  Record at_once = read_into_memory(*open_csv(file.path(), {}));
  expect_same(by_blocks(file.path()), at_once);
  return at_once;
}

TEST(LargeCsv, ATimeColumnThatDoesNotIncreaseThroughoutIsAChannel) {
  EXPECT_EQ(ended_by(",3,,0.1,4,").channels.size(), 4U);
}

TEST(LargeCsv, ChannelsEndWithTheirTimes) {
  const Record ended = ended_by(",3,,,,");
  ASSERT_EQ(ended.channels.size(), 3U);
  EXPECT_EQ(ended.channels[0].size(), 120010U);
  EXPECT_EQ(ended.channels[1].size(), 120000U);
  const Record without_time = ended_by(",3,,,5,");
  EXPECT_EQ(without_time.channels.at(1).size(), 120000U);
  EXPECT_THAT(without_time.warnings,
              testing::Contains(testing::HasSubstr("10 values behind the last of its times")));
}

TEST(LargeCsv, WithAColumnOfTextIsReadByBlocksAsItIsReadAtOnce) {
  std::string text = "time [s],Force [N],Event,Vel [m/s],Comment\n";
  for (int i = 0; i < 40000; ++i)
    text += fmt::format("{:.6f},{},{},{}{}\n", i * 1e-6, i % 7, i % 9 == 3 ? "hit" : "", i % 5,
                        i % 11 == 0 ? ",start" : "");
  const tests::WrittenFile file(text, ".csv");
  const Record at_once = read_into_memory(*open_csv(file.path(), {}));
  expect_same(by_blocks(file.path()), at_once);
  EXPECT_EQ(at_once.channels.size(), 2U);
  EXPECT_EQ(at_once.warnings.size(), 2U);
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

TEST(LargePolytecText, WithoutARowIsRefused) {
  const tests::WrittenFile file(polytec("Time", "s", 0, microseconds), ".txt");
  EXPECT_THROW(open_polytec_ascii_by_blocks(file.path(), {}), datasets::InputError);
}

TEST(LargeCsv, OfFewerLinesThanAreLookedAtIsReadAsItIsReadAtOnce) {
  const tests::WrittenFile file("0,5\n1e-6,7\n", ".csv");
  expect_same(by_blocks(file.path()), read_into_memory(*open_csv(file.path(), {})));
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
