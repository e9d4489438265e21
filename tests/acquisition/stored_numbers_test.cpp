// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>

#include "acquisition/importers/stored_numbers.hpp"
#include "datasets/input_error.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Channel;
using datasets::Record;

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

}  // namespace
}  // namespace impactrig::acquisition
