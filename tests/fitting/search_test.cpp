// SPDX-License-Identifier: BSD-3-Clause
//
// Searches from afar by rough predictions, from near by fine ones.
#include <gtest/gtest.h>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "fitting/fit_problem.hpp"
#include "tests/fitting/fast_fit.hpp"

namespace impactrig::fitting {
namespace {

using tests::hybrid_rig;
using tests::synthetic_shot;

struct Linearised {
  Eigen::VectorXd residuals;
  Eigen::MatrixXd jacobian;

  Linearised(FitProblem& problem, bool rough) {
    problem.choose_samples(1.2, rough);
    problem.linearise(residuals, &jacobian);
  }
};

// At the truth, where residuals are noise: what a rough prediction is off by must be less than what
// a first search may leave, a thousandth of chi-square; its slopes only lead there.
TEST(Search, RoughPredictionsAreGoodEnoughToStartFrom) {
  const RigFile rig = hybrid_rig();
  const std::vector<datasets::Impact> impacts = {synthetic_shot(rig, {.duration = 1.6e-3})};
  FitProblem problem(impacts, rig, {});
  problem.set_motion(models::Motion::small);
  const Linearised fine(problem, false), rough(problem, true);
  ASSERT_EQ(fine.residuals.size(), rough.residuals.size());
  const double off = (rough.residuals - fine.residuals).norm() / fine.residuals.norm();
  EXPECT_LT(off, std::sqrt(first_search.tolerance));
  EXPECT_GT(off, 0.0);
  for (Eigen::Index k = 0; k < fine.jacobian.cols(); ++k)
    EXPECT_LT((rough.jacobian.col(k) - fine.jacobian.col(k)).norm(),
              0.05 * fine.jacobian.col(k).norm())
        << problem.variables()[problem.unknowns()[static_cast<std::size_t>(k)]].name;
}

// Two standard errors of the first unknown beside the end, where all others follow it.
TEST(Search, KnowsWhereItWouldEndIfAllWereLinear) {
  const RigFile rig = hybrid_rig();
  const std::vector<datasets::Impact> impacts = {synthetic_shot(rig, {.duration = 1.6e-3})};
  FitProblem problem(impacts, rig, {});
  problem.set_motion(models::Motion::small);
  problem.choose_samples(std::numeric_limits<double>::infinity());
  const SearchEnd end = problem.search(last_search);
  EXPECT_NEAR(problem.linear_end(), end.cost, 1e-3);
  Eigen::VectorXd residuals;
  Eigen::MatrixXd jacobian;
  problem.linearise(residuals, &jacobian);
  const Eigen::MatrixXd covariance = (jacobian.transpose() * jacobian).inverse();
  std::vector<double> beside = problem.values();
  for (std::size_t k = 0; k < problem.unknowns().size(); ++k)
    beside[problem.unknowns()[k]] +=
        2.0 * covariance(static_cast<Eigen::Index>(k), 0) / std::sqrt(covariance(0, 0));
  problem.set_values(beside);
  problem.linearise(residuals, nullptr);
  EXPECT_NEAR(0.5 * residuals.squaredNorm(), end.cost + 2.0, 0.1);
  EXPECT_NEAR(problem.linear_end(), end.cost, 0.05);
  EXPECT_NEAR(problem.linear_end({problem.unknowns()[0]}), end.cost + 2.0, 0.1);
}

// A search from near does not know how the values it begins at were found: rough or fine, it ends
// at the same place, to a hundredth of a standard error.
TEST(Search, EndsAtTheSamePlaceAfterARoughOne) {
  const RigFile rig = hybrid_rig();
  const std::vector<datasets::Impact> impacts = {
      synthetic_shot(rig, {.duration = 1.6e-3, .seed = 5})};
  std::vector<std::vector<double>> ends;
  Eigen::VectorXd errors;
  for (const bool rough : {true, false}) {
    FitProblem problem(impacts, rig, {});
    problem.set_motion(models::Motion::small);
    Search first = first_search;
    first.rough = rough;
    problem.choose_samples(1.2, first.rough);
    problem.search(first);
    problem.choose_samples(std::numeric_limits<double>::infinity());
    EXPECT_TRUE(problem.search(last_search).converged);
    ends.push_back(problem.values());
    Eigen::VectorXd residuals;
    Eigen::MatrixXd jacobian;
    problem.linearise(residuals, &jacobian);
    errors = (jacobian.transpose() * jacobian).inverse().diagonal().cwiseSqrt();
    if (ends.size() < 2) continue;
    for (std::size_t k = 0; k < problem.unknowns().size(); ++k) {
      const std::size_t i = problem.unknowns()[k];
      EXPECT_NEAR(ends[0][i], ends[1][i], 0.01 * errors[static_cast<Eigen::Index>(k)])
          << problem.variables()[i].name;
    }
  }
}

// Noise x_t = 0.95 x_{t-1} + e_t. Its steps are a third of it, so that what rings weighs thrice as
// much as what is slow, and touch and delay have a false minimum at each of its periods.
TEST(Search, FindsTheImpactInNoiseThatHangsTogether) {
  const RigFile rig = hybrid_rig();
  for (int shot = 0; shot < 10; ++shot) {
    const tests::ShotTruth truth{.restitution = 0.4 + 0.03 * shot,
                                 .stiffness_factor = shot % 2 == 0 ? 0.7 : 1.4,
                                 .velocity = 0.8 - 0.03 * shot,
                                 .noise_memory = 0.95,
                                 .duration = 1.6e-3,
                                 .seed = 100U + static_cast<std::uint64_t>(shot)};
    const Fit found = fit({synthetic_shot(rig, truth)}, rig);
    SCOPED_TRACE(testing::Message() << "shot " << shot);
    EXPECT_LT(found.goodness.chi2, 1.5 * static_cast<double>(found.goodness.dof));
    const Parameter& e = tests::parameter(found, "contact.restitution");
    EXPECT_NEAR(e.value, truth.restitution, 5.0 * e.std_error);
  }
}

// Six to nine samples in a contact, and a sensor that rings at 45 kHz: a touch that is a period
// off, its delay and gain with it, is a false minimum.
TEST(Search, FindsTouchBetweenFewSamples) {
  const RigFile rig = hybrid_rig("2.5 ms");
  for (const double interval : {50e-6, 62.5e-6, 80e-6})
    for (const double late : {-160e-6, -80e-6, -20e-6, 25e-6}) {
      const tests::ShotTruth truth{
          .restitution = 0.35, .duration = 2.6e-3, .interval = interval, .found_late = late};
      const Fit found = fit({synthetic_shot(rig, truth)}, rig);
      SCOPED_TRACE(testing::Message() << "interval " << interval << ", found late by " << late);
      EXPECT_LT(found.goodness.chi2, 2.0 * static_cast<double>(found.goodness.dof));
      EXPECT_LT(std::abs(tests::pull(found, "contact.restitution", truth.restitution)), 4.0);
    }
}

// Two shots of different restitution fitted with one. From wherever a search begins it ends at the
// same place, which is not to be looked for again and again; where the stiffness differs too, a
// gain goes to its bound, beyond which there is no use in following a valley.
TEST(Search, OfAWrongModelEnds) {
  const RigFile rig = hybrid_rig("1.5 ms");
  const auto simulations = [&](double restitution, double other, double stiffness) {
    std::vector<datasets::Impact> impacts = {
        synthetic_shot(rig, {.restitution = restitution, .duration = 1.6e-3}),
        synthetic_shot(
            rig,
            {.restitution = other, .stiffness_factor = stiffness, .duration = 1.6e-3, .seed = 2})};
    for (datasets::Impact& impact : impacts)
      impact.force->gain_uncertainty = impact.velocity->gain_uncertainty = 0.005;
    const Fit early = fit(impacts, rig);
    EXPECT_EQ(early.termination, "converged");
    FitOptions options;
    options.window = 1.5e-3;
    const Fit found = fit(impacts, rig, options);
    EXPECT_EQ(found.termination, "converged");
    EXPECT_GT(found.goodness.chi2, 100.0 * static_cast<double>(found.goodness.dof));
    return std::max(early.simulations, found.simulations);
  };
  EXPECT_LT(simulations(0.4, 0.6, 1.0), 400);
  EXPECT_LT(simulations(0.35, 0.7, 2.0), 900);
}

// What asks for laws beside the one found keeps to their range.
TEST(Search, EndsAtAnElasticContact) {
  const RigFile rig = hybrid_rig("0.8 ms", {{"contact.damping", "exact"}});
  const RigFile start =
      hybrid_rig("0.8 ms", {{"contact.damping", "exact"}, {"contact.restitution", "0.9"}});
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Fit result =
        fit({synthetic_shot(rig, {.restitution = 1.0, .duration = 0.9e-3, .seed = seed})}, start);
    EXPECT_EQ(result.termination, "converged");
    const Parameter& e = tests::parameter(result, "contact.restitution");
    EXPECT_GT(e.value, 1.0 - 5.0 * std::max(e.std_error, 2e-4)) << seed;
    EXPECT_LT(std::abs(result.goodness.chi2 / static_cast<double>(result.goodness.dof) - 1.0),
              0.15);
  }
}

}  // namespace
}  // namespace impactrig::fitting
