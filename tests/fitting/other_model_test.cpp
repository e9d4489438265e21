// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/other_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "tests/fitting/fast_fit.hpp"

namespace impactrig::fitting {
namespace {

using testing::HasSubstr;

const char* const viscous_rig = R"(
[beam]
length = "0.8 m"
section = { shape = "circle", radius = "15 mm" }
youngs_modulus = "68.952 GPa"
density = "2766.7 kg/m^3"
[contact]
position = "0.69 m"
counterface = { shape = "groove", radius = "17.5 mm" }
length = "20 mm"
counter_modulus = "68.952 GPa"
law = "linear"
stiffness = "1e7 N/m"
damping = "viscous"
viscous = "200 N.s/m"
[start]
velocity = "0.4 m/s"
[solver]
model = "rigid"
duration = "1.5 ms"
)";

class OtherModel : public testing::Test {
 protected:
  void SetUp() override {
    path_ = testing::TempDir() + testing::UnitTest::GetInstance()->current_test_info()->name() +
            ".toml";
    std::ofstream(path_) << viscous_rig;
    own_ = read_rig_file(path_);
  }

  void TearDown() override { std::filesystem::remove(path_); }

  Candidate with(const std::vector<Override>& changes, const FitOptions& options = {}) const {
    return other_model(own_, {}, "other", changes, options);
  }

  std::string refused(const std::vector<Override>& changes) const {
    try {
      with(changes);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  }

  std::string path_;
  RigFile own_;
};

TEST_F(OtherModel, LeavesOutWhatBelongsToTheOldDampingLaw) {
  const Candidate exact = with({{"contact.damping", "exact"}});
  EXPECT_EQ(exact.failure, "");
  EXPECT_FALSE(exact.rig.rig.contact.viscous);
  EXPECT_EQ(exact.rig.rig.contact.restitution, 0.5);
  EXPECT_EQ(exact.note,
            "without contact.viscous, of the law it replaces; contact.restitution begins at 0.5");
  const Candidate none = with({{"contact.damping", "\"none\""}});
  EXPECT_EQ(none.failure, "");
  EXPECT_EQ(none.note, "without contact.viscous, of the law it replaces");
  EXPECT_TRUE(with({{"contact.viscous", "100 N.s/m"}}).note.empty());
}

TEST_F(OtherModel, LeavesOutWhatBelongsToTheOldElasticLaw) {
  const Candidate johnson = with({{"contact.law", "johnson"}});
  EXPECT_EQ(johnson.failure, "");
  EXPECT_EQ(johnson.note, "without contact.stiffness, of the law it replaces");
  EXPECT_EQ(johnson.rig.rig.contact.viscous, 200.0);
}

// A value that is not fitted is not made up.
TEST_F(OtherModel, DoesNotInventARestitutionThatIsHeld) {
  FitOptions options;
  options.free = {"start.velocity"};
  EXPECT_THAT(with({{"contact.damping", "exact"}}, options).failure,
              HasSubstr("contact.restitution: is missing"));
  EXPECT_EQ(with({{"contact.damping", "exact"}, {"contact.restitution", "0.7"}}, options)
                .rig.rig.contact.restitution,
            0.7);
  options = {};
  options.setting("contact.restitution").fixed = true;
  EXPECT_THAT(with({{"contact.damping", "exact"}}, options).failure,
              HasSubstr("contact.restitution: is missing"));
}

TEST_F(OtherModel, RefusesMisspeltNamesAndWhatIsNoModel) {
  EXPECT_THAT(refused({{"foo", "1"}}), HasSubstr("foo: there is no such key here"));
  EXPECT_THAT(refused({{"contact.dampign", "exact"}}), HasSubstr("did you mean damping?"));
  EXPECT_THAT(refused({{"contact.damping", "exakt"}}), HasSubstr("no damping law 'exakt'"));
  EXPECT_THAT(refused({{"contact.law", "gold"}}), HasSubstr("no elastic law 'gold'"));
  EXPECT_THAT(refused({{"solver.model", "flexible"}}), HasSubstr("expected one of rigid, hybrid"));
  EXPECT_EQ(refused({{"fit.loss", "huber"}}),
            "fit.loss is no part of a model; all models are fitted in the same way to the same "
            "samples");
}

// Each by the damping parameter that it has: c of the one is no e of the other.
TEST_F(OtherModel, IsFittedByItsOwnDampingParameter) {
  const RigFile own = parse_rig_file(tests::paper_rig, "rig.toml",
                                     {{"solver.model", "rigid"},
                                      {"contact.damping", "viscous"},
                                      {"contact.viscous", "800 N.s/m"}});
  const auto shot = tests::synthetic_shot(own, {.duration = 0.8e-3, .seed = 5});
  const std::vector<Candidate> two = {
      {"own", own},
      {"other", parse_rig_file(tests::paper_rig, "rig.toml",
                               {{"solver.model", "rigid"}, {"contact.damping", "hunt-crossley"}})}};
  for (const std::vector<std::string>& free :
       {std::vector<std::string>{}, std::vector<std::string>{"contact.viscous"}}) {
    FitOptions options;
    options.free = free;
    const ModelComparison both = compare_models({shot}, two, options);
    ASSERT_EQ(both.scores.size(), 2U);
    EXPECT_EQ(both.scores[0].failure, "");
    EXPECT_EQ(both.scores[1].failure, "");
    EXPECT_EQ(both.scores[0].unknowns, both.scores[1].unknowns);
    EXPECT_EQ(both.scores[0].label, "own");
  }
}

}  // namespace
}  // namespace impactrig::fitting
