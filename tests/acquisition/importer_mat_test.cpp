// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>
#include <tuple>

#include "acquisition/importer.hpp"
#include "tests/acquisition/mat_byte_order.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using tests::import_error;
using tests::imported;
using tests::Mat;
using tests::names_and_units;

INSTANTIATE_TEST_SUITE_P(ByteOrder, Mat, testing::Bool(),
                         [](const auto& instance) { return instance.param ? "Big" : "Little"; });

TEST_P(Mat, EveryTypeOfNumberIsRead) {
  const auto one = [this](const std::string& name, std::uint32_t class_number,
                          const std::string& element) {
    return b.matrix(b.head(class_number, {1, 3}, name) + element);
  };
  const auto record = imported(
      b.header() + one("d", 6, b.element(9, b.numbers<double>({-1.5, 2, 3e300}))) +
      one("s", 7, b.element(7, b.numbers<float>({-1.5F, 2, 3}))) +
      one("as_i8", 6, b.small(1, std::string("\xFF\x02\x03", 3))) +
      one("as_u8", 6, b.small(2, std::string("\xFF\x02\x03", 3))) +
      one("as_i16", 6, b.element(3, b.numbers<std::int16_t>({-1, 2, 3}))) +
      one("as_u16", 6, b.element(4, b.numbers<std::uint16_t>({65535, 2, 3}))) +
      one("as_i32", 6, b.element(5, b.numbers<std::int32_t>({-1, 2, 3}))) +
      one("as_u32", 6, b.element(6, b.numbers<std::uint32_t>({4294967295U, 2, 3}))) +
      one("i64", 14, b.element(12, b.numbers<std::int64_t>({-1, 2, 3}))) +
      one("u64", 15, b.element(13, b.numbers<std::uint64_t>({std::uint64_t{1} << 53, 2, 3}))));
  ASSERT_EQ(record.channels.size(), 10U);
  EXPECT_THAT(record.channels[0].values(), ElementsAre(-1.5, 2, 3e300));
  EXPECT_THAT(record.channels[1].values(), ElementsAre(-1.5, 2, 3));
  EXPECT_THAT(record.channels[2].values(), ElementsAre(-1, 2, 3));
  EXPECT_THAT(record.channels[3].values(), ElementsAre(255, 2, 3));
  EXPECT_THAT(record.channels[4].values(), ElementsAre(-1, 2, 3));
  EXPECT_THAT(record.channels[5].values(), ElementsAre(65535, 2, 3));
  EXPECT_THAT(record.channels[6].values(), ElementsAre(-1, 2, 3));
  EXPECT_THAT(record.channels[7].values(), ElementsAre(4294967295.0, 2, 3));
  EXPECT_THAT(record.channels[8].values(), ElementsAre(-1, 2, 3));
  EXPECT_THAT(record.channels[9].values(), ElementsAre(9007199254740992.0, 2, 3));
  EXPECT_EQ(record.channels[2].name, "as_i8");
  EXPECT_EQ(record.attributes.at("header"), "MATLAB 5.0 MAT-file, written by a test");
}

// A double holds every integer up to 2^53.
TEST_P(Mat, IntegersThatDoublesDoNotHoldAreToldOf) {
  const auto integers = [this](const std::vector<std::int64_t>& values) {
    return imported(b.header() + b.matrix(b.head(14, {1, 3}, "ticks") +
                                          b.element(12, b.numbers<std::int64_t>(values))));
  };
  EXPECT_THAT(integers({-(1LL << 53), 2, 1LL << 53}).warnings,
              testing::Not(Contains(HasSubstr("2^53"))));
  EXPECT_THAT(integers({-(1LL << 53) - 2, 2, 1LL << 60}).warnings,
              Contains("'ticks': 2 samples are beyond 2^53, where doubles do not hold every "
                       "integer: they are rounded to 16 digits"));
}

TEST_P(Mat, CompressedArraysAreTheSame) {
  const std::string time = b.doubles("t", {0, 0.25, 0.5});
  const std::string force = b.doubles("force", {1, 2, 3});
  const std::string note = b.text("note", "hit");
  for (const std::string& bytes :
       {b.header() + time + force + note,
        b.header() + b.compressed(time) + b.compressed(force) + b.compressed(note),
        b.header() + b.compressed(time) + force + note}) {
    const auto record = imported(bytes);
    ASSERT_EQ(record.channels.size(), 2U);
    EXPECT_EQ(record.channels[1].name, "force");
    EXPECT_THAT(record.channels[1].values(), ElementsAre(1, 2, 3));
    EXPECT_EQ(record.channels[1].clock.interval, 0.25);
    EXPECT_EQ(record.attributes.at("note"), "hit");
    EXPECT_EQ(record.attributes.at("time column"), "t (by its name)");
    EXPECT_THAT(record.warnings,
                ElementsAre("the time is taken as s, since no unit is stated: t (by its name)"));
  }
}

