// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <string>

#include "tests/acquisition/numpy_bytes.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Channel;
using datasets::Record;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using tests::import_error;
using tests::imported;
using tests::little;
using tests::names_and_units;
using tests::npy;
using tests::utf32;
using tests::zip_archive;

constexpr int samples = 200;

/// Times, and two columns that are none.
double number(int k, int column) {
  return column == 0 ? 0.5 * k : column == 1 ? 3.0 * (k % 10) : -2.0 * (k % 7);
}

/// Numbers of three columns, sample after sample.
template <typename Number>
std::string by_rows() {
  std::string bytes;
  for (int k = 0; k < samples; ++k)
    for (int column = 0; column < 3; ++column)
      bytes += little(static_cast<Number>(number(k, column)));
  return bytes;
}

std::string reversed(std::string bytes, std::size_t width) {
  for (std::size_t i = 0; i < bytes.size(); i += width)
    std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(i),
                 bytes.begin() + static_cast<std::ptrdiff_t>(i + width));
  return bytes;
}

void expect_three_columns(const Record& record) {
  EXPECT_EQ(record.provenance.importer, "numpy");
  EXPECT_THAT(names_and_units(record), ElementsAre("array:1 []", "array:2 []", "array:3 []"));
  EXPECT_DOUBLE_EQ(record.channels[1].clock.interval, 0.5);
  for (int k = 0; k < samples; ++k) {
    EXPECT_EQ(record.channels[1].value(static_cast<std::size_t>(k)), number(k, 1));
    EXPECT_EQ(record.channels[2].value(static_cast<std::size_t>(k)), number(k, 2));
  }
}

TEST(NumPy, AnArrayIsAChannelAColumn) {
  const std::string shape = fmt::format("({}, 3)", samples);
  for (const char version : {'\1', '\2', '\3'})
    expect_three_columns(imported(npy("'<f8'", shape, by_rows<double>(), false, version)));
  expect_three_columns(imported(npy("'>f4'", shape, reversed(by_rows<float>(), 4))));
  std::string columns;
  for (int column = 0; column < 3; ++column)
    for (int k = 0; k < samples; ++k) columns += little(number(k, column));
  expect_three_columns(imported(npy("'<f8'", shape, columns, true)));
  expect_three_columns(imported(npy("'<f8'", fmt::format("(3L, {}L)", samples), columns)));
  const Record record = imported(npy("'<f8'", shape, by_rows<double>()));
  EXPECT_EQ(record.channels[0].attributes.at("size"), "200 x 3");
}

TEST(NumPy, RecordsAreAChannelAField) {
  std::string rows;
  for (int k = 0; k < samples; ++k)
    rows += little(0.25 * k) + little(static_cast<std::int16_t>(-k)) +
            little(static_cast<float>(k) + 0.5F) + little(static_cast<float>(2 * k)) +
            little(static_cast<std::uint8_t>(k % 7)) + "text";
  const Record record =
      imported(npy("[('time', '<f8'), (('a title', 'force_N'), '<i2'), ('shot', "
                   "'<f4', (2,)), ('s', [('q', '|u1')]), ('note', '|S4')]",
                   fmt::format("({},)", samples), rows));
  EXPECT_THAT(names_and_units(record),
              ElementsAre("time []", "force_N [N]", "shot:1 []", "shot:2 []", "s.q []"));
  for (const Channel& channel : record.channels)
    EXPECT_DOUBLE_EQ(channel.clock.interval, 0.25) << channel.name;
  EXPECT_EQ(record.channels[1].value(7), -7.0);
  EXPECT_EQ(record.channels[2].value(7), 7.5);
  EXPECT_EQ(record.channels[3].value(7), 14.0);
  EXPECT_EQ(record.channels[4].value(8), 1.0);
  EXPECT_THAT(record.warnings, Contains("not read: 'note' (text)"));
}

// As align=True pads them, and as Python 2 wrote names.
TEST(NumPy, RecordsMayBePaddedAndTheirNamesPrefixed) {
  std::string rows;
  for (int k = 0; k < samples; ++k)
    rows += little(static_cast<std::int32_t>(k)) + std::string(4, '\x7F') + little(0.5 * k);
  const Record record = imported(npy("[(u'n', '<i4'), ('', '|V4'), (u'force_N', '<f8')]",
                                     fmt::format("({},)", samples), rows));
  EXPECT_THAT(names_and_units(record), ElementsAre("n []", "force_N [N]"));
  EXPECT_EQ(record.channels[1].value(7), 3.5);
  for (const std::string& warning : record.warnings)
    EXPECT_EQ(warning.find("not read"), std::string::npos) << warning;
}

TEST(NumPy, AnArchiveHasNamesUnitsAndRate) {
  for (const bool packed : {false, true}) {
    std::string data;
    for (int k = 0; k < samples; ++k) data += little(3.0 * k) + little(-2.0 * k);
    const Record record = imported(
        zip_archive({{"data.npy", npy("'<f8'", fmt::format("({}, 2)", samples), data), packed},
                     {"channel_names.npy",
                      npy("'<U8'", "(2,)", utf32("force", 8) + utf32("velocity", 8)), packed},
                     {"units.npy", npy("'|S3'", "(2,)", std::string("N\0\0m/s", 6)), packed},
                     {"fs.npy", npy("'<i8'", "()", little<std::int64_t>(50000)), packed},
                     {"title.npy", npy("'<U5'", "()", utf32("run 7", 5)), packed}}),
        {}, ".npz");
    EXPECT_THAT(names_and_units(record),
                ElementsAre("data.force [N]", "data.velocity [m/s]", "fs []"));
    EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 2e-5);
    EXPECT_EQ(record.channels[1].value(199), -398.0);
    EXPECT_EQ(record.attributes.at("title"), "run 7");
    EXPECT_THAT(record.warnings, ElementsAre(HasSubstr("fs (an interval of 2e-05 s by its name)")));
  }
}

