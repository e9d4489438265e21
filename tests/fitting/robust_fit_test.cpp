// SPDX-License-Identifier: BSD-3-Clause
//
// Fits of data whose noise is not white, or not normal: what they state must hold.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "fitting/fit.hpp"
#include "tests/fitting/fast_fit.hpp"

namespace impactrig::fitting {
namespace {

using tests::hybrid_rig;
using tests::parameter;
using tests::pull;
using tests::Pulls;
using tests::synthetic_shot;

constexpr double speed = 0.441;  // [m/s], of every shot

/// 2 % of the samples after first touch, drawn, are off by 30 standard deviations either way.
void spoil(datasets::ImpactSignal& signal, double touch, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> uniform;
  for (std::size_t k = 0; k < signal.values.size(); ++k)
    if (signal.time(k) > touch && uniform(generator) < 0.02)
      signal.values[k] += (uniform(generator) < 0.5 ? -30.0 : 30.0) * signal.noise;
}

/// Faster still: no vibration, and no more than the contact of 0.2 ms and what follows it.
RigFile rigid_rig() {
  return hybrid_rig("0.4 ms", {{"solver.model", "rigid"}});
}

datasets::Impact spoilt_shot(const RigFile& rig, std::uint64_t seed) {
  datasets::Impact shot = synthetic_shot(rig, {.duration = 0.5e-3, .seed = seed});
  spoil(*shot.force, shot.start, 1000 + seed);
  spoil(*shot.velocity, shot.start, 2000 + seed);
  return shot;
}

struct Study {
  Pulls pulls;
  double error = 0.0;  // root mean square, of the restitution
};

Study study(Loss loss, std::uint64_t shots) {
  const RigFile rig = rigid_rig();
  FitOptions options;
  options.loss = loss;
  Study result;
  for (std::uint64_t seed = 1; seed <= shots; ++seed) {
    const Fit found = fit({spoilt_shot(rig, seed)}, rig, options);
    EXPECT_EQ(found.termination, "converged") << name(loss) << ", seed " << seed;
    result.pulls.add(pull(found, "contact.restitution", 0.5));
    result.error += std::pow(parameter(found, "contact.restitution").value - 0.5, 2);
  }
  result.error = std::sqrt(result.error / static_cast<double>(shots));
  return result;
}

// The variance of 2 % at 30 σ is 1 + 0.02 · 900 = 19 σ²: squares are off by 4.4 times what the
// noise alone allows, the others hardly more than that. tukey must not take a peak that is a few
// microseconds early for outliers: searched with from afar, it left errors of 11 σ in 2 of 40
// shots.
TEST(RobustFit, RecoversTheTruthAmongOutliers) {
  const Study squares = study(Loss::squares, 15);
  for (const Loss loss : {Loss::huber, Loss::tukey}) {
    const Study robust = study(loss, 40);
    EXPECT_GT(squares.error, 2.0 * robust.error) << name(loss);
    EXPECT_LT(std::abs(robust.pulls.mean()), robust.pulls.mean_bound()) << name(loss);
    EXPECT_GT(robust.pulls.mean_square(), robust.pulls.square_bounds()[0]) << name(loss);
    EXPECT_LT(robust.pulls.mean_square(), robust.pulls.square_bounds()[1]) << name(loss);
    RecordProperty("error " + std::string(name(loss)), std::to_string(robust.error));
  }
}

TEST(RobustFit, MakesNoProfileAndSaysSo) {
  const RigFile rig = hybrid_rig();
  FitOptions options;
  options.loss = Loss::tukey;
  options.profile = true;
  const Fit found = fit({synthetic_shot(rig, {.duration = 1.6e-3})}, rig, options);
  EXPECT_TRUE(found.profiles.empty());
  EXPECT_THAT(found.warnings,
              testing::Contains("No profile likelihood was made: a likelihood goes with the loss "
                                "squares, not with tukey."));
  EXPECT_TRUE(std::isnan(found.goodness.aicc));  // these are of a likelihood too
  EXPECT_TRUE(std::isnan(found.goodness.bic));
}

// x_t = 0.9 x_{t−1} + e_t on both channels: 19 samples tell as much as one. Were it taken for
// white, pulls would have a mean square of about 19 at low frequencies.
TEST(ColouredNoise, PullsAreStandardNormal) {
  const RigFile rig = hybrid_rig();
  Pulls restitution, velocity;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const Fit found =
        fit({synthetic_shot(rig, {.noise_memory = 0.9, .duration = 1.6e-3, .seed = seed})}, rig);
    restitution.add(pull(found, "contact.restitution", 0.5));
    velocity.add(pull(found, "start.velocity", speed));
  }
  for (const Pulls& pulls : {restitution, velocity}) {
    EXPECT_LT(std::abs(pulls.mean()), pulls.mean_bound());
    EXPECT_GT(pulls.mean_square(), pulls.square_bounds()[0]);
    EXPECT_LT(pulls.mean_square(), pulls.square_bounds()[1]);
  }
}

// χ² of whitened residuals: its mean is the degrees of freedom, its deviation √(2 dof) and what
// the noise model, learnt from 1000 samples, is off.
TEST(ColouredNoise, ChiSquareIsThatOfIndependentSamples) {
  const RigFile rig = hybrid_rig();
  const Fit found =
      fit({synthetic_shot(rig, {.noise_memory = 0.9, .duration = 1.6e-3, .seed = 4})}, rig);
  EXPECT_GT(found.goodness.dof, 4500);  // all samples count
  EXPECT_NEAR(found.goodness.chi2 / static_cast<double>(found.goodness.dof), 1.0, 0.1);
}

}  // namespace
}  // namespace impactrig::fitting