TEST_P(Mat, ComplexNumbersHaveTwoParts) {
  const auto record =
      imported(b.header() +
               b.matrix(b.head(0x0806, {3, 1}, "z") + b.element(9, b.numbers<double>({1, 2, 3})) +
                        b.element(3, b.numbers<std::int16_t>({4, 5, 6}))));
  EXPECT_THAT(record.channels[0].values(), ElementsAre(1, 2, 3));
  EXPECT_THAT(record.channels[0].imaginary, ElementsAre(4, 5, 6));
}

TEST_P(Mat, NumbersOfStructuresAreNamedByTheirFields) {
  const auto record = imported(b.header() +
                               b.structure("run", {"force", "unit", "more"},
                                           b.doubles("", {1, 2}) + b.text("", "N") +
                                               b.structure("", {"x"}, b.doubles("", {7}))) +
                               b.structure("s", {"y"}, b.doubles("", {8}) + b.doubles("", {9}), 2));
  ASSERT_EQ(record.channels.size(), 4U);
  EXPECT_EQ(record.channels[0].name, "run.force");
  EXPECT_EQ(record.channels[1].name, "run.more.x");
  EXPECT_EQ(record.channels[2].name, "s(1).y");
  EXPECT_EQ(record.channels[3].name, "s(2).y");
  EXPECT_EQ(record.channels[0].unit, "N");
  EXPECT_EQ(record.attributes.at("run.unit"), "N");
}

TEST_P(Mat, CellsAreNumbered) {
  const std::string cells = b.doubles("", {1, 2}) + b.text("", "hit") +
                            b.structure("", {"x"}, b.doubles("", {3})) +
                            b.matrix(b.head(1, {1, 1}, "") + b.doubles("", {4})) + b.matrix("") +
                            b.object("", "datetime");
  for (const bool packed : {false, true}) {
    const std::string shots = b.matrix(b.head(1, {3, 2}, "shots") + cells);
    const auto record =
        imported(b.header() + (packed ? b.compressed(shots) : shots) +
                 b.structure("run", {"c"}, b.matrix(b.head(1, {2, 1}, "") + b.doubles("", {5}))) +
                 b.matrix(b.head(1, {0, 0}, "none")));
    ASSERT_EQ(record.channels.size(), 4U);
    EXPECT_EQ(record.channels[0].name, "shots{1}");
    EXPECT_THAT(record.channels[0].values(), ElementsAre(1, 2));
    EXPECT_EQ(record.channels[1].name, "shots{3}.x");
    EXPECT_EQ(record.channels[2].name, "shots{4}{1}");
    EXPECT_EQ(record.channels[3].name, "run.c{1}");
    EXPECT_EQ(record.attributes.at("shots{2}"), "hit");
    EXPECT_EQ(record.warnings.at(0),
              "not read: 'shots{6}' (an object of class datetime), 'run.c' (cut), 'none' (empty)");
  }
}

TEST_P(Mat, CellsNestedTooDeeplyAreNamed) {
  std::string nested = b.doubles("", {1});
  for (int i = 0; i < 40; ++i) nested = b.matrix(b.head(1, {1, 1}, i == 39 ? "c" : "") + nested);
  const auto record = imported(b.header() + nested + b.doubles("x", {1}));
  EXPECT_EQ(record.channels.size(), 1U);
  EXPECT_THAT(record.warnings.at(0), testing::EndsWith("{1}' (nested too deeply)"));
}

TEST_P(Mat, WhatIsNoNumberIsNamed) {
  const auto record =
      imported(b.header() + b.matrix(b.head(5, {2, 2}, "sparse") + b.element(5, "")) +
               b.matrix(b.head(16, {1, 1}, "f") + b.doubles("", {1})) +
               b.matrix(b.head(6, {0, 0}, "nothing") + b.element(9, "")) + b.doubles("x", {1}));
  ASSERT_EQ(record.channels.size(), 1U);
  EXPECT_THAT(
      record.warnings,
      ElementsAre(
          "not read: 'sparse' (a sparse matrix), 'f' (a function handle), 'nothing' (empty)"));
}

