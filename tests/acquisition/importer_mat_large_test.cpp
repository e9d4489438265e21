// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "acquisition/importer.hpp"
#include "tests/acquisition/mat_byte_order.hpp"
#include "tests/acquisition/mat_bytes.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using tests::import_error;
using tests::imported;
using tests::Mat;
using tests::MatBytes;

/// An array of `size` zero bytes, compressed: a thousandth of it.
std::string compressed_zeros(const MatBytes& b, std::uint32_t size) {
  z_stream z{};
  deflateInit(&z, Z_BEST_SPEED);
  std::string packed;
  std::string piece(std::size_t{1} << 20, '\0');
  std::string room(piece.size(), '\0');
  const auto feed = [&](std::string& bytes, int flush) {
    z.next_in = reinterpret_cast<Bytef*>(bytes.data());
    z.avail_in = static_cast<uInt>(bytes.size());
    do {
      z.next_out = reinterpret_cast<Bytef*>(room.data());
      z.avail_out = static_cast<uInt>(room.size());
      deflate(&z, flush);
      packed.append(room, 0, room.size() - z.avail_out);
    } while (z.avail_out == 0);
  };
  std::string tag = b.number<std::uint32_t>(14) + b.number(size);
  feed(tag, Z_NO_FLUSH);
  for (std::uint32_t done = 0; done < size; done += 1U << 20) feed(piece, Z_NO_FLUSH);
  feed(tag, Z_FINISH);
  deflateEnd(&z);
  return b.number<std::uint32_t>(15) + b.number(static_cast<std::uint32_t>(packed.size())) + packed;
}

// Larger arrays are inflated when they are read, not when the file is opened: what is between them,
// beside them in a structure and within a window comes out as without compression.
TEST_P(Mat, LargeCompressedArraysAreTheSame) {
  std::vector<double> values(120000);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = std::sin(0.37 * double(i * i));
  std::vector<float> singles(values.begin(), values.end());
  std::vector<std::int16_t> shorts(300000);
  std::iota(shorts.begin(), shorts.end(), std::int16_t{-7});
  const std::string imaginary =
      b.matrix(b.head(0x0806, {120000, 1}, "z") + b.element(9, b.numbers(values)) +
               b.element(7, b.numbers(singles)));
  const std::string rows =
      b.matrix(b.head(10, {3, 100000}, "rows") + b.element(3, b.numbers(shorts)));
  const std::string structure =
      b.structure("run", {"a", "note", "b", "dt"},
                  b.doubles("", values) + b.text("", "hit") +
                      b.matrix(b.head(7, {120000, 1}, "") + b.element(7, b.numbers(singles))) +
                      b.doubles("", {0.5}));
  const auto plain = imported(b.header() + imaginary + rows + structure + b.doubles("x", {1, 2}));
  ASSERT_EQ(plain.channels.size(), 8U);
  for (const bool mixed : {false, true}) {
    const std::string bytes = b.header() + b.compressed(imaginary) +
                              (mixed ? rows : b.compressed(rows)) + b.compressed(structure) +
                              b.compressed(b.doubles("x", {1, 2}));
    const auto record = imported(bytes);
    ASSERT_EQ(record.channels.size(), plain.channels.size());
    EXPECT_EQ(record.attributes, plain.attributes);
    EXPECT_EQ(record.warnings, plain.warnings);
    for (std::size_t c = 0; c < plain.channels.size(); ++c) {
      EXPECT_EQ(record.channels[c].name, plain.channels[c].name);
      EXPECT_EQ(record.channels[c].raw, plain.channels[c].raw);
      EXPECT_EQ(record.channels[c].imaginary, plain.channels[c].imaginary);
      EXPECT_EQ(record.channels[c].clock.interval, plain.channels[c].clock.interval);
    }
    ImportOptions options;
    options.channels = {"run.b", "run.a"};
    options.from = 25000.0;
    options.to = 50000.0;
    const auto part = imported(bytes, options);
    ASSERT_EQ(part.channels.at(0).size(), 50001U);
    EXPECT_EQ(part.channels[0].value(0), static_cast<double>(singles[50000]));
    EXPECT_EQ(part.channels[1].value(50000), values[100000]);
  }
}

TEST_P(Mat, ACutLargeCompressedArrayGivesWhatIsThere) {
  std::vector<double> values(100000);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = std::sin(0.37 * double(i * i));
  const std::string bytes = b.header() + b.compressed(b.doubles("x", values));
  const auto record = imported(bytes.substr(0, bytes.size() / 2));
  const std::size_t n = record.channels.at(0).size();
  EXPECT_GT(n, 40000U);
  EXPECT_LT(n, 60000U);
  for (std::size_t i = 0; i < n; ++i) ASSERT_EQ(record.channels[0].value(i), values[i]);
  EXPECT_THAT(record.warnings, Contains(HasSubstr("is damaged or cut")));
}

TEST_P(Mat, ABombIsRefused) {
  const std::string bytes = b.header() + compressed_zeros(b, 257U << 20);
  EXPECT_LT(bytes.size(), 2U << 20);
  EXPECT_EQ(import_error(bytes),
            "FILE (byte 136): the arrays up to here are more than 256 MB once they are inflated: "
            "load the file in MATLAB and save it with -v6 or -v7.3");
  // what declares little inflates to no more
  const auto record =
      imported(b.header() + b.compressed(b.doubles("x", {1}) + std::string(1U << 24, '\0')));
  EXPECT_THAT(record.channels, IsEmpty());
  EXPECT_THAT(record.warnings, Contains(HasSubstr("is damaged (its checksum or its length")));
}

TEST_P(Mat, ACompressedArrayWithAWrongChecksumIsLeftOut) {
  std::vector<double> values(1000);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = std::sin(0.37 * double(i * i));
  const std::string good = b.compressed(b.doubles("y", {1, 2}));
  const std::string array = b.compressed(b.doubles("x", values));
  for (const std::size_t from_end : {1U, 4U, 100U, 4000U}) {
    std::string damaged = array;
    damaged[damaged.size() - from_end] ^= 0x10;
    const auto record = imported(b.header() + damaged + good);
    ASSERT_EQ(record.channels.size(), 1U) << from_end;
    EXPECT_EQ(record.channels[0].name, "y");
    EXPECT_THAT(record.warnings, Contains(HasSubstr("compressed array at byte 136 is damaged")));
  }
}

}  // namespace
}  // namespace impactrig::acquisition
