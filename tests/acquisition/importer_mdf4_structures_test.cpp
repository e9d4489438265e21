// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <cstdint>
#include <string>
#include <vector>

#include "datasets/input_error.hpp"
#include "tests/acquisition/mdf4_bytes.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using tests::imported;
using tests::mdf_channel;
using tests::MdfChannelBlock;
using tests::MdfFile;

// Two records of eight bytes, 0 to 7 and 8 to 15.
datasets::Record of_bytes(MdfFile& file, const std::vector<MdfChannelBlock>& channels,
                          std::uint32_t invalid_bytes = 0) {
  std::string records;
  for (char i = 0; i < 16; ++i) records += i;
  const std::uint64_t group =
      file.group(file.channels(channels), 16 / (8 + invalid_bytes), 8, invalid_bytes);
  return imported(file.with(file.data_group(group, file.block("DT", {}, records))));
}

std::vector<std::string> names_of(const datasets::Record& record) {
  std::vector<std::string> names;
  for (const datasets::Channel& channel : record.channels) names.push_back(channel.name);
  return names;
}

TEST(Mdf4Structures, AreReadMemberByMember) {
  MdfFile file;
  MdfChannelBlock inner = mdf_channel("s.inner", 10, 16, 4);
  inner.composition = file.channels({mdf_channel("deep", 0, 8, 5)});
  MdfChannelBlock structure = mdf_channel("s", 10, 64, 0);
  MdfChannelBlock text = mdf_channel("s.text", 6, 8, 1);
  structure.composition =
      file.channels({mdf_channel("s.a", 0, 8, 2), mdf_channel("b", 0, 8, 3), text, inner});
  const auto record = of_bytes(file, {structure, mdf_channel("z", 0, 8, 7)});
  EXPECT_THAT(names_of(record), ElementsAre("s.a", "s.b", "s.inner.deep", "z"));
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(2, 10));
  EXPECT_THAT(record.channels.at(1).values(), ElementsAre(3, 11));
  EXPECT_THAT(record.channels.at(2).values(), ElementsAre(5, 13));
  EXPECT_EQ(record.warnings.at(0),
            "1 channel of texts, byte arrays or record numbers is left out: 's.text'");
}

TEST(Mdf4Structures, MayBeAWordAndItsBits) {
  MdfFile file;
  MdfChannelBlock word = mdf_channel("status", 0, 8, 6);
  word.composition =
      file.channels({mdf_channel("status.odd", 0, 1, 6), mdf_channel("two", 0, 1, 6, 1)});
  const auto record = of_bytes(file, {word});
  EXPECT_THAT(names_of(record), ElementsAre("status", "status.odd", "status.two"));
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(6, 14));
  EXPECT_THAT(record.channels.at(1).values(), ElementsAre(0, 0));
  EXPECT_THAT(record.channels.at(2).values(), ElementsAre(1, 1));
}

TEST(Mdf4Arrays, AreReadElementByElement) {
  MdfFile file;
  MdfChannelBlock row = mdf_channel("row", 0, 8, 1);
  row.composition = file.array({3}, 2);
  MdfChannelBlock matrix = mdf_channel("m", 0, 8, 0);
  matrix.composition = file.array({2, 3}, 1);
  MdfChannelBlock columns = mdf_channel("c", 0, 8, 0);
  columns.composition = file.array({2, 3}, 1, 0, 0x40);
  MdfChannelBlock nested = mdf_channel("n", 0, 8, 0);
  nested.composition = file.array({2}, 4, 0, 0, file.array({2}, 1));
  const auto record = of_bytes(file, {row, matrix, columns, nested});
  const auto first = [&](const std::string& name) {
    const datasets::Channel* const channel = record.find(name);
    return channel == nullptr ? -1.0 : channel->value(0);
  };
  EXPECT_EQ(record.channels.size(), 3U + 6 + 6 + 4);
  EXPECT_THAT(record.channels.at(2).values(), ElementsAre(5, 13));
  EXPECT_EQ(first("row[0]"), 1);
  EXPECT_EQ(first("row[2]"), 5);
  EXPECT_EQ(first("m[0][2]"), 2);
  EXPECT_EQ(first("m[1][0]"), 3);
  EXPECT_EQ(first("c[0][2]"), 4);
  EXPECT_EQ(first("c[1][0]"), 1);
  EXPECT_EQ(first("n[0][1]"), 1);
  EXPECT_EQ(first("n[1][0]"), 4);
}

