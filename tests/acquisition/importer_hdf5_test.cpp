// SPDX-License-Identifier: BSD-3-Clause
// HDF5 files of other programs; our own are tested where they are written, in tests/datasets.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <stdexcept>

#include "acquisition/importer.hpp"
#include "tests/acquisition/hdf5_bytes.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using tests::Hdf5File;
using tests::import_error;
using tests::imported;

TEST(ForeignHdf5, DataSetsAreNamedByTheirPaths) {
  const Hdf5File file;
  file.group("/entry");
  file.data<double>("/entry/force", {3}, {1, 2, 3}, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE);
  file.text("/entry/force", "units", "N");
  file.number("/entry/force", "fs", 4.0);
  file.number("/entry/force", "t0", -1.0);
  file.data<double>("/gain", {}, {2.5}, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE);
  file.text("/", "who", "a laboratory", true);
  const auto record = imported(file.bytes());
  EXPECT_EQ(record.provenance.importer, "hdf5");
  ASSERT_EQ(record.channels.size(), 1U);
  const datasets::Channel& force = record.channels[0];
  EXPECT_EQ(force.name, "/entry/force");
  EXPECT_EQ(force.unit, "N");
  EXPECT_EQ(force.quantity, datasets::Quantity::force);
  EXPECT_EQ(force.clock.interval, 0.25);
  EXPECT_EQ(force.clock.start, -1.0);
  EXPECT_THAT(force.values(), ElementsAre(1, 2, 3));
  EXPECT_EQ(record.attributes.at("/gain"), "2.5");
  EXPECT_EQ(record.attributes.at("who"), "a laboratory");
  EXPECT_THAT(record.warnings, ElementsAre());
}

TEST(ForeignHdf5, EveryTypeOfNumberIsRead) {
  const Hdf5File file;
  const std::vector<double> values{100, 2, 3};
  const std::vector<std::pair<std::string, hid_t>> types = {
      {"a", H5T_STD_I8BE},  {"b", H5T_STD_U8LE},   {"c", H5T_STD_I16BE},  {"d", H5T_STD_I16LE},
      {"e", H5T_STD_U16BE}, {"f", H5T_STD_I32LE},  {"g", H5T_STD_U32BE},  {"h", H5T_STD_I64LE},
      {"i", H5T_STD_U64LE}, {"j", H5T_IEEE_F32BE}, {"k", H5T_IEEE_F64BE}, {"l", H5T_IEEE_F64LE}};
  for (const auto& [name, type] : types)
    file.data<double>("/" + name, {3}, values, H5T_NATIVE_DOUBLE, type);
  const auto record = imported(file.bytes());
  ASSERT_EQ(record.channels.size(), types.size());
  for (const datasets::Channel& channel : record.channels)
    EXPECT_THAT(channel.values(), ElementsAre(100, 2, 3)) << channel.name;
  EXPECT_TRUE(std::holds_alternative<std::vector<std::int16_t>>(record.channels[2].raw));
}

// Half precision, 24 bits of a converter, h5py's true and false.
TEST(ForeignHdf5, NumbersOfOtherWidthsAreReadAsTheNextOfOurs) {
  const hid_t half = H5Tcopy(H5T_IEEE_F32LE), bits = H5Tcopy(H5T_STD_I32LE);
  H5Tset_fields(half, 15, 10, 5, 0, 10);
  H5Tset_size(half, 2);
  H5Tset_ebias(half, 15);
  H5Tset_precision(bits, 24);
  const hid_t truth = H5Tenum_create(H5T_STD_I8LE);
  for (const auto& [name, value] : {std::pair{"FALSE", std::int8_t{0}}, {"TRUE", std::int8_t{1}}})
    H5Tenum_insert(truth, name, &value);
  const Hdf5File file;
  file.data<double>("/half", {3}, {0.5, -2.0, 1024.0}, H5T_NATIVE_DOUBLE, half);
  file.data<std::int32_t>("/bits", {2}, {8388607, -5}, H5T_NATIVE_INT32, bits);
  file.data<std::int8_t>("/truth", {3}, {0, 1, 1}, truth, truth);
  file.data<long double>("/long", {2}, {0.25L, -3.0L}, H5T_NATIVE_LDOUBLE, H5T_NATIVE_LDOUBLE);
  for (const hid_t type : {half, bits, truth}) H5Tclose(type);
  const auto record = imported(file.bytes());
  ASSERT_EQ(record.channels.size(), 4U);
  EXPECT_THAT(record.channels[0].values(), ElementsAre(8388607, -5));
  EXPECT_THAT(record.channels[1].values(), ElementsAre(0.5, -2.0, 1024.0));
  EXPECT_TRUE(std::holds_alternative<std::vector<float>>(record.channels[1].raw));
  EXPECT_THAT(record.channels[2].values(), ElementsAre(0.25, -3.0));
  EXPECT_THAT(record.channels[3].values(), ElementsAre(0, 1, 1));
}

