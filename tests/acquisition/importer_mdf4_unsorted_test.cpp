// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "tests/acquisition/mdf4_bytes.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using testing::ElementsAre;
using tests::bytes_of_number;
using tests::import_error;
using tests::imported;
using tests::mdf_channel;
using tests::mdf_time;
using tests::MdfChannelBlock;
using tests::MdfFile;
using tests::MdfTicks;

/// Records of three groups by turns: ticks at uneven times (id 1), values at even ones (id 2, twice
/// as often), and texts of variable length (id 77).
struct MixedRecords {
  MdfTicks ticks{{0, 1, 5, 6, 9, 10}};
  std::string even;  ///< time (f64), value (u8), a byte whose lowest bit marks what is not valid
  std::string mixed;

  explicit MixedRecords(std::uint8_t id_bytes) {
    for (std::size_t i = 0; i < 12; ++i) {
      even += bytes_of_number(0.5 + 0.001 * static_cast<double>(i)) + static_cast<char>('a' + i) +
              static_cast<char>(i % 5 == 2 ? 1 : 0);
      if (i % 2 == 0)
        mixed += tests::mdf_record_id(1, id_bytes) + ticks.bytes.substr(7 * (i / 2), 7);
      mixed += tests::mdf_record_id(2, id_bytes) + even.substr(10 * i, 10);
      mixed += tests::mdf_record_id(77, id_bytes) +
               bytes_of_number(static_cast<std::uint32_t>(3 * i)) + std::string(3 * i, '\1');
    }
  }

  static std::vector<MdfChannelBlock> even_channels() {
    MdfChannelBlock value = mdf_channel("value", 0, 8, 8);
    value.flags = 2;
    return {mdf_time(), value};
  }

  /// All in one data group; `stored` makes the data of the mixed records. `counts`: what the groups
  /// state of ticks and values; nothing: the truth.
  std::string file(std::uint8_t id_bytes,
                   const std::function<std::uint64_t(MdfFile&, const std::string&)>& stored,
                   std::vector<std::uint64_t> counts = {}, MdfFile to = MdfFile()) const {
    if (counts.empty()) counts = {ticks.count, 12};
    const std::uint64_t data = stored(to, mixed);
    const std::uint64_t texts = to.group(0, 12, 0, 0, 0, 77, 1);
    const std::uint64_t second = to.group(to.channels(even_channels()), counts[1], 9, 1, texts, 2);
    const std::uint64_t first =
        to.group(to.channels(MdfTicks::channels(to)), counts[0], 7, 0, second, 1);
    return to.with(to.data_group(first, data, id_bytes));
  }

  /// The same, a data group a channel group.
  std::string sorted() const {
    MdfFile to;
    const std::uint64_t second =
        to.data_group(to.group(to.channels(even_channels()), 12, 9, 1), to.block("DT", {}, even));
    const std::uint64_t first = to.group(to.channels(MdfTicks::channels(to)), ticks.count, 7);
    return to.with(to.data_group(first, to.block("DT", {}, ticks.bytes), 0, second));
  }
};

std::uint64_t one_block(MdfFile& file, const std::string& records) {
  return file.block("DT", {}, records);
}

void expect_same(const datasets::Record& record, const datasets::Record& twin) {
  ASSERT_EQ(record.channels.size(), twin.channels.size());
  for (std::size_t i = 0; i < twin.channels.size(); ++i) {
    EXPECT_EQ(record.channels[i].name, twin.channels[i].name);
    EXPECT_EQ(record.channels[i].values(), twin.channels[i].values());
    EXPECT_EQ(record.channels[i].valid, twin.channels[i].valid);
    EXPECT_EQ(record.channels[i].clock.start, twin.channels[i].clock.start);
    EXPECT_EQ(record.channels[i].clock.interval, twin.channels[i].clock.interval);
    EXPECT_EQ(record.channels[i].clock.times, twin.channels[i].clock.times);
  }
  EXPECT_EQ(record.warnings, twin.warnings);
}

// Channels, windows and clocks are those of the sorted file, however records are numbered and cut.
TEST(Mdf4Unsorted, RecordsAreThoseOfTheSortedFile) {
  for (const std::uint8_t id_bytes : std::vector<std::uint8_t>{1, 2, 4, 8}) {
    const MixedRecords records(id_bytes);
    const std::string sorted = records.sorted();
    ImportOptions window;
    window.from = 0.501;
    window.to = 0.5065;
    ImportOptions one = window;
    one.channels = {"value"};
    const std::size_t n = records.mixed.size();
    for (std::size_t cut = 0; cut < n; cut += cut < 40 ? 1 : 7) {
      SCOPED_TRACE(fmt::format("ids of {} bytes, cut at {}", id_bytes, cut));
      const std::string file = records.file(id_bytes, [cut](MdfFile& to, const std::string& mixed) {
        if (cut == 0) return one_block(to, mixed);
        const std::uint64_t end =
            to.list({to.compressed(mixed.substr(cut), static_cast<std::uint32_t>(cut % 6))});
        return to.list({to.block("DT", {}, mixed.substr(0, cut / 2)), 0,
                        to.block("DT", {}, mixed.substr(cut / 2, cut - cut / 2))},
                       end);
      });
      for (const ImportOptions& options : {ImportOptions{}, window, one})
        expect_same(imported(file, options), imported(sorted, options));
    }
    const auto record = imported(records.file(id_bytes, one_block));
    EXPECT_EQ(record.channels.at(0).attributes.at("group"), "group 0.1");
    EXPECT_EQ(record.channels.at(1).attributes.at("group"), "group 0.2");
  }
}

