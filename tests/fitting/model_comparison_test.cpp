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
          {"own under its own name", rig_with({{"contact.damping", "lankarani-nikravesh"}})},
          {"none", {}, "there is no such rig"}};
      return compare_models(shots, candidates, options);
    }();
    return result;
  }

  static const ModelScore& score(const std::string& label) {
    for (const ModelScore& s : of_four().scores)
      if (s.label.starts_with(label)) return s;
    throw std::out_of_range(label);
  }
};

// Laws proportional to the elastic force differ in what e means, not in the force: their chi-square
// is the same, and so is their weight.
TEST_F(ModelComparisonOfFour, CannotTellProportionalLawsApart) {
  EXPECT_NEAR(score("own").chi2, score("the same by another name").chi2, 0.05);
  EXPECT_NEAR(score("own").weight, 0.5, 0.02);
  EXPECT_TRUE(score("own").sound);
  EXPECT_THAT(of_four().sentence,
              testing::HasSubstr("does as well within what the data can tell apart"));
}

// The default law by its name is no further model: nothing of its weight goes there.
TEST_F(ModelComparisonOfFour, CountsAModelOnce) {
  EXPECT_EQ(of_four().scores.size(), 4U);
  EXPECT_EQ(score("own").label, "own (own under its own name)");
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

std::string sentence_on(const std::vector<Candidate>& candidates) {
  const RigFile truth = rig_with({});
  FitOptions options;
  options.window = 0.3e-3;
  return compare_models({tests::synthetic_shot(truth, {.duration = 0.5e-3, .seed = 5})}, candidates,
                        options)
      .sentence;
}

// Nobody is told that others lack support who were never tried.
TEST(ModelComparison, SaysWhatThereWasToCompare) {
  const RigFile truth = rig_with({});
  const Candidate own{"own", truth}, broken{"broken", {}, "there is no such rig"};
  const Candidate wrong{"undamped", rig_with({{"contact.damping", "none"}})};
  EXPECT_EQ(sentence_on({own, {"the same", truth}}),
            "There is no other model to compare own (the same) with.");
  // e is fitted, and where that begins is no other model
  EXPECT_EQ(sentence_on({own, {"begun elsewhere", rig_with({{"contact.restitution", "0.4"}})}}),
            "There is no other model to compare own (begun elsewhere) with.");
  EXPECT_EQ(sentence_on({own, broken}),
            "own could not be compared: the other candidate could not be fitted.");
  EXPECT_EQ(sentence_on({own, broken, broken}),
            "own could not be compared: none of the other candidates could be fitted.");
  EXPECT_EQ(sentence_on({broken}),
            "None of the candidates could be fitted, so that none could be compared.");
  EXPECT_EQ(sentence_on({own, wrong, broken}),
            "own explains the data best; no other candidate has noteworthy support. One candidate "
            "could not be fitted, of which this says nothing.");
  const Candidate exact{"exact", rig_with({{"contact.damping", "exact"}})};
  const Candidate hunt{"hunt", rig_with({{"contact.damping", "hunt-crossley"}})};
  EXPECT_THAT(sentence_on({own, exact, hunt}),
              testing::HasSubstr("do as well within what the data can tell apart."));
}

}  // namespace
}  // namespace impactrig::fitting
