// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/model_comparison.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/fitting/synthetic_shot.hpp"

namespace impactrig::fitting {
namespace {

RigFile rig_with(const std::vector<Override>& changes) {
  std::vector<Override> overrides = {{"solver.model", "hybrid"},
                                     {"solver.basis", "pinned-free"},
                                     {"solver.modes", "4"},
                                     {"solver.duration", "1.5 ms"}};
  overrides.insert(overrides.end(), changes.begin(), changes.end());
  return parse_rig_file(tests::paper_rig, "rig.toml", overrides);
}

TEST(Alternatives, SplitsAtCommasOutsideBrackets) {
  const Alternatives a = read_alternatives("solver.elements=[14, 2],[28, 4]");
  EXPECT_EQ(a.key, "solver.elements");
  EXPECT_THAT(a.values, testing::ElementsAre("[14, 2]", "[28, 4]"));
  EXPECT_THROW(read_alternatives("contact.law"), std::invalid_argument);
  EXPECT_THROW(read_alternatives("contact.law=a,,b"), std::invalid_argument);
}

TEST(Alternatives, CombineEachWithEach) {
  const auto all = combinations({{"a", {"1", "2"}}, {"b", {"3", "4", "5"}}});
  ASSERT_EQ(all.size(), 6U);
  EXPECT_EQ(all.front().first, "a = 1, b = 3");
  EXPECT_EQ(all.back().first, "a = 2, b = 5");
  EXPECT_THAT(all.back().second, testing::ElementsAre(Override{"a", "2"}, Override{"b", "5"}));
}

class ModelComparisonOfFour : public testing::Test {
 protected:
  static const ModelComparison& of_four() {
    static const ModelComparison result = [] {
      const RigFile truth = rig_with({});
      std::vector<datasets::Impact> shots = {
          tests::synthetic_shot(truth, {.velocity = 0.3, .duration = 1.6e-3, .seed = 5}),
          tests::synthetic_shot(truth, {.velocity = 0.5, .duration = 1.6e-3, .seed = 6})};
      FitOptions options;
      options.window = 0.4e-3;
      std::vector<Candidate> candidates = {
          {"viscous", rig_with({{"contact.damping", "viscous"}})},
          {"own", truth},
          {"the same by another name", rig_with({{"contact.damping", "hunt-crossley"}})},
          {"none", {}, "there is no such rig"}};
      return compare_models(shots, candidates, options);
    }();
    return result;
  }

  static const ModelScore& score(const std::string& label) {
    for (const ModelScore& s : of_four().scores)
      if (s.label == label) return s;
    throw std::out_of_range(label);
  }
};

// Laws proportional to the elastic force differ in what e means, not in the force: their chi-square
// is the same, and so is their weight.
TEST_F(ModelComparisonOfFour, CannotTellProportionalLawsApart) {
  EXPECT_NEAR(score("own").chi2, score("the same by another name").chi2, 0.05);
  EXPECT_NEAR(score("own").weight, 0.5, 0.02);
  EXPECT_TRUE(score("own").sound);
  EXPECT_THAT(of_four().sentence, testing::HasSubstr("do as well as no difference"));
}

TEST_F(ModelComparisonOfFour, RulesTheWrongLawOut) {
  EXPECT_GT(score("viscous").delta, 1000.0);
  EXPECT_LT(score("viscous").weight, 1e-12);
  EXPECT_FALSE(score("viscous").sound);
}

TEST_F(ModelComparisonOfFour, WeightsAddUpAndFailuresCountForNothing) {
  double sum = 0.0;
  for (const ModelScore& s : of_four().scores) sum += s.weight;
  EXPECT_NEAR(sum, 1.0, 1e-12);
  EXPECT_EQ(score("none").weight, 0.0);
  EXPECT_EQ(score("none").failure, "there is no such rig");
  EXPECT_EQ(of_four().scores.back().label, "none");
}

// The right model foretells a shot it has not seen to the noise, another 67 % faster one included;
// 600 degrees of freedom leave chi-square a spread of 6 %.
TEST_F(ModelComparisonOfFour, HeldOutShotsAreForetoldByTheRightModelAlone) {
  const HeldOut& right = *score("own").held_out;
  EXPECT_NEAR(right.chi2 / static_cast<double>(right.dof), 1.0, 0.12);
  const HeldOut& wrong = *score("viscous").held_out;
  EXPECT_GT(wrong.chi2 / static_cast<double>(wrong.dof), 2.0);
}

}  // namespace
}  // namespace impactrig::fitting
