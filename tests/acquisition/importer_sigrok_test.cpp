// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "acquisition/importer.hpp"
#include "tests/acquisition/sigrok_bytes.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using tests::import_error;
using tests::imported;
using tests::little;
using tests::sigrok_entries;
using tests::zip_archive;
using tests::ZipEntry;

const std::string no_units =
    "a sigrok session holds no units of its analog channels: --units states them";

TEST(Sigrok, PartsOfAChannelFollowTheirNumbers) {
  for (const bool packed : {false, true}) {
    const auto record = imported(zip_archive(sigrok_entries(packed)), {}, ".sr");
    EXPECT_EQ(record.provenance.importer, "sigrok");
    ASSERT_EQ(record.channels.size(), 2U);
    EXPECT_EQ(record.channels[0].name, "A0");
    EXPECT_THAT(record.channels[0].values(), ElementsAre(1.5, 2, 3, 4));
    EXPECT_EQ(record.channels[0].clock.interval, 1.0 / 200000.0);
    EXPECT_EQ(record.channels[1].name, "A1");
    EXPECT_THAT(record.channels[1].values(), ElementsAre(7, 8, 9, 10));
    EXPECT_THAT(record.warnings, ElementsAre(no_units));
    EXPECT_EQ(record.attributes.at("sigrok version"), "0.5.2");
  }
}

TEST(Sigrok, AWindowOfAChannelIsThatPartOfTheWhole) {
  ImportOptions options;
  options.channels = {"A0"};
  options.from = 2.0 / 200000.0;
  options.units = {"V", ""};
  const auto part = imported(zip_archive(sigrok_entries(true)), options);
  ASSERT_EQ(part.channels.size(), 1U);
  EXPECT_THAT(part.channels[0].values(), ElementsAre(3, 4));
  EXPECT_EQ(part.channels[0].clock.start, 2.0 / 200000.0);
  EXPECT_EQ(part.channels[0].unit, "V");
  EXPECT_THAT(part.warnings, ElementsAre());
}

TEST(Sigrok, LogicChannelsAreLeftOut) {
  std::vector<ZipEntry> entries = sigrok_entries(false);
  entries.push_back({"logic-1-1", "\1\2"});
  EXPECT_EQ(imported(zip_archive(entries)).warnings[0],
            "the session has logic channels too: they are left out");
  const auto record =
      imported(zip_archive({{"version", "2"}, {"metadata", ""}, {"logic-1-1", "\1\2"}}));
  EXPECT_EQ(record.channels.size(), 0U);
  EXPECT_EQ(record.warnings[1], "there are no analog channels in this session");
}

TEST(Sigrok, WhatIsOddIsTold) {
  const auto record = imported(zip_archive({{"version", "2"},
                                            {"metadata", "[device 1]\nsamplerate=fast\n"},
                                            {"analog-1-3-2", little<float>({1}) + "x"},
                                            {"analog-2-3-1", little<float>({5, 6})}}));
  ASSERT_EQ(record.channels.size(), 2U);
  EXPECT_EQ(record.channels[0].name, "analog 3");
  EXPECT_EQ(record.channels[0].clock.interval, 0.0);
  EXPECT_EQ(record.channels[1].attributes.at("device"), "2");
  EXPECT_THAT(
      record.warnings,
      ElementsAre(
          "analog-1-3-2 has 5 bytes, no multiple of 4: the last ones are left out",
          "'analog 3': part 1 is not there once: what follows is out of time", no_units,
          "2 channels are called 'analog 3': the name means the first of them, an index any "
          "other",
          "'analog 3' has neither times nor a sample rate: state it with "
          "--sample-rate, or the column with --time-column"));
}

TEST(Sigrok, ErrorsSayWhatWasFound) {
  ImportOptions options;
  options.format = "sigrok";
  EXPECT_EQ(import_error("PK", options), "FILE: the ZIP archive cannot be read: Not a zip archive");
  const std::string whole = zip_archive(sigrok_entries(true));
  EXPECT_EQ(import_error(whole.substr(0, whole.size() / 2)),
            "FILE: the ZIP archive ends before its list of entries: it is cut off; copy it again");
  EXPECT_EQ(import_error(zip_archive({{"other", "2"}}), options),
            "FILE: the archive has no 'version': it is no sigrok session");
  EXPECT_EQ(import_error(zip_archive({{"version", "3"}, {"metadata", ""}}), options),
            "FILE: the session is of version '3', expected 1 or 2");
  EXPECT_EQ(import_error(zip_archive({{"version", "2"}}), options),
            "FILE: the archive has no 'metadata': it is no sigrok session");
  std::vector<ZipEntry> entries = sigrok_entries(true);
  entries[1].content.resize(2U << 20, '\n');
  EXPECT_EQ(import_error(zip_archive(entries)),
            "FILE: 'metadata' has 2097152 bytes, at most 1048576 are expected");
  entries = sigrok_entries(false);
  entries[2].method = 14;
  EXPECT_EQ(import_error(zip_archive(entries)),
            "FILE: analog-1-2-1 is packed by method 14, expected 0 (stored) or 8 (deflated)");
  entries = sigrok_entries(false);
  entries[2].flags = 1;
  EXPECT_EQ(import_error(zip_archive(entries)),
            "FILE: analog-1-2-1 is encrypted: unpack the archive and pack it without");
  entries = sigrok_entries(true);
  std::string bytes = zip_archive(entries);
  bytes[bytes.find("analog-1-2-1") + 14] ^= 0x55;
  EXPECT_THAT(import_error(bytes), HasSubstr("FILE: part 1 of 'A1' cannot be read: "));
}

TEST(Sigrok, SizesThatLieAreRefused) {
  std::vector<ZipEntry> entries = sigrok_entries(true);
  entries[2].declared_size = 0xFFFFFFF0;
  EXPECT_EQ(import_error(zip_archive(entries)),
            fmt::format("FILE: analog-1-2-1 declares 4294967280 bytes unpacked, {} packed, in an "
                        "archive of {}: it is damaged",
                        tests::deflated(entries[2].content).size(), zip_archive(entries).size()));
  entries[2].declared_size = 32;
  EXPECT_EQ(import_error(zip_archive(entries)),
            "FILE: part 1 of 'A1' cannot be read: it ends before the length that the archive "
            "declares");
}

TEST(Sigrok, CutAnywhereIsRefused) {
  const std::string whole = zip_archive(sigrok_entries(true));
  for (std::size_t size = 40; size < whole.size(); ++size)
    EXPECT_THAT(import_error(whole.substr(0, size)),
                HasSubstr("FILE: the ZIP archive ends before its list of entries"));
}

}  // namespace
}  // namespace impactrig::acquisition
