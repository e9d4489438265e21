// SPDX-License-Identifier: BSD-3-Clause
//
// Fits on a mesh that the program chose.
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
using tests::parameter;

RigFile on(int before, int behind) {
  RigFile rig = parse_rig_file(tests::paper_rig, "rig.toml",
                               {{"solver.model", "ancf"}, {"solver.duration", "1.5 ms"}});
  rig.solver.elements = {before, behind};
  return rig;
}

datasets::Impact shot_of_fine_mesh() {
  return tests::synthetic_shot(on(28, 4),
                               {.force_noise = 0.5, .velocity_noise = 1e-4, .duration = 1.6e-3});
}

double reduced(const Fit& fit) {
  return fit.goodness.chi2 / static_cast<double>(fit.goodness.dof);
}

const char* const told = "The data ask for a finer mesh";

// What accuracy asks of peak, duration and impulse may not be what a quiet record shows of the
// rest.
TEST(OpenMesh, IsRefinedWhereTheDataAskForIt) {
  const datasets::Impact shot = shot_of_fine_mesh();
  RigFile rig = on(7, 1);
  const Fit stated = fit({shot}, rig);
  rig.mesh_chosen = true;
  const Fit open = fit({shot}, rig);
  EXPECT_EQ(stated.rig.solver.elements, (std::array<int, 2>{7, 1}));
  EXPECT_GT(reduced(stated), 5.0);
  EXPECT_THAT(stated.warnings, Not(Contains(HasSubstr(told))));
  EXPECT_GE(open.rig.solver.elements[0], 28);
  EXPECT_LT(reduced(open), 1.25);
  EXPECT_THAT(open.warnings, Contains(HasSubstr(told)));
  const Parameter& e = parameter(open, "contact.restitution");
  EXPECT_LT(e.ci95[0], 0.5);
  EXPECT_GT(e.ci95[1], 0.5);
}

// A finer mesh mends nothing of another law.
TEST(OpenMesh, IsKeptWhereAnotherLawMisfits) {
  const datasets::Impact shot = shot_of_fine_mesh();
  RigFile rig = on(28, 4);
  rig.mesh_chosen = true;
  rig.rig.contact.law = "hertz-point";
  const Fit found = fit({shot}, rig);
  EXPECT_GT(reduced(found), 5.0);
  EXPECT_EQ(found.rig.solver.elements, (std::array<int, 2>{28, 4}));
  EXPECT_THAT(found.warnings, Not(Contains(HasSubstr(told))));
}

// Two names of one law, of which one begins on a mesh that fits well enough: no model is better for
// its mesh.
TEST(OpenMesh, IsOneOfAllCandidates) {
  const datasets::Impact shot = shot_of_fine_mesh();
  const auto candidate = [](const char* damping, int before, int behind) {
    RigFile rig = on(before, behind);
    rig.mesh_chosen = true;
    rig.rig.contact.damping = damping;
    return Candidate{damping, rig};
  };
  const ModelComparison found = compare_models(
      {shot}, {candidate("lankarani-nikravesh", 56, 8), candidate("hunt-crossley", 28, 4)},
      FitOptions{});
  ASSERT_EQ(found.scores.size(), 2U);
  EXPECT_NEAR(found.scores[0].chi2, found.scores[1].chi2, 0.05);
  EXPECT_NEAR(found.scores[0].weight, 0.5, 0.02);
}

// Small motion knows no bar that stands: the full equations tell the mesh's error then.
TEST(OpenMesh, ErrorIsToldWithoutSmallMotionToo) {
  RigFile rig = parse_rig_file(tests::paper_rig, "rig.toml",
                               {{"solver.model", "ancf"},
                                {"solver.duration", "0.5 ms"},
                                {"environment.gravity_direction", "120 deg"}});
  RigFile finer = rig;
  rig.solver.elements = {4, 1};
  finer.solver.elements = {8, 2};
  const datasets::Impact shot = tests::synthetic_shot(finer, {.duration = 0.6e-3});
  const Fit found = fit({shot}, rig);
  EXPECT_FALSE(found.predictions.at(0).small_motion);
  const Parameter& e = parameter(found, "contact.restitution");
  EXPECT_GT(e.mesh_error, 0.3 * std::abs(e.value - 0.5));
  EXPECT_LT(e.ci95[0], 0.5);
  EXPECT_GT(e.ci95[1], 0.5);
  EXPECT_THAT(found.warnings, Not(Contains(HasSubstr("mesh error could not be estimated"))));
}

}  // namespace
}  // namespace impactrig::fitting
