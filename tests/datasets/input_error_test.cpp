// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/input_error.hpp"

#include <gtest/gtest.h>

namespace {

using namespace impactrig::datasets;

TEST(SourcePosition, LeavesOutWhatIsNotKnown) {
  EXPECT_EQ((SourcePosition{"run07.csv", 12, 9, 431}.text()), "run07.csv:12:9 (byte 431)");
  EXPECT_EQ((SourcePosition{"run07.csv", 12, 0, {}}.text()), "run07.csv:12");
  EXPECT_EQ((SourcePosition{"run07.csv", 0, 9, {}}.text()), "run07.csv");
  EXPECT_EQ((SourcePosition{"shot.h5", 0, 0, 0}.text()), "shot.h5 (byte 0)");
  EXPECT_EQ((SourcePosition{"", 12, 9, {}}.text()), "line 12:9");
  EXPECT_EQ((SourcePosition{"", 0, 0, 7}.text()), "byte 7");
  EXPECT_EQ(SourcePosition{}.text(), "");
}

TEST(InputError, ReadsPlaceThenProblem) {
  const InputError error({"run07.csv", 12, 9, 431}, "velocity: expected a number, found 'n/a'");
  EXPECT_STREQ(error.what(), "run07.csv:12:9 (byte 431): velocity: expected a number, found 'n/a'");
  EXPECT_EQ(error.problem(), "velocity: expected a number, found 'n/a'");
  EXPECT_EQ(error.where().line, 12u);
  EXPECT_STREQ(InputError({}, "no place").what(), "no place");
}

TEST(FileError, ReadsFileThenProblem) {
  EXPECT_STREQ(FileError("shot.h5", "cannot be opened").what(), "shot.h5: cannot be opened");
}

}  // namespace
