// SPDX-License-Identifier: BSD-3-Clause
#include "app/worker_processes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <map>
#include <string>
#include <vector>

namespace {

using impactrig::app::run_in_processes;
using impactrig::app::WorkEnd;
using testing::HasSubstr;

const auto never_cut = [](std::size_t) { FAIL() << "nothing was interrupted"; };

TEST(WorkerProcesses, HandBackCodeAndSentenceOfEveryItem) {
  std::map<std::size_t, WorkEnd> ends;
  const int signal = run_in_processes(
      7, 3,
      [](std::size_t item) {
        return item == 4 ? WorkEnd{3, "has no force"} : WorkEnd{};
      },
      [&](std::size_t item, const WorkEnd& end) { ends[item] = end; }, never_cut);
  EXPECT_EQ(signal, 0);
  ASSERT_EQ(ends.size(), 7U);
  for (const auto& [item, end] : ends) EXPECT_EQ(end.code, item == 4 ? 3 : 0) << item;
  EXPECT_EQ(ends[4].sentence, "has no force");
}

TEST(WorkerProcesses, ACrashIsOfItsItemAlone) {
  std::map<std::size_t, WorkEnd> ends;
  run_in_processes(
      3, 1,
      [](std::size_t item) {
        if (item == 0) raise(SIGABRT);
        if (item == 1) raise(SIGKILL);
        return WorkEnd{};
      },
      [&](std::size_t item, const WorkEnd& end) { ends[item] = end; }, never_cut);
  ASSERT_EQ(ends.size(), 3U);
  EXPECT_EQ(ends[0].code, 1);
  EXPECT_THAT(ends[0].sentence, HasSubstr("the program crashed on it"));
  EXPECT_EQ(ends[1].code, 1);
  EXPECT_THAT(ends[1].sentence, HasSubstr("no memory left"));
  EXPECT_EQ(ends[2].code, 0);
}

// More than a pipe holds would keep the process from ending.
TEST(WorkerProcesses, ALongSentenceIsCut) {
  std::string sentence;
  run_in_processes(
      1, 1,
      [](std::size_t) {
        return WorkEnd{3, std::string(1000000, 'x')};
      },
      [&](std::size_t, const WorkEnd& end) { sentence = end.sentence; }, never_cut);
  EXPECT_EQ(sentence, std::string(4096, 'x'));
}

TEST(WorkerProcesses, ASignalEndsAllAndTellsWhichWereCutShort) {
  std::vector<std::size_t> cut, ended;
  const pid_t parent = getpid();
  const int signal = run_in_processes(
      4, 2,
      [&](std::size_t item) {
        if (item == 1) kill(parent, SIGTERM);
        if (item > 0) pause();
        return WorkEnd{};
      },
      [&](std::size_t item, const WorkEnd&) { ended.push_back(item); },
      [&](std::size_t item) { cut.push_back(item); });
  EXPECT_EQ(signal, SIGTERM);
  EXPECT_THAT(cut, testing::Contains(1U));
  EXPECT_THAT(ended, testing::Not(testing::Contains(1U)));
  EXPECT_LT(cut.size() + ended.size(), 4U);  // those that had not begun never did
}

}  // namespace
