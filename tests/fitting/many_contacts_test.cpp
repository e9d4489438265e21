// SPDX-License-Identifier: BSD-3-Clause
//
// Shots whose bar strikes the stop again and again: each contact magnifies what the model lacks.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "fitting/fit.hpp"
#include "fitting/model_comparison.hpp"
#include "tests/fitting/fast_fit.hpp"

namespace impactrig::fitting {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;
using tests::hybrid_rig;
using tests::parameter;
using tests::pull;
using tests::synthetic_shot;

const char* const nylon_rig = R"(
[beam]
length = "0.2256 m"
section = { shape = "circle", radius = "2.59 mm" }
youngs_modulus = "2.5 GPa"
poisson_ratio = 0.4
density = "1140 kg/m^3"
[contact]
position = "0.2197 m"
counterface = { shape = "groove", radius = "2.855 mm" }
length = "4.42 mm"
counter_modulus = "70 GPa"
counter_poisson_ratio = 0.33
law = "liu"
damping = "exact"
restitution = 0.5
[start]
velocity = "0.12 m/s"
[solver]
model = "hybrid"
modes = 12
accuracy = 1e-5
duration = "5 ms"
[sensors.force]
high_cut = "50 kHz"
[sensors.velocity]
high_cut = "1 MHz"
)";

// Gravity pulls this bar into its stop: the force rises and falls some ten times before the bar
// first leaves. A search over all of that at once, from wherever it begins, ended with the humps at
// other times (restitution 0, reduced chi-square 49).
TEST(ManyContacts, OfOneLongContactAreFollowedOneByOne) {
  const std::string text = R"(
[beam]
length = "0.93461 m"
section = { shape = "circle", radius = "26 mm" }
youngs_modulus = "70 GPa"
poisson_ratio = 0.33
density = "2700 kg/m^3"
[contact]
position = "0.66792 m"
counterface = { shape = "groove", radius = "51.64 mm" }
length = "19.7 mm"
counter_modulus = "105 GPa"
counter_poisson_ratio = 0.34
law = "dubowsky-freudenstein"
restitution = 0.5
[start]
velocity = "0.113 m/s"
[environment]
gravity_direction = "90 deg"
[solver]
model = "hybrid"
modes = 12
accuracy = 1e-4
duration = "2 ms"
[sensors.force]
high_cut = "50 kHz"
[sensors.velocity]
high_cut = "1 MHz"
)";
  const RigFile rig = parse_rig_file(text, "rig.toml");
  datasets::Impact shot = synthetic_shot(rig, {.restitution = 0.556,
                                               .stiffness_factor = 0.76,
                                               .velocity = 0.0868,
                                               .velocity_noise = 2e-4,
                                               .force_delay = 1e-7,
                                               .duration = 2e-3});
  shot.force->gain_uncertainty = shot.velocity->gain_uncertainty = 0.005;
  shot.force->delay_uncertainty = shot.velocity->delay_uncertainty = 2e-7;
  const Fit found = fit({shot}, rig);
  EXPECT_LT(found.goodness.chi2, 1.2 * static_cast<double>(found.goodness.dof));
  EXPECT_LT(std::abs(pull(found, "contact.restitution", 0.556)), 4.0);
  EXPECT_LT(std::abs(pull(found, "contact.stiffness_factor", 0.76)), 4.0);
}

// Later contacts magnify what the first leaves out, here seven of them: of its peak 1e-7, of theirs
// 3e-3, which moves the restitution by 4 standard errors.
TEST(ManyContacts, AreLookedAtForWhatSmallMotionDoes) {
  const RigFile rig = parse_rig_file(nylon_rig, "rig.toml");
  const datasets::Impact shot = synthetic_shot(rig, {.restitution = 0.71,
                                                     .velocity = 0.1224,
                                                     .force_noise = 3e-3,
                                                     .velocity_noise = 7e-4,
                                                     .duration = 5.1e-3,
                                                     .motion = models::Motion::full});
  const Fit result = fit({shot}, rig);
  ASSERT_GT(result.predictions.at(0).episodes.size(), 4u);
  EXPECT_FALSE(result.predictions.at(0).small_motion);
  EXPECT_LT(std::abs(pull(result, "contact.restitution", 0.71)), 3.5);
  EXPECT_LT(std::abs(pull(result, "contact.stiffness_factor", 1.0)), 3.5);
}