TEST_P(Mat, ObjectsAreNamedWithTheirClass) {
  const auto record =
      imported(b.header() + b.object("when", "datetime") + b.object("run", "timetable") +
               b.structure("s", {"t", "x"}, b.object("", "table") + b.doubles("", {1, 2})));
  ASSERT_EQ(record.channels.size(), 1U);
  EXPECT_EQ(record.channels[0].name, "s.x");
  EXPECT_EQ(record.warnings[0],
            "not read: 'when' (an object of class datetime), 'run' (an object of class timetable: "
            "table2struct(timetable2table(t), 'ToScalar', true) makes arrays of it), 's.t' (an "
            "object of class table: table2struct(t, 'ToScalar', true) makes arrays of it)");
}

TEST_P(Mat, LongMatricesAreChannelsSmallOnesAreNot) {
  std::vector<double> values(303);
  std::iota(values.begin(), values.end(), 0.0);
  const auto columns = imported(b.header() + b.doubles("m", values, 3));
  ASSERT_EQ(columns.channels.size(), 3U);
  EXPECT_EQ(columns.channels[1].name, "m:2");
  EXPECT_EQ(columns.channels[1].value(0), 101.0);
  EXPECT_EQ(columns.channels[1].size(), 101U);
  EXPECT_EQ(columns.channels[1].attributes.at("size"), "101 x 3");
  const auto rows = imported(b.header() + b.doubles("m", values, 101));
  ASSERT_EQ(rows.channels.size(), 3U);
  EXPECT_EQ(rows.channels[1].value(1), 4.0);
  EXPECT_EQ(rows.channels[1].size(), 101U);
  values.resize(300);
  const auto small = imported(b.header() + b.doubles("m", values, 3));
  ASSERT_EQ(small.channels.size(), 1U);
  EXPECT_EQ(small.channels[0].size(), 300U);
  EXPECT_THAT(small.warnings,
              Contains("'m' is one channel, column behind column: of 100 x 3 numbers nothing tells "
                       "that they are samples of several (times of that length, an interval or a "
                       "rate do)"));
  EXPECT_EQ(
      imported(b.header() + b.doubles("m", values, 3) + b.doubles("fs", {1e3})).channels[0].size(),
      100U);
  const auto matrix = imported(b.header() + b.doubles("m", {1, 2, 3, 4}, 2) + b.doubles("fs", {1}));
  EXPECT_EQ(matrix.channels[0].size(), 4U) << "no more samples than channels";
}

TEST_P(Mat, MoreThanTwoDimensionsAreOneChannelAndToldOf) {
  std::vector<double> values(808);
  const auto record = imported(
      b.header() + b.matrix(b.head(6, {202, 2, 2}, "x") + b.element(9, b.numbers<double>(values))));
  ASSERT_EQ(record.channels.size(), 1U);
  EXPECT_EQ(record.channels[0].size(), 808U);
  EXPECT_THAT(record.warnings,
              Contains("'x' has 3 dimensions: its 808 numbers are one channel, in the order they "
                       "are stored, not one channel a column; save a matrix for that"));
}

TEST_P(Mat, UnitsInNamesHold) {
  const std::string force = b.doubles("force", {1, 2, 3});
  for (const auto& [name, unit, seconds] : {std::tuple{"time_ms", "ms", 1e-3},
                                            {"t_us", "us", 1e-6},
                                            {"t_ns", "ns", 1e-9},
                                            {"time [ms]", "ms", 1e-3},
                                            {"Time_s", "s", 1.0}}) {
    const auto record = imported(b.header() + b.doubles(name, {4, 6, 8}) + force);
    EXPECT_EQ(record.channels[0].unit, unit) << name;
    EXPECT_EQ(record.channels[0].quantity, datasets::Quantity::time) << name;
    EXPECT_DOUBLE_EQ(record.channels[1].clock.start, 4 * seconds) << name;
    EXPECT_DOUBLE_EQ(record.channels[1].clock.interval, 2 * seconds) << name;
    EXPECT_THAT(record.warnings, ElementsAre()) << name;
  }
  const auto fields =
      imported(b.header() + b.structure("run", {"time_ms", "Force [N]"},
                                        b.doubles("", {0, 1, 3}) + b.doubles("", {4, 5, 6})));
  EXPECT_THAT(fields.find("run.Force [N]")->clock.times, ElementsAre(0, 1e-3, 3e-3));
  EXPECT_EQ(fields.find("run.Force [N]")->unit, "N");
  EXPECT_THAT(fields.warnings,
              ElementsAre("'run.time_ms': the samples are not evenly spaced (steps differ from "
                          "their mean of 0.0015 s by up to 0.0005 s): every time is kept"));
  for (const auto& [name, value, seconds] :
       {std::tuple{"dt [us]", 20.0, 2e-5}, {"Fs [kHz]", 4.0, 2.5e-4}})
    EXPECT_DOUBLE_EQ(
        imported(b.header() + force + b.doubles(name, {value})).channels[0].clock.interval,
        seconds);
  // what has another unit is no time
  EXPECT_EQ(imported(b.header() + force + b.doubles("t [N]", {4, 5, 6})).channels[0].clock.interval,
            0.0);
}