// PyTables and pandas write true and false so, of which HDF5 itself makes no numbers.
TEST(ForeignHdf5, BitFieldsAreWhatTheirBitsCount) {
  const Hdf5File file;
  file.data<std::uint8_t>("/hit", {2, 3}, {0, 1, 1, 0, 255, 1}, H5T_NATIVE_B8, H5T_STD_B8LE);
  file.data<std::uint16_t>("/status", {3}, {0x8001, 2, 0xFFFF}, H5T_NATIVE_B16, H5T_STD_B16BE);
  file.data<std::uint64_t>("/wide", {1}, {1}, H5T_NATIVE_B64, H5T_STD_B64LE);

  struct Row {
    double force;
    std::uint8_t hit;
  };

  const hid_t row = H5Tcreate(H5T_COMPOUND, sizeof(Row));
  H5Tinsert(row, "force", offsetof(Row, force), H5T_NATIVE_DOUBLE);
  H5Tinsert(row, "hit", offsetof(Row, hit), H5T_NATIVE_B8);
  file.data<Row>("/table", {3}, {{1.5, 1}, {2.5, 0}, {3.5, 1}}, row, row);
  H5Tclose(row);
  const auto record = imported(file.bytes());
  ASSERT_EQ(record.channels.size(), 5U);
  EXPECT_THAT(record.channels[0].values(), ElementsAre(0, 1, 1));
  EXPECT_THAT(record.channels[1].values(), ElementsAre(0, 255, 1));
  EXPECT_THAT(record.channels[2].values(), ElementsAre(0x8001, 2, 0xFFFF));
  EXPECT_THAT(record.channels[3].values(), ElementsAre(1.5, 2.5, 3.5));
  EXPECT_THAT(record.channels[4].values(), ElementsAre(1, 0, 1));
  EXPECT_THAT(record.warnings, Contains(HasSubstr("'/wide' (of no standard type of numbers)")));
}

TEST(ForeignHdf5, AViewOfOtherDataSetsIsToldSo) {
  const Hdf5File file;
  file.doubles("/force", {1.0, 2.0, 3.0});
  const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
  const hsize_t size = 3;
  const hid_t space = H5Screate_simple(1, &size, nullptr);
  H5Pset_virtual(creation, space, ".", "/force", space);
  H5Dclose(
      H5Dcreate2(file.id(), "/shown", H5T_IEEE_F64LE, space, H5P_DEFAULT, creation, H5P_DEFAULT));
  H5Sclose(space);
  H5Pclose(creation);
  const auto record = imported(file.bytes());
  ASSERT_EQ(record.channels.size(), 1U);
  EXPECT_THAT(record.warnings, Contains(HasSubstr("'/shown' (virtual: a view of other data sets, "
                                                  "which are read where they are)")));
}

