// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

#include "tests/acquisition/mdf4_bytes.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using tests::bytes_of_number;
using tests::import_error;
using tests::imported;
using tests::mdf_channel;
using tests::mdf_file_of;
using tests::MdfChannelBlock;
using tests::MdfFile;

std::string error_in(const std::string& bytes) {
  ImportOptions options;
  options.require_clock = false;
  const std::string error = import_error(bytes, options);
  const std::size_t colon = error.find("): ");
  return colon == std::string::npos ? error : error.substr(colon + 3);
}

std::string data_error(const std::function<std::uint64_t(MdfFile&)>& data) {
  MdfFile file;
  const std::uint64_t at = data(file);
  const std::uint64_t group = file.group(file.channels({mdf_channel("a", 0, 8, 0)}), 8, 1);
  return error_in(file.with(file.data_group(group, at)));
}

TEST(Mdf4Errors, OfDataSayWhatWasFound) {
  EXPECT_EQ(data_error([](MdfFile& f) { return f.compressed("12345678", 0, 9); }),
            "the compressed data are damaged, or are not the 9 bytes announced");
  EXPECT_EQ(data_error([](MdfFile& f) { return f.compressed("12345678", 0, 7); }),
            "the compressed data are damaged, or are not the 7 bytes announced");
  EXPECT_EQ(data_error([](MdfFile& f) { return f.compressed("12345678", 0, 20000000); }),
            "a compressed block of 19 bytes announces 20000000 bytes: it is refused");
  EXPECT_EQ(
      data_error([](MdfFile& f) { return f.compressed(std::string(70000, 'x'), 0, 67108865); }),
      "a compressed block of 70016 bytes announces 67108865 bytes: it is refused");
  EXPECT_EQ(data_error([](MdfFile& f) { return f.compressed("12345678", 0, 0, 2); }),
            "the data are compressed by method 2, which is not read: save the file with deflate or "
            "uncompressed");
  EXPECT_EQ(data_error([](MdfFile& f) {
              return f.block("DZ", {}, std::string("SD") + std::string(22, '\0'));
            }),
            "expected compressed records (DT), found a compressed block SD");
  EXPECT_EQ(
      data_error([](MdfFile& f) { return f.block("DV", {}, "12345678"); }),
      "the data are stored by columns (MDF 4.2), which is not read: save the file as MDF 4.1 with "
      "the program that wrote it");
  EXPECT_EQ(data_error([](MdfFile& f) { return f.text("12345678"); }),
            "expected a block of data (DT, DZ, DL, HL), found a block TX");
  EXPECT_EQ(data_error([](MdfFile& f) {
              const std::uint64_t data = f.block("DT", {}, "1234");
              return f.list({data, data});
            }),
            "a block of data is referred to twice: blocks are chained in a circle");
}

TEST(Mdf4Errors, OfBlocksSayWhatWasFound) {
  ImportOptions mdf;
  mdf.format = "mdf4";
  EXPECT_EQ(import_error("not an MDF file at all", mdf),
            "FILE (byte 0): expected 'MDF' at the start, found 'not an M'");
  EXPECT_EQ(import_error(MdfFile("3.30    ").with(0), mdf),
            "FILE (byte 8): this is MDF version 3.30, which is not read: save it as MDF 4 with the "
            "program "
            "that wrote it");
  EXPECT_EQ(import_error(MdfFile().with(0).substr(0, 70)),
            "FILE (byte 70): the file ends within the header of an MDF file");
  MdfFile file;
  const std::uint64_t text = file.text("text");
  EXPECT_EQ(error_in(file.with(text)), "expected a data group (DG), found a block TX");
  EXPECT_EQ(error_in(file.with(8)), "expected a data group, found '4.10'");
  EXPECT_EQ(error_in(file.with(64)),
            "a data group is referred to twice: blocks are chained in a circle");
  const std::uint64_t loop = file.data_group(0, 0);
  file.put(loop + 24, bytes_of_number(loop));
  EXPECT_EQ(error_in(file.with(loop)),
            "a data group is referred to twice: blocks are chained in a circle");
  MdfFile lying;
  const std::uint64_t group = lying.data_group(0, 0);
  lying.put(group + 16, bytes_of_number(~std::uint64_t{0}));
  EXPECT_EQ(error_in(lying.with(group)), "a block DG of 64 bytes with 18446744073709551615 links");
  lying.put(group + 8, bytes_of_number(~std::uint64_t{0}));
  lying.put(group + 16, bytes_of_number(std::uint64_t{1} << 60));
  EXPECT_EQ(error_in(lying.with(group)), "the file ends within a data group");
}

TEST(Mdf4Errors, NumbersOfNoTypeCostTheirChannelAlone) {
  const std::string records(20, '\1');
  const auto record = imported(mdf_file_of({mdf_channel("a", 0, 65, 0), mdf_channel("b", 4, 24, 0),
                                            mdf_channel("c", 15, 33, 0), mdf_channel("d", 0, 8, 9)},
                                           records, 10));
  ASSERT_EQ(record.channels.size(), 1U);
  EXPECT_EQ(record.channels[0].name, "d");
  EXPECT_THAT(record.channels[0].values(), testing::ElementsAre(1, 1));
  const auto out = [](const std::string& name, int type, int bits) {
    return fmt::format(
        "'{}' is left out: it has numbers of type {} with {} bits from bit 0 on, which are not "
        "read",
        name, type, bits);
  };
  EXPECT_THAT(record.warnings,
              testing::IsSupersetOf({out("a", 0, 65), out("b", 4, 24), out("c", 15, 33)}));
}

TEST(Mdf4Errors, OfChannelsNameThem) {
  EXPECT_EQ(error_in(mdf_file_of({mdf_channel("a", 0, 16, 1)}, "1234", 2)),
            "'a' lies in bytes 1 to 2 of records that have 2");
  MdfChannelBlock flagged = mdf_channel("a", 0, 8, 0);
  flagged.flags = 2;
  flagged.invalid_bit = 8;
  EXPECT_EQ(error_in(mdf_file_of({flagged}, "1234", 1)),
            "the invalidation bit 8 of 'a' lies outside of the records");
  EXPECT_EQ(error_in(mdf_file_of({}, "1", 0x2000000)),
            "a channel group has records of 33554432 bytes");
  MdfFile file;
  MdfChannelBlock channel = mdf_channel("a", 0, 8, 0);
  channel.conversion = file.text("x");
  EXPECT_EQ(error_in(file.with(file.data_group(file.group(file.channels({channel}), 1, 1), 0))),
            "expected a conversion (CC), found a block TX");
  channel.conversion = file.conversion(1, {1});
  EXPECT_EQ(error_in(file.with(file.data_group(file.group(file.channels({channel}), 1, 1), 0))),
            "a conversion of type 1 states 1 parameters");
}

}  // namespace
}  // namespace impactrig::acquisition