// texts of variable length stand among the records whether or not their group counts them
TEST(Mdf4Unsorted, TextsAmongTheRecordsOfOneGroupAreNoNumbers) {
  MdfFile file;
  const std::string records = "\1a\2" + bytes_of_number(std::uint32_t{3}) + "xyz\1b\2" +
                              bytes_of_number(std::uint32_t{0}) + "\1c";
  const std::uint64_t data = file.block("DT", {}, records);
  const std::uint64_t texts = file.group(0, 0, 0, 0, 0, 2, 1);
  const std::uint64_t group =
      file.group(file.channels({mdf_channel("a", 0, 8, 0)}), 3, 1, 0, texts, 1);
  const auto record = imported(file.with(file.data_group(group, data, 1)));
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre('a', 'b', 'c'));
}

TEST(Mdf4Unsorted, EmptyGroupsMayHaveTheIdsOfOthers) {
  MdfFile file;
  const std::uint64_t data = file.block("DT", {}, "\1a\2b\1c");
  std::uint64_t next = file.group(file.channels({mdf_channel("empty", 0, 16, 0)}), 0, 2, 0, 0, 2);
  next = file.group(file.channels({mdf_channel("b", 0, 8, 0)}), 1, 1, 0, next, 2);
  next = file.group(file.channels({mdf_channel("a", 0, 8, 0)}), 2, 1, 0, next, 1);
  next = file.group(file.channels({mdf_channel("nothing", 0, 16, 0)}), 0, 2, 0, next, 1);
  const auto record = imported(file.with(file.data_group(next, data, 1)));
  ASSERT_EQ(record.channels.size(), 4U);
  EXPECT_EQ(record.channels[0].size(), 0U);
  EXPECT_THAT(record.channels[1].values(), ElementsAre('a', 'c'));
  EXPECT_THAT(record.channels[2].values(), ElementsAre('b'));
  EXPECT_EQ(record.channels[3].size(), 0U);
}

TEST(Mdf4Unsorted, CutAndUnfinishedFilesGiveWhatIsThere) {
  const MixedRecords records(1);
  // the last two texts and values, and a part of the tick before them
  const auto cut = [](MdfFile& to, const std::string& mixed) {
    return to.block("DT", {}, mixed.substr(0, mixed.size() - 98));
  };
  const auto short_one = imported(records.file(1, cut));
  EXPECT_EQ(short_one.channels.at(0).size(), 5U);
  EXPECT_EQ(short_one.channels.at(1).size(), 10U);
  EXPECT_THAT(short_one.warnings,
              testing::IsSupersetOf({"group 0.1 announces 6 records, 5 are there",
                                     "group 0.2 announces 12 records, 10 are there"}));
  const auto fewer = imported(records.file(1, one_block, {4, 3}));
  EXPECT_EQ(fewer.channels.at(0).size(), 4U);
  EXPECT_EQ(fewer.channels.at(1).size(), 3U);
  const auto stale =
      imported(records.file(1, one_block, {0, 1}, MdfFile("4.10    ", "UnFinMF ", 1)));
  EXPECT_EQ(stale.channels.at(0).size(), 6U);
  EXPECT_EQ(stale.channels.at(1).size(), 12U);
}

TEST(Mdf4Unsorted, AnUnknownRecordEndsTheData) {
  const MixedRecords records(1);
  const auto record = imported(records.file(1, [](MdfFile& to, const std::string& mixed) {
    return to.block("DT", {}, mixed.substr(0, 24) + "\5" + mixed.substr(24));
  }));
  EXPECT_EQ(record.channels.at(0).size(), 1U);
  EXPECT_EQ(record.channels.at(1).size(), 1U);
  EXPECT_THAT(record.warnings,
              testing::Contains("byte 24 of the data of group 0 begins a record of the id 5, which "
                                "no channel group has: what follows is left out"));
}