TEST(Mdf4Arrays, OfStructuresAreReadMemberByMember) {
  MdfFile file;
  MdfChannelBlock structures = mdf_channel("s", 10, 32, 0);
  structures.composition = file.array(
      {2}, 4, 0, 0, file.channels({mdf_channel("s.a", 0, 8, 1), mdf_channel("b", 0, 16, 2)}));
  const auto record = of_bytes(file, {structures});
  EXPECT_THAT(names_of(record), ElementsAre("s[0].a", "s[0].b", "s[1].a", "s[1].b"));
  EXPECT_EQ(record.channels.at(2).value(0), 5);
  EXPECT_EQ(record.channels.at(3).value(0), 6 + 256 * 7);
}

TEST(Mdf4Arrays, HaveAnInvalidationBitAnElement) {
  MdfFile file;
  MdfChannelBlock row = mdf_channel("row", 0, 8, 0);
  row.flags = 2;
  row.invalid_bit = 1;
  row.composition = file.array({3}, 1, 1);
  const auto record = of_bytes(file, {row}, 8);    // one record; its invalidation bytes are 8 to 15
  EXPECT_TRUE(record.channels.at(0).is_valid(0));  // bits 1 to 3 of 8
  EXPECT_TRUE(record.channels.at(1).is_valid(0));
  EXPECT_FALSE(record.channels.at(2).is_valid(0));
}

TEST(Mdf4Arrays, WhoseElementsAreNotToldApartAreLeftOut) {
  const auto told = [](const auto& array) {
    MdfFile file;
    MdfChannelBlock row = mdf_channel("row", 0, 8, 0);
    row.composition = array(file);
    const auto record = of_bytes(file, {row, mdf_channel("z", 0, 8, 7)});
    EXPECT_THAT(names_of(record), ElementsAre("z"));
    return record.warnings.at(0);
  };
  const std::string begin = "'row' is left out: ";
  EXPECT_EQ(told([](MdfFile& f) { return f.array({1001}, 0); }),
            begin + "its array has no elements, or more than 1000");
  EXPECT_EQ(told([](MdfFile& f) { return f.array({0}, 1); }),
            begin + "its array has no elements, or more than 1000");
  EXPECT_EQ(told([](MdfFile& f) { return f.array({40}, 0, 0, 0, f.array({40}, 0)); }),
            begin + "its array has no elements, or more than 1000");
  EXPECT_EQ(told([](MdfFile& f) { return f.array({2}, 1, 0, 1); }),
            begin + "its array has another size from record to record");
  EXPECT_EQ(told([](MdfFile& f) { return f.array({2}, 1, 0, 0, 0, 2); }),
            begin + "the elements of its array lie in other groups");
}

TEST(Mdf4Arrays, OutsideOfTheRecordsAreErrors) {
  const auto failure = [](const auto& change) {
    MdfFile file;
    MdfChannelBlock row = mdf_channel("row", 0, 8, 4);
    change(file, row);
    try {
      of_bytes(file, {row});
    } catch (const datasets::InputError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(failure([](MdfFile& f, MdfChannelBlock& c) { c.composition = f.array({5}, 1); }),
              HasSubstr("'row[4]' lies in bytes 8 to 8 of records that have 8"));
  EXPECT_THAT(failure([](MdfFile& f, MdfChannelBlock& c) { c.composition = f.array({6}, -1); }),
              HasSubstr("'row[5]' lies in bytes -1 to -1 of records that have 8"));
  EXPECT_THAT(failure([](MdfFile& f, MdfChannelBlock& c) { c.composition = f.text("a"); }),
              HasSubstr("expected an array (CA) or channels (CN), found a block TX"));
}

}  // namespace
}  // namespace impactrig::acquisition
