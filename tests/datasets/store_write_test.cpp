// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/store.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/datasets/stored_file.hpp"

namespace {

using namespace impactrig::datasets;
using tests::record_of;
using tests::TemporaryFile;

std::string write_error(const Record& record, const std::string& path) {
  try {
    write_record(record, path);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "written";
}

TEST(StoreWrite, SaysWhyItCannotWrite) {
  const std::string absent = testing::TempDir() + "no_such_folder/shot.h5";
  EXPECT_EQ(write_error({}, absent), absent + ": cannot be written: No such file or directory");

  const TemporaryFile folder("folder");
  std::filesystem::create_directory(folder.path());
  EXPECT_EQ(write_error({}, folder.path()), folder.path() + ": cannot be written: Is a directory");
  EXPECT_FALSE(std::filesystem::exists(folder.path() + ".part"));
}

TEST(StoreWrite, RefusesChannelsOfUnequalLength) {
  Record record = record_of(std::vector<double>{1.0, 2.0});
  record.channels[0].valid = {1};
  EXPECT_EQ(write_error(record, "unused"),
            "write_record: channel 'a' has 1 validity flags for 2 samples");
  record.channels[0].valid.clear();
  record.channels[0].imaginary = {1.0, 2.0, 3.0};
  EXPECT_EQ(write_error(record, "unused"),
            "write_record: channel 'a' has 3 imaginary parts for 2 samples");
  record.channels[0].imaginary.clear();
  record.channels[0].clock.times = {1.0};
  EXPECT_EQ(write_error(record, "unused"), "write_record: channel 'a' has 1 times for 2 samples");
}

/// Ends the process: 7 when the write fails as it should and leaves no file.
[[noreturn]] void write_with_a_limit(rlim_t limit, const std::string& path) {
  std::mt19937 random(1);
  std::vector<std::int32_t> noise(1000000);
  for (auto& value : noise) value = static_cast<std::int32_t>(random());
  std::signal(SIGXFSZ, SIG_IGN);
  const rlimit limits{limit, limit};
  setrlimit(RLIMIT_FSIZE, &limits);
  const std::string error = write_error(record_of(noise), path);
  const bool said = error == path + ": cannot be written: File too large";
  if (!said) std::fprintf(stderr, "%s\n", error.c_str());
  const bool left = std::filesystem::exists(path) || std::filesystem::exists(path + ".part");
  std::exit(said && !left ? 7 : 8);
}

// A limit on the size of files stands for a full disk: the system refuses the write that passes it.
TEST(StoreWriteDeathTest, LeavesNothingBehindWhenTheDiskIsFull) {
  testing::GTEST_FLAG(death_test_style) = "threadsafe";
  const TemporaryFile file("full.h5");
  for (const rlim_t limit : {100u, 5000u, 100000u, 1000000u})
    EXPECT_EXIT(write_with_a_limit(limit, file.path()), testing::ExitedWithCode(7), "") << limit;
}

}  // namespace
