// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/impact.hpp"

#include <gmock/gmock.h>

namespace {

using namespace impactrig::datasets;

constexpr ImpactFlag all_flags[] = {
    ImpactFlag::clipped,        ImpactFlag::double_hit, ImpactFlag::multiple_hits,
    ImpactFlag::no_hit,         ImpactFlag::too_short,  ImpactFlag::missed_start,
    ImpactFlag::truncated_tail, ImpactFlag::dropout,    ImpactFlag::unmarked_dropout,
    ImpactFlag::undersampled,   ImpactFlag::noisy,      ImpactFlag::unsteady,
    ImpactFlag::baseline_shift, ImpactFlag::inverted,   ImpactFlag::swapped,
    ImpactFlag::implausible};

TEST(ImpactFlag, HasANameOfItsOwn) {
  std::vector<std::string_view> names;
  for (const ImpactFlag flag : all_flags) names.push_back(name(flag));
  EXPECT_THAT(names, testing::ElementsAre("clipped", "double-hit", "multiple-hits", "no-hit",
                                          "too-short", "missed-start", "truncated-tail", "dropout",
                                          "unmarked-dropout", "undersampled", "noisy", "unsteady",
                                          "baseline-shift", "inverted", "swapped", "implausible"));
  for (const ImpactFlag flag : all_flags) EXPECT_EQ(flag_named(name(flag)), flag);
  EXPECT_EQ(flag_named("no-such-flag"), std::nullopt);
}

TEST(ImpactFlag, HasASentenceThatSaysWhatToDo) {
  for (const ImpactFlag flag : all_flags) {
    EXPECT_THAT(std::string(sentence(flag)), testing::MatchesRegex("[A-Z].+[;,] .+\\."));
  }
  EXPECT_EQ(sentence(ImpactFlag::undersampled),
            "The contact has fewer than 20 samples, so its peak and duration are uncertain; record "
            "at a higher sample rate.");
}

TEST(Impact, KnowsItsFlags) {
  Impact impact;
  EXPECT_FALSE(impact.has(ImpactFlag::clipped));
  impact.flags = {ImpactFlag::dropout, ImpactFlag::clipped};
  EXPECT_TRUE(impact.has(ImpactFlag::clipped));
  EXPECT_FALSE(impact.has(ImpactFlag::no_hit));
}

}  // namespace