struct CoarseShot {
  RigFile rig = hybrid_rig("6 ms", {{"contact.position", "\"0.6 m\""}});
  RigFile finer = hybrid_rig("6 ms", {{"contact.position", "\"0.6 m\""}, {"solver.modes", "12"}});
  datasets::Impact shot = synthetic_shot(finer, {.duration = 6.1e-3});
};

// Four modes do not foretell what twelve do from the second contact on.
TEST(ManyContacts, AreLeftOutWhereTheyDoNotFit) {
  const CoarseShot coarse;
  const Fit result = fit({coarse.shot}, coarse.rig);
  const auto episodes = models::simulate(coarse.finer.rig, coarse.finer.solver).episodes;
  ASSERT_GT(episodes.size(), 2U);
  EXPECT_GT(result.window, 0.95 * episodes[0].end);
  EXPECT_LT(result.window, episodes[1].start);
  EXPECT_THAT(result.warnings, Contains(HasSubstr("before the second contact")));
  const Parameter& e = parameter(result, "contact.restitution");
  EXPECT_LT(e.ci95[0], 0.5);
  EXPECT_GT(e.ci95[1], 0.5);
}

// The same bar where four modes are all it has, which the data show: what eight would do from the
// second contact on is far from them, and to first order moves the restitution by 0.06, 3000
// standard errors. Residuals that are noise leave no room for that.
TEST(ManyContacts, SayHowWrongTheMeshMayBe) {
  const CoarseShot coarse;
  const Fit result =
      fit({synthetic_shot(coarse.rig, {.restitution = 0.47, .duration = 6.1e-3})}, coarse.rig);
  ASSERT_GT(result.predictions.at(0).episodes.size(), 2U);
  EXPECT_GT(result.window, result.predictions.at(0).episodes[1].start);
  const Parameter& e = parameter(result, "contact.restitution");
  EXPECT_LT(e.ci95[0], 0.47);
  EXPECT_GT(e.ci95[1], 0.47);
  EXPECT_LT(e.ci95[1] - e.ci95[0], 0.01);
  EXPECT_GT(e.mesh_error, 0.0);
}

TEST(ManyContacts, AreKeptWhereTheWindowIsStated) {
  const CoarseShot coarse;
  FitOptions options;
  options.window = 5.9e-3;
  datasets::Impact shot = coarse.shot;
  shot.flags = {datasets::ImpactFlag::double_hit, datasets::ImpactFlag::multiple_hits};
  const Fit result = fit({shot}, coarse.rig, options);
  EXPECT_DOUBLE_EQ(result.window, 5.9e-3);
  EXPECT_THAT(result.warnings, Not(Contains(HasSubstr("The fit ends"))));
  EXPECT_THAT(result.warnings.front(), HasSubstr("There are three or more contacts"));
  EXPECT_THAT(result.warnings, Not(Contains(HasSubstr("There is a second contact"))));
}

// Nobody is told to leave out what the model explains.
TEST(ManyContacts, AreNoFaultWhereTheyFit) {
  const CoarseShot coarse;
  datasets::Impact shot = synthetic_shot(coarse.rig, {.restitution = 0.47, .duration = 6.1e-3});
  shot.flags = {datasets::ImpactFlag::double_hit};
  const Fit result = fit({shot}, coarse.rig);
  EXPECT_GT(result.window, result.predictions.at(0).episodes.at(1).start);
  EXPECT_THAT(result.warnings, Not(Contains(HasSubstr("There is a second contact"))));
}

TEST(ManyContacts, OfComparedModelsAreTheSame) {
  const CoarseShot coarse;
  RigFile other = coarse.rig;
  other.rig.contact.damping = "hunt-crossley";
  const ModelComparison both = compare_models(
      {coarse.shot}, {{.label = "one", .rig = coarse.rig}, {.label = "other", .rig = other}}, {});
  ASSERT_EQ(both.scores.size(), 2U);
  EXPECT_EQ(both.scores[0].dof, both.scores[1].dof);
  EXPECT_GT(both.scores[0].dof, 10000);
}

}  // namespace
}  // namespace impactrig::fitting