TEST_P(Mat, AUnitHoldsForTheOnlyDataBesideIt) {
  const std::string data = b.doubles("", {1, 2, 3});
  const auto unit_with = [&](const std::string& field, const std::string& unit) {
    const auto record = imported(
        b.header() + b.structure("run", {"data", field, "unit"}, data + data + b.text("", unit)));
    return record.channels.at(0).unit;
  };
  EXPECT_EQ(unit_with("t", "N"), "N");
  EXPECT_EQ(unit_with("other", "N"), "") << "of which of both?";
  EXPECT_EQ(unit_with("t", "s"), "") << "of the time";
  EXPECT_EQ(unit_with("t", "bananas"), "");
  const auto record =
      imported(b.header() + b.structure("run", {"dt", "data", "unit"},
                                        b.doubles("", {0.5}) + data + b.text("", "N")));
  EXPECT_EQ(record.find("run.dt")->unit, "");
  EXPECT_EQ(record.find("run.data")->unit, "N");
  EXPECT_EQ(record.find("run.data")->clock.interval, 0.5);
}

TEST_P(Mat, ChannelsOfAMatrixMayBeNamedInACell) {
  std::vector<double> numbers(303);
  for (std::size_t i = 0; i < numbers.size(); ++i)
    numbers[i] = i < 101 ? 0.5 * static_cast<double>(i) : static_cast<double>(i % 7);
  const auto names_by = [&](const std::vector<std::string>& names) {
    std::string cells;
    for (const std::string& name : names) cells += b.text("", name);
    const auto count = static_cast<std::int32_t>(names.size());
    const auto record =
        imported(b.header() + b.structure("shot", {"data", "colheaders"},
                                          b.doubles("", numbers, 3) +
                                              b.matrix(b.head(1, {1, count}, "") + cells)));
    std::string all;
    for (const auto& channel : record.channels) all += channel.name + "[" + channel.unit + "] ";
    return all + std::to_string(record.channels.at(1).clock.interval);
  };
  EXPECT_EQ(names_by({"time (ms)", "Force (N)", "v (m/s)"}),
            "shot.data.time (ms)[ms] shot.data.Force (N)[N] shot.data.v (m/s)[m/s] 0.000500");
  const std::string numbered = "shot.data:1[] shot.data:2[] shot.data:3[] 0.500000";
  EXPECT_EQ(names_by({"time", "force"}), numbered);
  EXPECT_EQ(names_by({"a", "b", "b"}), numbered);
}

// char('time','force','v') and char('ms','kN','m/s') beside the matrix: column after column
TEST_P(Mat, LinesOfTextNameAndMeasureTheColumnsOfAMatrix) {
  std::vector<double> numbers;
  for (int column = 0; column < 3; ++column)
    for (int i = 0; i < 200; ++i) numbers.push_back(column == 0 ? 0.5 * i : i % 7);
  const auto lines = [this](const std::string& name, const std::vector<std::string>& rows) {
    std::string letters;
    for (std::size_t column = 0; column < rows[0].size(); ++column)
      for (const std::string& row : rows) letters += row[column];
    return b.matrix(
        b.head(4,
               {static_cast<std::int32_t>(rows.size()), static_cast<std::int32_t>(rows[0].size())},
               name) +
        b.element(16, letters));
  };
  const auto record =
      imported(b.header() + b.doubles("data", numbers, 3) +
               lines("names", {"time ", "force", "v    "}) + lines("units", {"ms ", "kN ", "m/s"}));
  EXPECT_THAT(names_and_units(record),
              ElementsAre("data.time [ms]", "data.force [kN]", "data.v [m/s]"));
  EXPECT_DOUBLE_EQ(record.channels.at(1).clock.interval, 0.5e-3);
  EXPECT_THAT(record.warnings, ElementsAre());
}

