// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/replay.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <vector>

#include "datasets/input_error.hpp"
#include "tests/acquisition/scene.hpp"

namespace impactrig::acquisition {

namespace {

using datasets::Record;
using namespace tests;

/// A record of 21 samples, 1 ms apart: 20 ms.
Record record_called(const std::string& title) {
  Record record = record_of(
      {force_of({.start = 0.0, .interval = 1e-3, .samples = 21}, std::vector<double>(21, 0.0))});
  record.title = title;
  return record;
}

/// A file that is gone with the test.
class TextFile {
 public:
  TextFile(const std::string& name, const std::string& text)
      : path_(std::filesystem::temp_directory_path() /
              (name + std::to_string(std::chrono::steady_clock::now().time_since_epoch().count()) +
               ".csv")) {
    std::ofstream(path_) << text;
  }

  ~TextFile() { std::filesystem::remove(path_); }

  TextFile(const TextFile&) = delete;
  TextFile& operator=(const TextFile&) = delete;

  std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

TEST(ReplaySource, GivesRecordsInOrderAndThenNone) {
  ReplaySource source(std::vector<Record>{record_called("a"), record_called("b")});
  EXPECT_EQ(source.next()->title, "a");
  EXPECT_EQ(source.next()->title, "b");
  EXPECT_FALSE(source.next());
  EXPECT_FALSE(source.next());
}

TEST(ReplaySource, ReadsFilesWhenTheirTurnComes) {
  const TextFile one("impactrig_one", "Time [s],Force [N]\n0,1\n1e-6,2\n2e-6,3\n");
  const TextFile two("impactrig_two", "Time [s],Force [N]\n0,4\n1e-6,5\n2e-6,6\n");
  ReplaySource source(std::vector<std::string>{one.path(), two.path()});
  const auto first = source.next(), second = source.next();
  ASSERT_TRUE(first);
  ASSERT_TRUE(second);
  ASSERT_NE(first->find("Force"), nullptr);
  EXPECT_EQ(first->find("Force")->value(0), 1.0);
  EXPECT_EQ(second->find("Force")->value(2), 6.0);
  EXPECT_EQ(first->provenance.source_file, one.path());
}

TEST(ReplaySource, GoesOnAfterAFileThatCannotBeRead) {
  const TextFile good("impactrig_good", "Time [s],Force [N]\n0,1\n1e-6,2\n2e-6,3\n");
  ReplaySource source(std::vector<std::string>{"/nowhere/shot.csv", good.path()});
  EXPECT_THROW(source.next(), datasets::FileError);
  EXPECT_TRUE(source.next());
  EXPECT_FALSE(source.next());
}

TEST(ReplaySource, KeepsTheRecordsPace) {
  ReplaySource source(std::vector<Record>(3, record_called("a")), Pace::real_time);
  const auto begin = std::chrono::steady_clock::now();
  while (source.next()) {
  }
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  EXPECT_GE(taken.count(), 0.060);
  EXPECT_LT(taken.count(), 2.0);  // the machine may be busy, but a replay does not dawdle
}

TEST(Sources, HaveNamesAndOneLineEach) {
  std::vector<std::string_view> ids;
  for (const SourceDescription& source : sources) {
    EXPECT_FALSE(source.id.empty());
    EXPECT_FALSE(source.description.empty());
    EXPECT_EQ(source.description.find('\n'), std::string_view::npos);
    EXPECT_EQ(std::ranges::count(ids, source.id), 0);
    ids.push_back(source.id);
  }
}

}  // namespace

}  // namespace impactrig::acquisition
