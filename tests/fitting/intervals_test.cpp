// SPDX-License-Identifier: BSD-3-Clause
//
// Intervals beside the covariance's: profile likelihood and bootstrap.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "fitting/bootstrap.hpp"
#include "fitting/fit.hpp"
#include "fitting/profile.hpp"
#include "tests/fitting/fast_fit.hpp"

namespace impactrig::fitting {
namespace {

using tests::hybrid_rig;
using tests::parameter;
using tests::synthetic_shot;

datasets::Impact shot() {
  return synthetic_shot(hybrid_rig(), {.duration = 1.6e-3, .seed = 3});
}

/// χ² of data and priors with the restitution held.
double cost_with(const datasets::Impact& impact, double restitution) {
  RigFile rig = hybrid_rig();
  rig.rig.contact.restitution = restitution;
  FitOptions rest;
  rest.free = {"contact.stiffness_factor", "start.velocity"};
  const Fit fixed = fit({impact}, rig, rest);
  double cost = fixed.goodness.chi2;
  for (const Parameter& p : fixed.parameters)
    if (p.prior) cost += std::pow((p.value - (*p.prior)[0]) / (*p.prior)[1], 2);
  return cost;
}

// Δχ² = ((θ − θ̂) / s)², and 1.96 s to both sides. (The restitution is bent: 3 % on its upper side.)
TEST(Profile, OfANearlyLinearParameterIsTheParabola) {
  FitOptions options;
  options.profile = true;
  const Fit found = fit({shot()}, hybrid_rig(), options);
  ASSERT_EQ(found.profiles.size(), 5U);  // two delays besides
  for (const Profile& profile : found.profiles) {
    if (profile.name == "contact.restitution") continue;
    const Parameter& p = parameter(found, profile.name);
    EXPECT_FALSE(profile.found_better);
    ASSERT_TRUE(profile.lower && profile.upper) << profile.name;
    EXPECT_TRUE(std::ranges::is_sorted(profile.value)) << profile.name;
    EXPECT_NEAR((p.value - *profile.lower) / (1.959964 * p.std_error), 1.0, 0.01) << profile.name;
    EXPECT_NEAR((*profile.upper - p.value) / (1.959964 * p.std_error), 1.0, 0.01) << profile.name;
    for (std::size_t k = 0; k < profile.value.size(); ++k) {
      const double off = (profile.value[k] - p.value) / p.std_error;
      EXPECT_NEAR(std::sqrt(std::max(0.0, profile.delta_chi2[k])), std::abs(off),
                  0.01 * std::abs(off) + 0.01)
          << profile.name << " " << off;
    }
  }
}

// The stiffness of two bodies in contact is that of both together: of one alone, with the other
// free, the data know the least it may be, not the most.
TEST(Profile, IsOpenWhereTheDataDoNotBoundIt) {
  FitOptions options;
  options.free = {"contact.restitution", "start.velocity", "contact.modulus",
                  "contact.counter_modulus"};
  options.profile = true;
  const Fit found = fit({shot()}, hybrid_rig(), options);
  int open = 0;
  for (const Profile& profile : found.profiles) {
    if (!profile.name.ends_with("modulus")) continue;
    EXPECT_FALSE(profile.upper) << profile.name;
    open += profile.upper ? 0 : 1;
  }
  EXPECT_EQ(open, 2);
}

// Δχ² of the interval's ends, by hand: the other parameters fitted with this one fixed there.
TEST(Profile, EndsWhereChiSquareHasRisenByItsQuantile) {
  FitOptions options;
  options.profile = true;
  const datasets::Impact impact = shot();
  const Fit found = fit({impact}, hybrid_rig(), options);
  const Profile& profile = found.profiles.front();
  ASSERT_EQ(profile.name, "contact.restitution");
  const double least = cost_with(impact, parameter(found, "contact.restitution").value);
  EXPECT_NEAR(cost_with(impact, *profile.lower) - least, 3.841, 0.06);
  EXPECT_NEAR(cost_with(impact, *profile.upper) - least, 3.841, 0.06);
}

// Told a standard error that is a thousand times too large, the first step is beyond all: the
// limits are the same.
TEST(Profile, FindsItsLimitsFromAFirstStepThatIsFarTooLong) {
  const std::vector<datasets::Impact> impacts = {shot()};
  FitProblem problem(impacts, hybrid_rig(), {});
  problem.choose_samples(std::numeric_limits<double>::infinity());
  problem.set_motion(models::Motion::small);
  problem.search({.tolerance = 1e-7});
  const auto place = std::ranges::find(problem.variables(), "contact.restitution", &Variable::name);
  const std::vector<std::size_t> number = {
      static_cast<std::size_t>(place - problem.variables().begin())};
  const Profile right = profiles(problem, number, {6e-5}, 1.0).front();
  const Profile lost = profiles(problem, number, {6e-2}, 1.0).front();
  ASSERT_TRUE(right.lower && right.upper && lost.lower && lost.upper);
  const double width = *right.upper - *right.lower;
  EXPECT_NEAR(*lost.lower, *right.lower, 0.02 * width);
  EXPECT_NEAR(*lost.upper, *right.upper, 0.02 * width);
}

// The law has e by its square: from a truth of 0 its slope is none, and a covariance has it that e
// may be anything. The likelihood knows better.
TEST(Intervals, OfARestitutionOfNothingAreOneSided) {
  int at_bound = 0;
  for (const unsigned seed : {3U, 4U, 5U}) {
    const datasets::Impact impact =
        synthetic_shot(hybrid_rig(), {.restitution = 0.0, .duration = 1.6e-3, .seed = seed});
    const Fit found = fit({impact}, hybrid_rig(), {});
    const Parameter& e = parameter(found, "contact.restitution");
    if (!e.at_bound) continue;
    ++at_bound;
    EXPECT_EQ(e.ci95[0], 0.0);
    EXPECT_GT(e.ci95[1], 0.0);
    EXPECT_LT(e.ci95[1], 0.1);
    EXPECT_NEAR(cost_with(impact, e.ci95[1]) - cost_with(impact, 0.0), 3.841, 0.2);
    EXPECT_DOUBLE_EQ(e.std_error, e.ci95[1] / 1.959963984540054);
    EXPECT_EQ(found.restitution.at("law").ci95, e.ci95);
    EXPECT_THAT(found.warnings,
                testing::Contains(testing::StartsWith(
                    "contact.restitution ended at its bound 0, from which the data do not tell "
                    "it. Its interval, to 0.0")));
  }
  EXPECT_GE(at_bound, 1);
}

// Draws pile up at the bound on which the fit ended: mirrored about it they make an interval of no
// width, or of the one side that is not possible.
TEST(Bootstrap, IsNotMirroredAtABound) {
  int piled = 0;
  for (const unsigned seed : {3U, 4U, 5U}) {
    FitOptions options;
    options.bootstrap = 100;
    const Fit found =
        fit({synthetic_shot(hybrid_rig(), {.restitution = 0.0, .duration = 1.6e-3, .seed = seed})},
            hybrid_rig(), options);
    ASSERT_TRUE(found.bootstrap);
    const auto e = std::ranges::find(found.bootstrap->parameters, "contact.restitution",
                                     &Bootstrap::Parameter::name);
    std::vector<double> draws = e->draws;
    std::ranges::sort(draws);
    EXPECT_LE(e->ci95[0], draws[3]);  // 3 of 100 below it
    EXPECT_NEAR(e->ci95[1], draws[97], draws[98] - draws[96] + 1e-12);
    EXPECT_GT(e->ci95[1], 0.0);
    if (found.bootstrap->at_bounds.empty()) continue;
    ++piled;
    EXPECT_THAT(found.bootstrap->at_bounds, testing::ElementsAre("contact.restitution"));
    EXPECT_EQ(e->ci95[0], 0.0);
    EXPECT_THAT(found.warnings,
                testing::Contains(testing::StartsWith(
                    "Fits of the bootstrap end with contact.restitution at a bound")));
  }
  EXPECT_GE(piled, 1);
}

// 300 draws know a standard deviation to 1 / √600 = 4.1 %; bound at four of that.
TEST(Bootstrap, AgreesWithTheCovariance) {
  for (const BootstrapKind kind : {BootstrapKind::parametric, BootstrapKind::residual}) {
    FitOptions options;
    options.bootstrap = 300;
    options.bootstrap_kind = kind;
    const Fit found = fit({shot()}, hybrid_rig(), options);
    ASSERT_TRUE(found.bootstrap);
    EXPECT_EQ(found.bootstrap->failed, 0);
    ASSERT_EQ(found.bootstrap->parameters.size(), 5U);
    for (const Bootstrap::Parameter& drawn : found.bootstrap->parameters) {
      const Parameter& p = parameter(found, drawn.name);
      EXPECT_EQ(drawn.draws.size(), 300U);
      // the residuals are of one shot, of which few samples tell the restitution
      const double bound = kind == BootstrapKind::parametric ? 0.165 : 0.5;
      EXPECT_NEAR(drawn.std_error / p.std_error, 1.0, bound) << drawn.name << " " << name(kind);
      EXPECT_LT(std::abs(drawn.bias), 4.0 * p.std_error / std::sqrt(300.0)) << drawn.name;
      EXPECT_NEAR(drawn.ci95[1] - drawn.ci95[0], 2.0 * 1.96 * drawn.std_error,
                  0.6 * drawn.std_error);
    }
  }
}

// Gains and delays have every kind of interval; what their certificates say of them counts in each.
TEST(Intervals, AreOfTheSensorsToo) {
  datasets::Impact impact = shot();
  impact.force->gain_uncertainty = 0.005;
  FitOptions options;
  options.profile = true;
  options.bootstrap = 300;
  const Fit found = fit({impact}, hybrid_rig(), options);
  for (const char* name : {"sensors.force.gain", "sensors.velocity.delay"}) {
    const Parameter& p = parameter(found, name);
    const auto profile = std::ranges::find(found.profiles, name, &Profile::name);
    ASSERT_NE(profile, found.profiles.end()) << name;
    EXPECT_NEAR((*profile->upper - *profile->lower) / (2.0 * 1.959964 * p.std_error), 1.0, 0.02)
        << name;
    const auto drawn =
        std::ranges::find(found.bootstrap->parameters, name, &Bootstrap::Parameter::name);
    ASSERT_NE(drawn, found.bootstrap->parameters.end()) << name;
    EXPECT_NEAR(drawn->std_error / p.std_error, 1.0, 0.165) << name;
  }
}

// Where the noise before touch hardly tells its size intervals are Student's, but no wider than what
// a certificate says.
TEST(Intervals, AreNoWiderThanWhatIsKnownBefore) {
  const datasets::Impact impact =
      tests::synthetic_shot(hybrid_rig(), {.noise_memory = 0.99, .duration = 1.6e-3});
  const Fit found = fit({impact}, hybrid_rig());
  const auto half = [](const Parameter& p) { return 0.5 * (p.ci95[1] - p.ci95[0]); };
  const Parameter& e = parameter(found, "contact.restitution");
  ASSERT_GT(half(e), 2.5 * e.std_error);
  for (const char* name : {"sensors.force.delay", "sensors.velocity.delay"}) {
    const Parameter& p = parameter(found, name);
    ASSERT_TRUE(p.prior) << name;
    const double known = std::max((*p.prior)[1], p.std_error);
    EXPECT_LE(half(p) - p.mesh_error, 1.97 * known) << name;
    EXPECT_GE(half(p), 1.95 * p.std_error) << name;
  }
}

// By its logarithm a parameter is drawn about by factors.
TEST(Bootstrap, OfAParameterByItsLogarithmGoesByFactors) {
  FitOptions options;
  options.bootstrap = 39;
  options.setting("start.velocity").by_logarithm = true;
  const Fit found = fit({shot()}, hybrid_rig(), options);
  const auto drawn =
      std::ranges::find(found.bootstrap->parameters, "start.velocity", &Bootstrap::Parameter::name);
  const auto [least, most] = std::ranges::minmax(drawn->draws);
  const double best = parameter(found, "start.velocity").value;
  EXPECT_NEAR(drawn->ci95[0], best * best / most, 1e-12 * best);
  EXPECT_NEAR(drawn->ci95[1], best * best / least, 1e-12 * best);
}

// Between the least and the largest of 39 draws lies a fortieth with probability 38 / 40.
TEST(Bootstrap, OfThirtyNineDrawsTakesTheOutermost) {
  FitOptions options;
  options.bootstrap = 39;
  const Fit found = fit({shot()}, hybrid_rig(), options);
  for (const Bootstrap::Parameter& drawn : found.bootstrap->parameters) {
    const auto [least, most] = std::ranges::minmax(drawn.draws);
    const double best = parameter(found, drawn.name).value;
    EXPECT_NEAR(drawn.ci95[0], 2.0 * best - most, 1e-12 * best) << drawn.name;
    EXPECT_NEAR(drawn.ci95[1], 2.0 * best - least, 1e-12 * best) << drawn.name;
  }
}

std::vector<double> draws(std::uint64_t seed) {
  FitOptions options;
  options.bootstrap = 12;
  options.seed = seed;
  return fit({shot()}, hybrid_rig(), options).bootstrap->parameters.front().draws;
}

TEST(Bootstrap, OfFewDrawsHasNoInterval) {
  for (const int count : {38, 39}) {
    FitOptions options;
    options.bootstrap = count;
    const Fit found = fit({shot()}, hybrid_rig(), options);
    ASSERT_EQ(found.bootstrap->failed, 0);
    const Bootstrap::Parameter& drawn = found.bootstrap->parameters.front();
    EXPECT_GT(drawn.std_error, 0.0);
    EXPECT_EQ(drawn.ci95[1] > drawn.ci95[0], count == 39);
    const auto told = testing::Contains(testing::StartsWith("38 draws of the bootstrap"));
    if (count == 39)
      EXPECT_THAT(found.warnings, testing::Not(told));
    else
      EXPECT_THAT(found.warnings, told);
  }
}

// A draw depends on seed and number alone. One processor alone makes one worker of them.
TEST(Bootstrap, OfTheSameSeedIsTheSame) {
  const std::vector<double> once = draws(5);
  EXPECT_EQ(once, draws(5));
  EXPECT_NE(once, draws(6));
  cpu_set_t all, one;
  ASSERT_EQ(sched_getaffinity(0, sizeof all, &all), 0);
  CPU_ZERO(&one);
  for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu)
    if (CPU_ISSET(cpu, &all)) {
      CPU_SET(cpu, &one);
      break;
    }
  ASSERT_EQ(sched_setaffinity(0, sizeof one, &one), 0);
  const std::vector<double> alone = draws(5);
  sched_setaffinity(0, sizeof all, &all);
  EXPECT_EQ(once, alone);
}

TEST(Bootstrap, IsCalledByItsKind) {
  for (const BootstrapKind kind : {BootstrapKind::parametric, BootstrapKind::residual})
    EXPECT_EQ(bootstrap_named(name(kind)), kind);
  try {
    bootstrap_named("jackknife");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(),
                 "there is no bootstrap 'jackknife'; there are parametric and residual");
  }
}

}  // namespace
}  // namespace impactrig::fitting