TEST_P(Mat, StatedUnitsReplaceThoseOfNames) {
  const std::string file =
      b.header() + b.doubles("time", {0, 1, 2}) + b.doubles("force [N]", {1, 2, 3});
  ImportOptions options;
  options.units = {"ms", "kN"};
  const auto record = imported(file, options);
  EXPECT_EQ(record.channels[1].unit, "kN");
  EXPECT_EQ(record.channels[1].quantity, datasets::Quantity::force);
  EXPECT_DOUBLE_EQ(record.channels[1].clock.interval, 1e-3);
  EXPECT_THAT(record.warnings, ElementsAre());
  options.units = {"", "", "V"};
  EXPECT_EQ(import_error(file, options), "FILE: 3 units are stated but the file has 2 channels");
  const std::string own = b.header() +
                          b.structure("recording", {"format"}, b.text("", "impactrig-recording")) +
                          b.structure("F", {"name", "unit", "start", "interval", "value"},
                                      b.text("", "F") + b.text("", "N") + b.doubles("", {0}) +
                                          b.doubles("", {1}) + b.doubles("", {5, 6}));
  options.units = {"kN"};
  EXPECT_EQ(imported(own, options).channels.at(0).unit, "kN");
}

TEST_P(Mat, AWindowOfAChannelIsThatPartOfTheWhole) {
  const std::string time = b.doubles("t", {0, 1, 2, 3});
  const std::string values = b.doubles("x", {5, 6, 7, 8});
  ImportOptions options;
  options.channels = {"x"};
  options.from = 1;
  options.to = 2;
  for (const std::string& file :
       {b.header() + time + values, b.header() + b.compressed(time) + values}) {
    const auto part = imported(file, options);
    ASSERT_EQ(part.channels.size(), 1U);
    EXPECT_THAT(part.channels[0].values(), ElementsAre(6, 7));
    EXPECT_EQ(part.channels[0].clock.start, 1.0);
  }
}

TEST_P(Mat, CutFilesGiveWhatIsThere) {
  const std::string whole =
      b.header() + b.doubles("t", {0, 1, 2, 3}) + b.doubles("x", {5, 6, 7, 8});
  const auto record = imported(whole.substr(0, whole.size() - 12));
  EXPECT_THAT(record.channels[1].values(), ElementsAre(5, 6));
  EXPECT_THAT(record.warnings[0], HasSubstr("the file ends within the array that begins at byte "));
  EXPECT_THAT(record.warnings[1], "'x' declares 4 x 1 numbers, 2 are there");
  for (std::size_t size = 128; size < whole.size(); ++size)
    EXPECT_NO_THROW(imported(whole.substr(0, size))) << size;
  const std::string packed = b.header() + b.compressed(b.doubles("x", {5, 6, 7, 8}));
  for (std::size_t size = 128; size < packed.size(); ++size)
    EXPECT_NO_THROW(imported(packed.substr(0, size))) << size;
}

TEST_P(Mat, SizesThatLieChangeNothing) {
  for (const std::int32_t size : {-1, 0x7FFFFFFF, 0}) {
    const auto record = imported(
        b.header() +
        b.matrix(b.head(6, {size, size, size}, "x") + b.element(9, b.numbers<double>({1}))) +
        b.doubles("y", {2}));
    EXPECT_EQ(record.channels.back().name, "y");
  }
  const auto more = imported(b.header() + b.matrix(b.head(6, {1000000, 1000}, "x") +
                                                   b.element(9, b.numbers<double>({1, 2}))));
  EXPECT_THAT(more.channels[0].values(), ElementsAre(1, 2));
}

// As SciPy's tests have it, of another writer.
TEST_P(Mat, SizesMayBeUnsigned) {
  std::string array = b.doubles("x", {5, 6, 7});
  const std::string shape = b.number<std::uint32_t>(5) + b.number<std::uint32_t>(8);
  const std::size_t at = array.find(shape);
  ASSERT_NE(at, array.npos);
  array.replace(at, 4, b.number<std::uint32_t>(6));
  EXPECT_THAT(imported(b.header() + array).channels.at(0).values(), ElementsAre(5, 6, 7));
}

