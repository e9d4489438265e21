// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/take_apart.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <vector>

#include "acquisition/importers/stored_numbers.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Record;

std::string noise(std::size_t bytes) {
  std::mt19937_64 random(17);
  std::string all(bytes, '\0');
  for (char& byte : all) byte = static_cast<char>(random());
  return all;
}

// By the definition, byte by byte.
TEST(TakeApart, PutsEachColumnTogether) {
  for (const std::size_t width : {2U, 4U, 8U})
    for (std::size_t columns = 2; columns < 19; ++columns)
      for (std::size_t rows = 0; rows < 20; ++rows) {
        SCOPED_TRACE(fmt::format("{} rows of {} numbers of {} bytes", rows, columns, width));
        const std::string from = noise(rows * columns * width);
        const std::size_t column = rows * width + 3;  // columns need not touch
        std::string to(columns * column, '?');
        take_apart(from.data(), rows, columns, width, to.data(), column);
        std::string expected(to.size(), '?');
        for (std::size_t i = 0; i < rows; ++i)
          for (std::size_t c = 0; c < columns; ++c)
            for (std::size_t b = 0; b < width; ++b)
              expected[c * column + i * width + b] = from[(i * columns + c) * width + b];
        ASSERT_EQ(to, expected);
      }
}

/// Rows of numbers of these kinds; column c of row i holds 3 i + c, in integers of 16 bits modulo
/// 2^15.
struct Rows {
  std::string bytes;
  std::vector<StoredChannel> channels;
};

double expected(NumberKind kind, std::size_t row, std::size_t column) {
  const std::size_t number = 3 * row + column;
  return static_cast<double>(kind == NumberKind::i16 ? number % 32768 : number);
}

template <typename Number>
void append(std::string& bytes, double value, bool swapped) {
  const auto number = static_cast<Number>(value);
  std::string raw(sizeof number, '\0');
  std::memcpy(raw.data(), &number, sizeof number);
  if (swapped) std::reverse(raw.begin(), raw.end());
  bytes += raw;
}

Rows rows_of(const std::vector<NumberKind>& kinds, std::size_t rows, bool big_endian,
             const std::string& before) {
  Rows made;
  made.bytes = before;
  const bool swapped = big_endian != (std::endian::native == std::endian::big);
  for (std::size_t i = 0; i < rows; ++i)
    for (std::size_t c = 0; c < kinds.size(); ++c) {
      const double value = expected(kinds[c], i, c);
      if (kinds[c] == NumberKind::i16) append<std::int16_t>(made.bytes, value, swapped);
      if (kinds[c] == NumberKind::i32) append<std::int32_t>(made.bytes, value, swapped);
      if (kinds[c] == NumberKind::f32) append<float>(made.bytes, value, swapped);
      if (kinds[c] == NumberKind::f64) append<double>(made.bytes, value, swapped);
    }
  std::uint64_t stride = 0;
  for (const NumberKind kind : kinds) stride += size_of(kind);
  std::uint64_t at = before.size();
  for (const NumberKind kind : kinds) {
    made.channels.push_back({StoredNumbers(kind, big_endian)});
    made.channels.back().samples.add({at, rows, stride, 1, 0});
    at += size_of(kind);
  }
  return made;
}

// Rows of equal numbers are taken apart at once, others one by one; both give the same.
TEST(StoredNumbers, InRowsAreReadInAnyOrderAndSelection) {
  constexpr auto i16 = NumberKind::i16;
  constexpr auto i32 = NumberKind::i32;
  constexpr auto f32 = NumberKind::f32;
  constexpr auto f64 = NumberKind::f64;
  const std::vector<std::vector<NumberKind>> kinds = {{i16, i16},
                                                      {f32, f32, f32, f32, f32, f32, f32, f32},
                                                      {f64, f64, f64},
                                                      {f32, i32, f32},
                                                      {f32, i16, i16, f32},
                                                      {i16, f32, i16},
                                                      std::vector<NumberKind>(11, i16)};
  for (const std::vector<NumberKind>& row : kinds)
    for (const bool big_endian : {false, true})
      for (const std::size_t rows : {1U, 7U, 30001U}) {
        SCOPED_TRACE(fmt::format("{} numbers in a row, big endian {}, {} rows", row.size(),
                                 big_endian, rows));
        const Rows made = rows_of(row, rows, big_endian, "head");
        const tests::WrittenFile file(made.bytes, ".bin");
        Record record;
        record.channels.resize(row.size());
        for (auto& channel : record.channels) channel.clock = {0.0, 1.0, {}};
        const auto reader =
            reader_of_numbers(std::make_unique<MappedFile>(file.path()), record, made.channels);
        std::vector<std::size_t> backwards;
        for (std::size_t c = row.size(); c-- > 0;) backwards.push_back(c);
        for (const auto& chosen : {std::vector<std::size_t>{}, backwards, {row.size() - 1, 0}}) {
          Selection wanted;
          wanted.channels = chosen;
          wanted.from = rows > 100 ? 1.0 : 0.0;
          const std::size_t first = rows > 100 ? 1 : 0;
          const Record found = read_into_memory(*reader, wanted);
          for (std::size_t k = 0; k < found.channels.size(); ++k) {
            const std::size_t c = chosen.empty() ? k : chosen[k];
            ASSERT_EQ(found.channels[k].size(), rows - first);
            for (std::size_t i = first; i < rows; ++i)
              ASSERT_EQ(found.channels[k].value(i - first), expected(row[c], i, c))
                  << "channel " << c << " sample " << i;
          }
        }
      }
}

// A second segment with the channels in another order, and one whose last row is cut.
TEST(StoredNumbers, InRowsOfChangingOrderAreRead) {
  constexpr std::size_t rows = 20000;
  Rows made = rows_of(std::vector<NumberKind>(4, NumberKind::f32), rows, false, "");
  const std::size_t second = made.bytes.size();
  for (std::size_t i = rows; i < 2 * rows; ++i)
    for (std::size_t c = 4; c-- > 0;)
      append<float>(made.bytes, expected(NumberKind::f32, i, c), false);
  for (std::size_t c = 0; c < 4; ++c)
    made.channels[c].samples.add({second + 4 * (3 - c), c == 0 ? rows - 1 : rows, 16, 1, 0});
  made.bytes.resize(made.bytes.size() - 4);
  const tests::WrittenFile file(made.bytes, ".bin");
  Record record;
  record.channels.resize(4);
  const Record found = read_into_memory(
      *reader_of_numbers(std::make_unique<MappedFile>(file.path()), record, made.channels));
  for (std::size_t c = 0; c < 4; ++c) {
    ASSERT_EQ(found.channels[c].size(), c == 0 ? 2 * rows - 1 : 2 * rows);
    for (std::size_t i = 0; i < found.channels[c].size(); ++i)
      ASSERT_EQ(found.channels[c].value(i), expected(NumberKind::f32, i, c)) << c << " " << i;
  }
}

}  // namespace
}  // namespace impactrig::acquisition
