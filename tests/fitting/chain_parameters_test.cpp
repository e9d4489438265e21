// SPDX-License-Identifier: BSD-3-Clause
//
// Numbers of the sensors' chains as parameters of a fit.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "fitting/fit.hpp"
#include "fitting/fit_problem.hpp"
#include "tests/fitting/fast_fit.hpp"

namespace impactrig::fitting {
namespace {

using tests::hybrid_rig;
using tests::parameter;
using tests::pull;
using tests::synthetic_shot;

struct Case {
  const char* name;
  double truth, wrong;
  void (*set)(RigFile& rig, double value);
};

const std::vector<Case> cases = {
    {"sensors.force.amplifier.high_cut", 60e3, 100e3,
     [](RigFile& rig, double value) { rig.force->high_cut->frequency = value; }},
    {"sensors.force.resonance.frequency", 30e3, 36e3,
     [](RigFile& rig, double value) { rig.force->resonance->frequency = value; }},
    {"sensors.force.resonance.quality", 12.0, 20.0,
     [](RigFile& rig, double value) { rig.force->resonance->quality = value; }},
    {"sensors.velocity.position", 0.62, 0.69,
     [](RigFile& rig, double value) { rig.velocity->position = value; }},
};

// The shot has a chain that the rig file states wrongly.
TEST(ChainParameters, AreRecoveredFromAWrongRigFile) {
  for (const Case& c : cases) {
    RigFile rig = hybrid_rig();
    c.set(rig, c.truth);
    const datasets::Impact shot =
        synthetic_shot(rig, {.force_noise = 1.0, .velocity_noise = 5e-4, .duration = 1.6e-3});
    c.set(rig, c.wrong);
    FitOptions options;
    options.free = {"contact.restitution", "contact.stiffness_factor", "start.velocity", c.name};
    const Fit found = fit({shot}, rig, options);
    EXPECT_EQ(found.termination, "converged") << c.name;
    EXPECT_LT(std::abs(pull(found, c.name, c.truth)), 4.0)
        << c.name << " " << parameter(found, c.name).value;
    EXPECT_LT(std::abs(pull(found, "contact.restitution", 0.5)), 4.0) << c.name;
    EXPECT_LT(parameter(found, c.name).std_error, 0.1 * c.truth) << c.name;
    EXPECT_TRUE(parameter(found, c.name).nuisance);
    EXPECT_NEAR(found.goodness.chi2 / static_cast<double>(found.goodness.dof), 1.0, 0.1) << c.name;
    RigFile fitted = found.rig;
    c.set(fitted, parameter(found, c.name).value);
    EXPECT_EQ(fitted.force->high_cut->frequency, found.rig.force->high_cut->frequency);
    EXPECT_EQ(fitted.force->resonance->frequency, found.rig.force->resonance->frequency);
    EXPECT_EQ(fitted.force->resonance->quality, found.rig.force->resonance->quality);
    EXPECT_EQ(fitted.velocity->position, found.rig.velocity->position);
  }
}

/// Difference of a Jacobian's column from central differences of all residuals, as part of the
/// column: of their norms.
double mismatch(FitProblem& problem, std::size_t unknown, double step) {
  Eigen::VectorXd middle, above, below;
  Eigen::MatrixXd jacobian;
  problem.linearise(middle, &jacobian);
  const std::size_t number = problem.unknowns()[unknown];
  const std::vector<double> values = problem.values();
  std::vector<double> moved = values;
  moved[number] = values[number] + step;
  problem.set_values(moved);
  problem.linearise(above, nullptr);
  moved[number] = values[number] - step;
  problem.set_values(moved);
  problem.linearise(below, nullptr);
  problem.set_values(values);
  const Eigen::VectorXd column = jacobian.col(static_cast<Eigen::Index>(unknown));
  return (column - (above - below) / (2.0 * step)).norm() / column.norm();
}

// Another step (3e-4) than that of the slopes themselves (1e-4), which are off by its square: 1e-4
// of a resonance in 1.5 ms. Slopes of the physics in small motion are exact but where a force ends:
// there samples see the jump of the slope, 6e-3 of the restitution's column.
TEST(ChainParameters, JacobianIsThatOfTheWholePrediction) {
  const RigFile rig = hybrid_rig();
  const std::vector<datasets::Impact> impacts = {synthetic_shot(rig, {.duration = 1.6e-3})};
  FitOptions options;
  options.free = {"contact.restitution", "contact.stiffness_factor", "start.velocity"};
  for (const Case& c : cases) options.free.emplace_back(c.name);
  FitProblem problem(impacts, rig, options);
  problem.set_motion(models::Motion::small);
  problem.choose_samples(std::numeric_limits<double>::infinity());
  for (std::size_t k = 0; k < problem.unknowns().size(); ++k) {
    const Variable& v = problem.variables()[problem.unknowns()[k]];
    if (v.role != Variable::Role::chain && v.role != Variable::Role::physics) continue;
    const bool chain = v.role == Variable::Role::chain;
    EXPECT_LT(mismatch(problem, k, (chain ? 3e-4 : 1e-5) * v.value), chain ? 1e-3 : 1e-2) << v.name;
  }
}

// Of a tied number the column is that of both together.
TEST(ChainParameters, JacobianOfATieIsThatOfBoth) {
  const RigFile rig = hybrid_rig();
  const std::vector<datasets::Impact> impacts = {synthetic_shot(rig, {.duration = 1.6e-3})};
  FitOptions options;
  options.free = {"sensors.force.amplifier.high_cut"};
  options.setting("sensors.velocity.high_cut").tie =
      Tie{.to = "sensors.force.amplifier.high_cut", .factor = 2.5};
  FitProblem problem(impacts, rig, options);
  problem.set_motion(models::Motion::small);
  problem.choose_samples(std::numeric_limits<double>::infinity());
  for (std::size_t k = 0; k < problem.unknowns().size(); ++k) {
    const Variable& v = problem.variables()[problem.unknowns()[k]];
    if (v.role != Variable::Role::chain) continue;
    EXPECT_LT(mismatch(problem, k, 3e-4 * v.value), 1e-3) << v.name;
  }
}

TEST(ChainParameters, NeedAValueToStartFrom) {
  RigFile rig = hybrid_rig();
  rig.force->resonance.reset();
  FitOptions options;
  options.free = {"sensors.force.resonance.frequency"};
  try {
    fit({synthetic_shot(rig, {.duration = 1.6e-3})}, rig, options);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(),
                 "'sensors.force.resonance.frequency' cannot be fitted with this rig: it has no "
                 "value to start from");
  }
}

}  // namespace
}  // namespace impactrig::fitting