TEST(NumPy, ComplexNumbersAndIntegersAreRead) {
  const Record record = imported(
      zip_archive({{"t.npy", npy("'<u8'", "(3,)", little<std::uint64_t>({0, 5, 10}))},
                   {"z.npy", npy("'>c8'", "(3,)", reversed(little<float>({1, 2, 3, 4, 5, 6}), 4))},
                   {"flag.npy", npy("'|b1'", "(3,)", std::string("\0\1\1", 3))}}));
  ASSERT_EQ(record.channels.size(), 3U);
  EXPECT_THAT(record.channels[1].values(), ElementsAre(1.0, 3.0, 5.0));
  EXPECT_THAT(record.channels[1].imaginary, ElementsAre(2.0, 4.0, 6.0));
  EXPECT_THAT(record.channels[2].values(), ElementsAre(0.0, 1.0, 1.0));
  EXPECT_DOUBLE_EQ(record.channels[2].clock.interval, 5.0);
}

TEST(NumPy, WhatIsNotReadIsTold) {
  const Record record =
      imported(zip_archive({{"F.npy", npy("'<f8'", "(2,)", little<double>({1.0, 2.0}))},
                            {"o.npy", npy("'|O'", "(1,)", "pickle")},
                            {"d.npy", npy("'<M8[us]'", "(1,)", std::string(8, '\0'))},
                            {"h.npy", npy("'<f2'", "(1,)", std::string(2, '\0'))},
                            {"x.npy", npy("'<f16'", "(1,)", std::string(16, '\0'))},
                            {"e.npy", npy("'<f8'", "(0,)", "")},
                            {"note.txt", "words"},
                            {"cube.npy", npy("'<f8'", "(2, 2, 2)", std::string(64, '\0'))},
                            {"cut.npy", npy("'<f8'", "(9,)", little<double>({1.0, 2.0}))}}));
  EXPECT_THAT(record.warnings,
              Contains("not read: 'note.txt' (no array), 'o' (Python objects), 'd' (dates; save "
                       "them as numbers of seconds), 'h' (half precision; save them as float32), "
                       "'x' (extended precision; save "
                       "them in double precision), 'e' (empty)"));
  EXPECT_THAT(record.warnings, Contains("'cut' declares 9 x 1 numbers, 2 are there"));
  EXPECT_THAT(record.warnings, Contains(HasSubstr("'cube' has 3 dimensions: its 8 numbers are")));
}

TEST(NumPy, DamagedHeadsAreErrors) {
  const auto head = [](const std::string& text) {
    return std::string("\x93NUMPY\1\0", 8) + little(static_cast<std::uint16_t>(text.size())) + text;
  };
  EXPECT_EQ(import_error(head("{'descr': '<f8', 'shape': (3,), }")),
            "FILE (byte 0): the head of the array: it does not state 'fortran_order'");
  EXPECT_EQ(import_error(head("{'descr': '<f8")),
            "FILE (byte 0): the head of the array: a text has no end");
  EXPECT_EQ(import_error(head("{'descr': ('<f8', ")),
            "FILE (byte 0): the head of the array: it ends early");
  EXPECT_EQ(import_error(head("{'descr': 'float', 'fortran_order': False, 'shape': (3,)}")),
            "FILE (byte 0): the head of the array: the type 'float' is not known");
  EXPECT_EQ(import_error(head("{'descr': '|V0', 'fortran_order': False, 'shape': (3,)}")),
            "FILE (byte 0): the head of the array: its elements have no bytes");
  EXPECT_EQ(import_error(head(std::string(40, '['))),
            "FILE (byte 0): the head of the array: lists nested too deeply");
  EXPECT_EQ(import_error(std::string("\x93NUMPY\4\0\0\0", 10)),
            "FILE (byte 0): the head of the array: it is of version 4, expected 1 to 3");
  EXPECT_THAT(import_error(std::string("\x93NUMPY\1\0\xFF\xFF{", 11)),
              HasSubstr("the file ends within the head of a NumPy array"));
  // sides whose product is beyond 2^64
  const std::string huge =
      npy("'<f8'", "(4294967296, 4294967296, 4294967296)", std::string(16, '\1'));
  EXPECT_EQ(imported(huge).channels.at(0).size(), 2U);
}

TEST(NumPy, AWindowOfAChannelIsThatPartOfTheWhole) {
  ImportOptions options;
  options.channels = {"array:3"};
  options.from = 10.0;
  options.to = 10.9;
  options.units = {"s", "N", "m/s"};
  const Record part =
      imported(npy("'<f8'", fmt::format("({}, 3)", samples), by_rows<double>()), options);
  ASSERT_EQ(part.channels.size(), 1U);
  EXPECT_EQ(part.channels[0].unit, "m/s");
  EXPECT_THAT(part.channels[0].values(), ElementsAre(number(20, 2), number(21, 2)));
}

}  // namespace
}  // namespace impactrig::acquisition