TEST_P(Mat, Version4IsRead) {
  const auto record =
      imported(b.matrix_4(0, 3, 1, "t", b.numbers<double>({0, 1, 2})) +
                   b.matrix_4(10, 3, 1, "f", b.numbers<float>({1.5F, 2, 3})) +
                   b.matrix_4(20, 3, 1, "i", b.numbers<std::int32_t>({-1, 2, 3})) +
                   b.matrix_4(30, 3, 1, "s", b.numbers<std::int16_t>({-1, 2, 3})) +
                   b.matrix_4(40, 3, 1, "u", b.numbers<std::uint16_t>({65535, 2, 3})) +
                   b.matrix_4(50, 3, 1, "b", std::string("\xFF\x02\x03", 3)) +
                   b.matrix_4(0, 1, 2, "z", b.numbers<double>({1, 2, 3, 4}), 1) +
                   b.matrix_4(1, 1, 2, "unit", b.numbers<double>({'N', 'm'})) +
                   b.matrix_4(2, 1, 3, "sp", b.numbers<double>({1, 1, 1})) +
                   b.matrix_4(0, 2, 1, "cut", b.numbers<double>({9})),
               {}, ".mat");
  ASSERT_EQ(record.channels.size(), 8U);
  EXPECT_EQ(record.attributes.at("MAT-file version"), "4");
  EXPECT_THAT(record.channels[1].values(), ElementsAre(1.5, 2, 3));
  EXPECT_THAT(record.channels[2].values(), ElementsAre(-1, 2, 3));
  EXPECT_THAT(record.channels[3].values(), ElementsAre(-1, 2, 3));
  EXPECT_THAT(record.channels[4].values(), ElementsAre(65535, 2, 3));
  EXPECT_THAT(record.channels[5].values(), ElementsAre(255, 2, 3));
  EXPECT_EQ(record.channels[5].clock.interval, 1.0);
  EXPECT_THAT(record.channels[6].values(), ElementsAre(1, 2));
  EXPECT_THAT(record.channels[6].imaginary, ElementsAre(3, 4));
  EXPECT_THAT(record.channels[7].values(), ElementsAre(9));
  EXPECT_EQ(record.attributes.at("unit"), "Nm");
  EXPECT_THAT(record.warnings, Contains("not read: 'sp' (a sparse matrix)"));
}

TEST_P(Mat, ErrorsNameThePlace) {
  std::string other = b.header();
  other.replace(124, 2, b.number<std::uint16_t>(0x0300));
  EXPECT_EQ(import_error(other),
            "FILE (byte 124): version 0x0300 of MAT-files is not known, expected 0x0100");
  ImportOptions options;
  options.time_column = "clock";
  EXPECT_EQ(import_error(b.header() + b.doubles("x", {1, 2}), options),
            "FILE: there is no array 'clock' of real numbers for the time; the arrays are 'x'");
  options = {};
  options.format = "mat";
  EXPECT_EQ(import_error("some text", options),
            "FILE (byte 0): expected the header of a MAT-file: 128 bytes that end with 'IM' or "
            "'MI', or the 20 bytes of version 4");
  EXPECT_EQ(
      import_error(b.matrix_4(b.big_endian ? 3000 - 1000 : 3000, 1, 1, "x", std::string(8, '\0')),
                   options),
      "FILE (byte 0): the numbers are those of a VAX, which are not read: load the file in "
      "MATLAB and save it with -v6");
}

TEST_P(Mat, StructuresNestedWithoutEndAreLeftOut) {
  std::string inner = b.doubles("", {1});
  for (int i = 0; i < 40; ++i) inner = b.structure(i == 39 ? "s" : "", {"f"}, inner);
  EXPECT_THAT(imported(b.header() + inner).warnings[0], HasSubstr("(nested too deeply)"));
}

// Counts were taken for values without a word.
TEST_P(Mat, NumbersCalledScaleAreNotAppliedButToldOf) {
  const std::string raw =
      b.matrix(b.head(10, {3, 1}, "raw") + b.element(3, b.numbers<std::int16_t>({1, 2, 3})));
  const std::string scales = b.doubles("scale", {0.01}) + b.doubles("offset", {0.5});
  EXPECT_THAT(imported(b.header() + raw + scales).warnings,
              Contains(HasSubstr("'raw' holds integers, and 'scale', 'offset' beside it are not")));
  EXPECT_THAT(imported(b.header() + b.doubles("raw", {1, 2, 3}) + scales).warnings,
              testing::Not(Contains(HasSubstr("not applied"))));
}

}  // namespace
}  // namespace impactrig::acquisition
