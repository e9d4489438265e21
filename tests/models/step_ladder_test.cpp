// SPDX-License-Identifier: BSD-3-Clause
#include "models/collocation/step_ladder.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace {

using namespace impactrig::models;

TEST(StepLadder, HasTheLongestLevelNotLongerThanAStep) {
  const StepLadder ladder{.longest = 3.0};
  for (const int level : {0, 1, 7, 40}) {
    EXPECT_EQ(ladder.level_below(ladder.length_of(level)), level);
    EXPECT_EQ(ladder.level_below(0.99 * ladder.length_of(level)), level + 1);
  }
  EXPECT_EQ(ladder.level_below(10.0), 0);
  EXPECT_EQ(ladder.level_below(0.0), StepLadder::levels - 1);
}

/// Steps taken between refusals of level 3, where every error asks for it and level 4 always
/// passes.
std::vector<int> steps_between(int refusals, RefusedLevel& refused) {
  std::vector<int> taken;
  for (int k = 0; k < refusals; ++k) {
    refused.refuse(3);
    int level = 4, steps = 0;
    while (level > 3) {
      ++steps;
      level = refused.after(level, 3);
    }
    taken.push_back(steps);
  }
  return taken;
}

TEST(RefusedLevel, IsTriedTheLaterTheMoreOftenItWasRefused) {
  RefusedLevel refused;
  EXPECT_EQ(steps_between(8, refused), (std::vector{2, 3, 5, 9, 17, 33, 33, 33}));
}

TEST(RefusedLevel, IsForgottenOnceItPasses) {
  RefusedLevel refused;
  steps_between(5, refused);
  EXPECT_EQ(refused.after(3, 2), 2);
  EXPECT_EQ(steps_between(2, refused), (std::vector{2, 3}));
}

TEST(RefusedLevel, DoesNotKeepStepsFromBecomingShorter) {
  RefusedLevel refused;
  refused.refuse(3);
  EXPECT_EQ(refused.after(4, 9), 9);
}

}  // namespace