/// A file of more than is gone through when it is opened: two channels of bytes, one in every
/// record but those that the other has, `slow_at`, at times of milliseconds.
class LargeMixed {
 public:
  explicit LargeMixed(std::vector<std::size_t> slow_at, bool stale = false,
                      std::uint64_t more = 0) {
    constexpr std::size_t wide = 500;  // bytes of a record, so that there are few
    std::string mixed;
    mixed.reserve(count * (wide + 1));
    std::vector<char> record(wide, 'x');
    std::uint64_t slow = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const bool is_slow = std::ranges::find(slow_at, i) != slow_at.end();
      slow += is_slow ? 1 : 0;
      const std::string time = bytes_of_number(1e-3 * static_cast<double>(i));
      std::ranges::copy(time, record.begin());
      record[8] = static_cast<char>(i % 100);
      mixed += is_slow ? '\2' : '\1';
      mixed.append(record.begin(), record.end());
    }
    MdfFile file("4.10    ", stale ? "UnFinMF " : "MDF     ", stale ? 1 : 0);
    const std::uint64_t second = file.group(
        file.channels({mdf_time(), mdf_channel("slow", 0, 8, 8)}), stale ? 0 : slow, wide, 0, 0, 2);
    const std::uint64_t first =
        file.group(file.channels({mdf_time(), mdf_channel("fast", 0, 8, 8)}),
                   stale ? 0 : count - slow + more, wide, 0, second);
    bytes_ = file.with(file.data_group(first, file.block("DT", {}, mixed), 1));
  }

  const std::string& bytes() const { return bytes_; }

  static constexpr std::size_t count = 150000;  ///< 75 MB

 private:
  std::string bytes_;
};

TEST(Mdf4Unsorted, OfLargeFilesTheHeadIsWhatTheFileAnnounces) {
  const LargeMixed made({140000, 149000}, false, 5);
  const tests::WrittenFile file(made.bytes());
  const auto reader = open_recording(file.path());
  const RecordingHead& head = reader->head();
  EXPECT_FALSE(head.counted);
  EXPECT_THAT(head.samples, ElementsAre(LargeMixed::count, 2));  // no more than have room
  EXPECT_NEAR(head.record.channels.at(0).clock.interval, 1e-3, 1e-9);
  EXPECT_GT(head.record.channels.at(1).clock.interval, 10.0);  // two in about 150 s
  const auto record = read_into_memory(*reader);
  EXPECT_EQ(record.channels.at(0).size(), LargeMixed::count - 2);
  EXPECT_EQ(record.channels.at(0).values().at(140000), 1);
  EXPECT_EQ(record.channels.at(0).clock.times.at(140000), 1e-3 * 140001);
  EXPECT_THAT(record.channels.at(1).clock.times, ElementsAre(1e-3 * 140000, 1e-3 * 149000));
  EXPECT_DOUBLE_EQ(record.channels.at(1).clock.start, 140);
  EXPECT_DOUBLE_EQ(record.channels.at(1).clock.interval, 9);
  EXPECT_THAT(record.warnings,
              testing::Contains("group 0.1 announces 150003 records, 149998 are there"));
  Selection window;
  window.from = 139.999;
  window.to = 140.002;
  const auto part = read_into_memory(*reader, window);
  EXPECT_THAT(part.channels.at(0).values(), ElementsAre(99, 1, 2));
  EXPECT_THAT(part.channels.at(1).values(), ElementsAre(0));
}

TEST(Mdf4Unsorted, OfLargeUnfinishedFilesTheHeadIsAnEstimate) {
  const LargeMixed made({3, 149000}, true);
  const tests::WrittenFile file(made.bytes());
  const auto reader = open_recording(file.path());
  EXPECT_FALSE(reader->head().counted);
  EXPECT_NEAR(static_cast<double>(reader->head().samples.at(0)), 150000, 2);
  const auto record = read_into_memory(*reader);
  EXPECT_EQ(record.channels.at(0).size(), LargeMixed::count - 2);
  EXPECT_EQ(record.channels.at(1).size(), 2U);
}

TEST(Mdf4Unsorted, WhatCannotBeToldApartIsRefusedOrLeftOut) {
  const auto unsorted = [](MdfFile& file, std::uint8_t id_bytes, std::uint64_t second_id) {
    const std::uint64_t second =
        file.group(file.channels({mdf_channel("b", 0, 8, 0)}), 2, 1, 0, 0, second_id);
    const std::uint64_t first =
        file.group(file.channels({mdf_channel("a", 0, 8, 0)}), 2, 1, 0, second);
    return file.data_group(first, 0, id_bytes);
  };
  const auto refused = [&](std::uint8_t id_bytes, std::uint64_t second_id, const std::string& why) {
    const std::string sentence = "channel groups that share a block of data " + why +
                                 " are not read: sort the file with the program that wrote it";
    MdfFile file;
    const std::uint64_t at = unsorted(file, id_bytes, second_id);
    EXPECT_EQ(import_error(file.with(at)), fmt::format("FILE (byte {}): {}", at, sentence));
    const std::uint64_t group = file.group(file.channels({mdf_channel("c", 0, 8, 0)}), 2, 1);
    const auto record =
        imported(file.with(file.data_group(group, file.block("DT", {}, "ab"), 0, at)));
    EXPECT_EQ(record.channels.at(0).name, "c");
    EXPECT_EQ(record.warnings.at(0), sentence);
  };
  refused(0, 2, "without record ids");
  refused(3, 2, "with record ids of 3 bytes");
  refused(1, 1, "and the record id 1");
}

}  // namespace
}  // namespace impactrig::acquisition