/// A data set of 16 numbers of 16 bits in one piece that is packed by these filters, or already is.
void packed(const Hdf5File& file, const char* name, void (*filters)(hid_t creation),
            const std::string& piece = {}) {
  const hsize_t size = 16, none = 0;
  const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_chunk(creation, 1, &size);
  filters(creation);
  const hid_t space = H5Screate_simple(1, &size, nullptr);
  const hid_t set =
      H5Dcreate2(file.id(), name, H5T_STD_I16LE, space, H5P_DEFAULT, creation, H5P_DEFAULT);
  std::vector<std::int16_t> values(size);
  for (std::size_t i = 0; i < size; ++i) values[i] = i % 2 == 0 ? 1 : 2;
  if (piece.empty())
    H5Dwrite(set, H5T_NATIVE_INT16, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  else
    H5Dwrite_chunk(set, H5P_DEFAULT, 0, &none, piece.size(), piece.data());
  H5Dclose(set);
  H5Sclose(space);
  H5Pclose(creation);
}

void set_lzf(hid_t creation) {
  const unsigned values[] = {4, 0x0105, 32};
  H5Pset_filter(creation, 32000, H5Z_FLAG_OPTIONAL, 3, values);
}

TEST(ForeignHdf5, PiecesPackedByHdf5OrH5pyAreRead) {
  const Hdf5File file;
  packed(file, "/a", [](hid_t creation) { H5Pset_nbit(creation); });
  packed(file, "/b", [](hid_t creation) { H5Pset_scaleoffset(creation, H5Z_SO_INT, 0); });
  // four bytes as they are, then 28 that repeat what is four bytes back
  packed(file, "/c", set_lzf, std::string("\x03\x01\x00\x02\x00\xE0\x13\x03", 8));
  const auto record = imported(file.bytes());
  ASSERT_EQ(record.channels.size(), 3U);
  for (const datasets::Channel& channel : record.channels)
    EXPECT_THAT(channel.values(), ElementsAre(1, 2, 1, 2, 1, 2, 1, 2, 1, 2, 1, 2, 1, 2, 1, 2))
        << channel.name;
}

TEST(ForeignHdf5, DamagedLzfPiecesAreNamed) {
  for (const std::string& piece :
       {std::string("\x1F\x01", 2),                             // fewer bytes than it says
        std::string("\x00\x01\x20\x05", 4),                     // from before its beginning
        std::string("\x00\x01\xE0", 3),                         // cut
        std::string("\x03\x01\x00\x02\x00\xE0\xFF\x03", 8)}) {  // more than there is room for
    const Hdf5File file;
    packed(file, "/c", set_lzf, piece);
    file.number("/", "sample_rate", 1000.0);
    EXPECT_THAT(import_error(file.bytes()), HasSubstr("is damaged: /c cannot be read"));
  }
}

TEST(ForeignHdf5, TablesAreColumnsAlongTheirLongerSide) {
  std::vector<std::int16_t> values(600);
  std::iota(values.begin(), values.end(), std::int16_t{0});
  const Hdf5File file;
  file.data<std::int16_t>("/rows", {300, 2}, values, H5T_NATIVE_INT16, H5T_STD_I16LE, {64, 2});
  file.data<std::int16_t>("/columns", {2, 300}, values, H5T_NATIVE_INT16, H5T_STD_I16LE);
  file.number("/", "sample_rate", 1000.0);
  ImportOptions options;
  options.from = 0.298;
  const auto record = imported(file.bytes(), options);
  ASSERT_EQ(record.channels.size(), 4U);
  EXPECT_EQ(record.channels[1].name, "/columns:2");
  EXPECT_THAT(record.channels[1].values(), ElementsAre(598, 599));
  EXPECT_EQ(record.channels[2].name, "/rows:1");
  EXPECT_THAT(record.channels[2].values(), ElementsAre(596, 598));
  EXPECT_EQ(record.channels[2].clock.start, 0.298);
  EXPECT_THAT(record.warnings, IsEmpty());
  options.channels = {"/rows:2"};
  options.to = 0.298;
  EXPECT_THAT(imported(file.bytes(), options).channels[0].values(), ElementsAre(597));
}

TEST(ForeignHdf5, AxesOfNexusAndNamesGiveTheTime) {
  const Hdf5File file;
  file.group("/entry");
  file.text("/entry", "axes", "clock", true);
  file.doubles("/entry/clock", {0, 500, 1000});
  file.text("/entry/clock", "units", "ms", true);
  file.doubles("/entry/force", {1, 2, 3});
  file.group("/uneven");
  file.doubles("/uneven/time", {0, 1, 3, 4});
  file.doubles("/uneven/x", {5, 6, 7, 8});
  ImportOptions options;
  options.from = 1;
  const auto record = imported(file.bytes(), options);
  ASSERT_EQ(record.channels.size(), 4U);
  EXPECT_EQ(record.channels[1].clock.interval, 0.5);
  EXPECT_THAT(record.channels[1].values(), ElementsAre(3));
  EXPECT_THAT(record.channels[3].clock.times, ElementsAre(1, 3, 4));
  EXPECT_THAT(record.channels[3].values(), ElementsAre(6, 7, 8));
  EXPECT_EQ(record.attributes.at("time column"),
            "/entry/clock (as the file says); /uneven/time (by its name)");
}

TEST(ForeignHdf5, LinksAndLoopsAreNotFollowed) {
  const Hdf5File file;
  file.group("/a");
  file.doubles("/a/x", {1});
  H5Lcreate_hard(file.id(), "/", file.id(), "/a/loop", H5P_DEFAULT, H5P_DEFAULT);
  H5Lcreate_soft("/a", file.id(), "/soft", H5P_DEFAULT, H5P_DEFAULT);
  H5Lcreate_external("other.h5", "/x", file.id(), "/outside", H5P_DEFAULT, H5P_DEFAULT);
  std::string deep = "/d";
  for (int i = 0; i < 30; ++i) {
    file.group(deep);
    deep += "/d";
  }
  const auto record = imported(file.bytes());
  ASSERT_EQ(record.channels.size(), 1U);
  EXPECT_THAT(record.warnings[0], HasSubstr("'/a/loop' (a group that is listed already)"));
  EXPECT_THAT(record.warnings[0], HasSubstr("(nested too deeply)"));
  EXPECT_THAT(record.warnings[0], HasSubstr("'/outside' (a link into another file)"));
  EXPECT_EQ(record.channels[0].attributes.at("linked as"), "/soft/x");
}

TEST(ForeignHdf5, ChannelsHaveTheNamesOfSoftLinksToo) {
  const Hdf5File file;
  file.group("/raw");
  file.doubles("/raw/ch0", {1, 2, 3});
  file.doubles("/raw/ch1", {0, 0.5, 1});
  file.group("/data");
  file.text("/data", "axes", "when");
  const auto link = [&file](const char* from, const char* to) {
    H5Lcreate_soft(to, file.id(), from, H5P_DEFAULT, H5P_DEFAULT);
  };
  link("/force", "raw/ch0");
  link("/data/when", "/raw/ch1");
  link("/data/force", "/raw/ch0");
  link("/nowhere", "/gone");
  const auto record = imported(file.bytes());
  ASSERT_EQ(record.channels.size(), 2U);
  EXPECT_EQ(record.channels[0].name, "/raw/ch0");
  EXPECT_EQ(record.channels[0].attributes.at("linked as"), "/data/force | /force");
  EXPECT_EQ(record.find("/force"), &record.channels[0]);
  EXPECT_EQ(record.channels[0].clock.interval, 0.5);  // by the axis of the group of links
  EXPECT_THAT(record.warnings, testing::Contains("not read: '/nowhere' (a link to '/gone')"));
  ImportOptions options;
  options.channels = {"/force"};
  EXPECT_THAT(imported(file.bytes(), options).channels.at(0).values(), ElementsAre(1, 2, 3));
}

// NeXus writes its links so.
TEST(ForeignHdf5, ADataSetOfTwoHardLinksIsOneChannel) {
  const Hdf5File file;
  const auto link = [&file](const char* from, const char* to) {
    H5Lcreate_hard(file.id(), to, file.id(), from, H5P_DEFAULT, H5P_DEFAULT);
  };
  file.group("/a");
  file.doubles("/a/force", {1, 2, 3});
  file.doubles("/a/time", {0, 0.5, 1});
  file.data<double>("/a/table", {3, 2}, {1, 2, 3, 4, 5, 6}, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE);
  file.group("/b");
  file.doubles("/b/force", {4, 5, 6});
  file.data<double>("/b/gain", {}, {7}, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE);
  link("/b/time", "/a/time");
  link("/b/hammer", "/a/force");
  link("/b/table", "/a/table");
  link("/gain", "/b/gain");
  const auto record = imported(file.bytes());
  std::vector<std::string> names;
  for (const auto& channel : record.channels) {
    names.push_back(channel.name);
    EXPECT_EQ(channel.clock.interval, 0.5) << channel.name;  // of both groups
  }
  EXPECT_THAT(names, ElementsAre("/a/force", "/a/table:1", "/a/table:2", "/a/time", "/b/force"));
  EXPECT_EQ(record.channels[0].attributes.at("linked as"), "/b/hammer");
  EXPECT_EQ(record.attributes.at("time column"), "/a/time (by its name)");
  EXPECT_EQ(record.attributes.at("/b/gain"), "7");
  EXPECT_EQ(record.attributes.at("/gain"), "7");
  for (const std::string& warning : record.warnings)
    EXPECT_THAT(warning, testing::Not(HasSubstr("not read")));
  ImportOptions options;
  options.channels = {"/b/hammer"};
  EXPECT_THAT(imported(file.bytes(), options).channels.at(0).values(), ElementsAre(1, 2, 3));
}

TEST(ForeignHdf5, WhatIsNotReadIsNamed) {
  const Hdf5File file;
  const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
  const hsize_t size = 1000000;
  H5Pset_chunk(creation, 1, &size);
  H5Pset_filter(creation, 305, H5Z_FLAG_OPTIONAL, 0, nullptr);
  const hid_t space = H5Screate_simple(1, &size, nullptr);
  H5Dclose(
      H5Dcreate2(file.id(), "/alien", H5T_STD_I16LE, space, H5P_DEFAULT, creation, H5P_DEFAULT));
  H5Pclose(creation);
  H5Dclose(H5Dcreate2(file.id(), "/unwritten", H5T_STD_I16LE, space, H5P_DEFAULT, H5P_DEFAULT,
                      H5P_DEFAULT));
  H5Dclose(H5Dcreate2(file.id(), "/reference", H5T_STD_REF_OBJ, space, H5P_DEFAULT, H5P_DEFAULT,
                      H5P_DEFAULT));
  H5Sclose(space);
  file.references("/written", {1}, {"/alien"});
  const auto record = imported(file.bytes());
  EXPECT_EQ(record.channels.size(), 0U);
  EXPECT_EQ(record.warnings[0],
            "not read: '/alien' (packed by filter 305; HDF5's own and lzf are read: h5repack -f "
            "GZIP=1 rewrites it), '/reference' (it declares 8000000 bytes and holds 0), "
            "'/unwritten' (it declares 2000000 bytes and holds 0), '/written' (references)");
  EXPECT_EQ(record.warnings[1], "there are no data sets of numbers: there are no channels");
}

TEST(ForeignHdf5, ThreeDimensionsAreAChannelForEachPlaceBesideTheTime) {
  const Hdf5File file;
  std::vector<std::int16_t> numbers(2 * 3 * 8);
  std::iota(numbers.begin(), numbers.end(), std::int16_t{0});
  file.data<std::int16_t>("/cube", {2, 3, 8}, numbers, H5T_NATIVE_INT16, H5T_STD_I16LE, {1, 2, 4});
  file.number("/cube", "dt", 0.5);
  const auto record = imported(file.bytes(), {}, ".h5");
  ASSERT_EQ(record.channels.size(), 6U);
  EXPECT_EQ(record.channels[1].name, "/cube:1,2");
  EXPECT_EQ(record.channels[5].name, "/cube:2,3");
  EXPECT_THAT(record.channels[1].values(), ElementsAre(8, 9, 10, 11, 12, 13, 14, 15));
  EXPECT_THAT(record.channels[5].values(), ElementsAre(40, 41, 42, 43, 44, 45, 46, 47));
  EXPECT_EQ(record.channels[5].clock.interval, 0.5);
  EXPECT_THAT(
      record.warnings,
      ElementsAre("'/cube': of its 2 x 3 x 8 numbers dimension 3 is taken for the time; the "
                  "places in the others name the channels"));
  ImportOptions one;
  one.channels = {"/cube:2,1"};
  EXPECT_THAT(imported(file.bytes(), one, ".h5").channels.at(0).values(),
              ElementsAre(24, 25, 26, 27, 28, 29, 30, 31));
}

TEST(ForeignHdf5, TheScaleOfADimensionTellsTheTimeOfThree) {
  const Hdf5File file;
  file.doubles("/t", {0, 0.5});
  file.text("/t", "units", "s");
  file.scale("/t");
  std::vector<double> numbers(2 * 3);
  std::iota(numbers.begin(), numbers.end(), 0.0);
  file.data<double>("/cube", {1, 2, 3}, numbers, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE);
  file.scales("/cube", {"", "/t", ""});
  const auto record = imported(file.bytes(), {}, ".h5");
  ASSERT_EQ(record.channels.size(), 4U);
  EXPECT_EQ(record.channels[1].name, "/cube:1,2");
  EXPECT_THAT(record.channels[1].values(), ElementsAre(1, 4));
  EXPECT_EQ(record.channels[1].clock.interval, 0.5);
}

TEST(ForeignHdf5, WhatMayBeAnyOfThreeDimensionsIsNotRead) {
  const Hdf5File file;
  file.data<double>("/cube", {2, 2, 1}, {1, 2, 3, 4}, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE);
  file.data<float>("/film", {40, 40, 50}, std::vector<float>(80000), H5T_NATIVE_FLOAT,
                   H5T_IEEE_F32LE);
  const auto record = imported(file.bytes(), {}, ".h5");
  EXPECT_EQ(record.channels.size(), 0U);
  EXPECT_EQ(record.warnings.at(0),
            "not read: '/cube' (2 x 2 x 1 numbers, of which no scale of a dimension says which one "
            "is the time; write it as data sets of two dimensions), '/film' (40 x 40 x 50 numbers: "
            "more than 1000 columns; write those you need as data sets of two dimensions)");
}

TEST(ForeignHdf5, ComplexNumbersArePairs) {
  const Hdf5File file;
  const hid_t pair = H5Tcreate(H5T_COMPOUND, 16);
  H5Tinsert(pair, "real", 0, H5T_IEEE_F64LE);
  H5Tinsert(pair, "imag", 8, H5T_IEEE_F64LE);
  file.data<double>("/z", {2}, {1, 2, 3, 4}, pair, pair);
  H5Tclose(pair);
  const auto record = imported(file.bytes());
  EXPECT_THAT(record.channels[0].values(), ElementsAre(1, 3));
  EXPECT_THAT(record.channels[0].imaginary, ElementsAre(2, 4));
}

TEST(ForeignHdf5, ErrorsSayWhatWasFound) {
  ImportOptions options;
  options.format = "hdf5";
  EXPECT_EQ(import_error("some text", options),
            "FILE (byte 0): expected the signature of HDF5 at byte 0, 512, 1024, ...");
  const Hdf5File file;
  file.doubles("/x", std::vector<double>(1000, 1.0));
  const std::string whole = file.bytes();
  EXPECT_EQ(import_error(whole.substr(0, whole.size() / 2)),
            "FILE: HDF5 cannot open it: it is damaged or cut");
  options.time_column = "clock";
  EXPECT_EQ(import_error(whole, options),
            "FILE: there is no array 'clock' of real numbers for the time; the arrays are '/x'");
}

/// A file whose one data set is a compressed piece that zlib cannot undo.
std::string with_damaged_piece(const std::string& name) {
  const Hdf5File file;
  std::vector<double> values(4096);
  std::iota(values.begin(), values.end(), 0.0);
  file.data<double>(name, {4096}, values, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE, {4096});
  file.number(name, "dt", 1.0);
  std::string bytes = file.bytes();
  // the piece is what is compressed: its first two bytes are zlib's
  const std::size_t piece = bytes.find("\x78\x9c", 2048);
  if (piece == std::string::npos) throw std::logic_error("no compressed piece");
  for (std::size_t i = 2; i < 400; ++i) bytes[piece + i] = '\x55';
  return bytes;
}

TEST(ForeignHdf5, DamagedPiecesAreNamed) {
  EXPECT_EQ(import_error(with_damaged_piece("/x")), "FILE: is damaged: /x cannot be read");
}

// The reader keeps names as the file has them, to find the data again; what it says is UTF-8.
TEST(ForeignHdf5, DamagedPiecesAreNamedInUtf8) {
  EXPECT_EQ(import_error(with_damaged_piece("/\xFFx")), "FILE: is damaged: /ÿx cannot be read");
}

}  // namespace
}  // namespace impactrig::acquisition
