// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/store.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "datasets/input_error.hpp"
#include "tests/datasets/sample_record.hpp"
#include "tests/datasets/stored_file.hpp"

namespace {

using namespace impactrig::datasets;
using tests::bytes_of;
using tests::read_error;
using tests::record_of;
using tests::sample_record;
using tests::TemporaryFile;
using tests::write_bytes;

TEST(StoreRead, SaysWhyAFileCannotBeOpened) {
  const TemporaryFile file("absent.h5");
  EXPECT_EQ(read_error(file.path()),
            "FileError: " + file.path() + ": cannot be opened: No such file or directory");
  std::filesystem::create_directory(file.path());
  EXPECT_EQ(read_error(file.path()),
            "FileError: " + file.path() + ": cannot be read: Is a directory");
}

TEST(StoreRead, RefusesWhatIsNoHdf5File) {
  const TemporaryFile file("foreign");
  write_bytes(file.path(), "");
  EXPECT_EQ(read_error(file.path()), "is empty, not an HDF5 file");
  write_bytes(file.path(), "time;force\n0;1\n");
  EXPECT_EQ(read_error(file.path()),
            "is not an HDF5 file: it does not begin with the HDF5 signature");
  write_bytes(file.path(), "\x89PNG\r\n\x1a\n" + std::string(5000, '\0'));
  EXPECT_EQ(read_error(file.path()),
            "is not an HDF5 file: it does not begin with the HDF5 signature");
  write_bytes(file.path(), "\x89HDF\r\n\x1a\n" + std::string(5000, '\0'));
  EXPECT_EQ(read_error(file.path()), "is damaged: HDF5 cannot open it");
}

TEST(StoreRead, SaysHowMuchIsMissingOfAFileThatWasCutShort) {
  const TemporaryFile file("cut.h5");
  write_record(sample_record(), file.path());
  const std::string whole = bytes_of(file.path());
  const std::string of_all =
      " of " + std::to_string(whole.size()) + " bytes; copy or record it again";
  for (std::size_t size = 1; size < whole.size(); size += size < 100 ? 1 : 997) {
    write_bytes(file.path(), whole.substr(0, size));
    EXPECT_EQ(read_error(file.path()),
              size < 48 ? "is cut short: it ends after " + std::to_string(size) +
                              " bytes, within the HDF5 header"
                        : "is cut short: it has " + std::to_string(size) + of_all);
  }
  write_bytes(file.path(), whole.substr(0, whole.size() - 1));
  EXPECT_EQ(read_error(file.path()),
            "is cut short: it has " + std::to_string(whole.size() - 1) + of_all);
}

// Each byte in turn is turned over. Most lie under a checksum; whatever is read must be a record or
// an error.
TEST(StoreRead, SurvivesAnyWrongByte) {
  const TemporaryFile file("byte.h5");
  Record record = sample_record();
  record.channels[0].raw = std::vector<std::int16_t>(1100, 5);
  record.channels[0].valid.clear();
  write_record(record, file.path());
  const std::string whole = bytes_of(file.path());
  int refused = 0;
  for (std::size_t at = 0; at < whole.size(); at += 61) {
    std::string wrong = whole;
    wrong[at] = static_cast<char>(~wrong[at]);
    write_bytes(file.path(), wrong);
    try {
      read_record(file.path());
    } catch (const InputError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 100);
}

TEST(StoreRead, FindsAWrongByteAmongItsSamples) {
  const TemporaryFile file("sum.h5");
  std::mt19937 random(3);
  std::vector<std::int32_t> noise(60000);
  for (auto& value : noise) value = static_cast<std::int32_t>(random());
  write_record(record_of(noise), file.path());
  std::string bytes = bytes_of(file.path());
  const auto chunk = static_cast<std::size_t>(bytes.find("\x78\x5e") + 50000);  // zlib's header
  ASSERT_LT(chunk, bytes.size());
  bytes[chunk] = static_cast<char>(bytes[chunk] ^ 1);
  write_bytes(file.path(), bytes);
  EXPECT_EQ(read_error(file.path()), "is damaged: /entry/raw/a/samples cannot be read");
}

}  // namespace
