// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/spool.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <numeric>

#include "datasets/input_error.hpp"

namespace impactrig::acquisition {
namespace {

/// The environment's TMPDIR as stated, until the end of the test.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(const std::string& path) {
    if (const char* const old = std::getenv("TMPDIR")) old_ = old;
    ::setenv("TMPDIR", path.c_str(), 1);
  }

  ~TemporaryFolder() {
    if (old_.empty())
      ::unsetenv("TMPDIR");
    else
      ::setenv("TMPDIR", old_.c_str(), 1);
  }

  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

 private:
  std::string old_;
};

std::vector<double> numbers_in(const NumberList<double>& list) {
  std::vector<double> all;
  list.each(
      [&all](std::span<const double> piece) { all.insert(all.end(), piece.begin(), piece.end()); });
  return all;
}

std::vector<double> counting(std::size_t from, std::size_t to) {
  std::vector<double> all(to - from);
  std::iota(all.begin(), all.end(), static_cast<double>(from));
  return all;
}

TEST(NumberList, HasTheSameNumbersOnTheDiskAsInMemory) {
  Spool spool("run.lvm");
  for (Spool* const where : {static_cast<Spool*>(nullptr), &spool}) {
    SCOPED_TRACE(where == nullptr ? "memory" : "disk");
    NumberList<double> list(where);
    NumberList<double> other(where);
    EXPECT_TRUE(list.empty());
    for (std::size_t i = 0; i < 10000; ++i) {  // by turns, so that they alternate on the disk
      list.push_back(static_cast<double>(i));
      other.push_back(static_cast<double>(10000 + i));
    }
    EXPECT_EQ(list.size(), 10000U);
    EXPECT_EQ(list.front(), 0.0);
    EXPECT_EQ(list.back(), 9999.0);
    list.append(std::move(other));
    EXPECT_EQ(list.size(), 20000U);
    EXPECT_EQ(list.back(), 19999.0);
    EXPECT_EQ(numbers_in(list), counting(0, 20000));
    for (const std::uint64_t n : {0U, 1U, 4096U, 4097U, 10000U, 12345U, 20000U})
      EXPECT_EQ(numbers_in(list.first(n)), counting(0, n)) << n;
    NumberList<double> few = list.first(3);
    few.append(10000, 7.0);
    EXPECT_EQ(few.size(), 10003U);
    EXPECT_EQ(few.front(), 0.0);
    EXPECT_EQ(few.back(), 7.0);
  }
}

TEST(NumberList, IsReadFromTheDiskByWhoeverReadsFiles) {
  Spool spool("run.lvm");
  NumberList<std::int16_t> shorts(&spool);
  NumberList<std::uint8_t> marks(&spool);
  for (int i = 0; i < 20000; ++i) {
    shorts.push_back(static_cast<std::int16_t>(i - 10000));
    if (i % 3 == 0) marks.push_back(static_cast<std::uint8_t>(i % 7 == 0));
  }
  const StoredNumbers stored = shorts.stored();
  const StoredNumbers stored_marks = marks.stored();
  const auto file = spool.map();
  EXPECT_EQ(file->path(), "run.lvm");
  ASSERT_EQ(stored.size(), 20000U);
  std::vector<double> found(20000);
  read_numbers(*file, stored, 0, found);
  for (std::size_t i = 0; i < found.size(); ++i)
    ASSERT_EQ(found[i], static_cast<double>(i) - 10000.0);
  std::vector<double> mark(1);
  read_numbers(*file, stored_marks, 7 * 400, mark);
  EXPECT_EQ(mark[0], 1.0);
}

TEST(Spool, LeavesNothingBehind) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::path(testing::TempDir()) / "impactrig_spool_test";
  fs::create_directory(folder);
  {
    const TemporaryFolder stated(folder.string());
    Spool spool("run.lvm");
    spool.append("some bytes");
    EXPECT_TRUE(fs::is_empty(folder));
  }
  fs::remove(folder);
}

TEST(Spool, WithoutAPlaceSaysWhereItWasToBe) {
  const TemporaryFolder stated("/no/such/folder");
  try {
    Spool spool("run.lvm");
    FAIL();
  } catch (const datasets::FileError& error) {
    EXPECT_STREQ(error.what(),
                 "run.lvm: is too large for memory and cannot be kept in a temporary file in "
                 "/no/such/folder (TMPDIR states another folder): No such file or directory");
  }
}

TEST(Spool, OnAFullDiskSaysSo) {
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit little = before;
  little.rlim_cur = 1 << 16;
  ::setrlimit(RLIMIT_FSIZE, &little);
  std::string found;
  try {
    NumberList<double> list;
    Spool spool("run.lvm");
    list = NumberList<double>(&spool);
    for (int i = 0; i < 100000; ++i) list.push_back(i);
  } catch (const datasets::FileError& error) {
    found = error.what();
  }
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_THAT(found, testing::StartsWith("run.lvm: is too large for memory and cannot be kept in"));
  EXPECT_THAT(found, testing::EndsWith("File too large"));
}

TEST(StoredNumbers, FirstOnesOfRepeatedRunsAreThose) {
  StoredNumbers numbers(NumberKind::f64);
  for (std::uint64_t chunk = 0; chunk < 5; ++chunk) numbers.add({chunk * 100, 10, 8, 1, 0, false});
  numbers.add({1000, 7, 8, 1, 0, false});
  ASSERT_EQ(numbers.size(), 57U);
  const StoredNumbers part = numbers.first(34);
  EXPECT_EQ(part.size(), 34U);
  ASSERT_EQ(part.runs().size(), 2U);
  EXPECT_EQ(part.runs()[0].repeats, 3U);
  EXPECT_EQ(part.runs()[1].offset, 300U);
  EXPECT_EQ(part.runs()[1].count, 4U);
  EXPECT_EQ(numbers.first(57).size(), 57U);
  EXPECT_EQ(numbers.first(0).size(), 0U);
}

}  // namespace
}  // namespace impactrig::acquisition
