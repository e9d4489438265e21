// SPDX-License-Identifier: BSD-3-Clause
//
// Friction in the hinge, which small motion does not know: fitted by the full equations.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "fitting/fit.hpp"
#include "tests/fitting/fast_fit.hpp"

namespace impactrig::fitting {
namespace {

using tests::hybrid_rig;
using tests::parameter;
using tests::pull;
using tests::synthetic_shot;

FitOptions with_friction() {
  FitOptions options;
  options.free = {"contact.restitution", "start.velocity", "hinge.friction"};
  options.setting("hinge.friction").initial = 0.5;
  return options;
}

// A moment of 2 N m takes 4 m/s² off the closing bar at the struck point, and as much off the
// rebound.
TEST(FitHingeFriction, IsFoundWhereItShows) {
  const datasets::Impact shot =
      synthetic_shot(hybrid_rig("1.5 ms", {{"hinge.friction", "2 N.m"}}), {.duration = 1.6e-3});
  const Fit found = fit({shot}, hybrid_rig(), with_friction());
  const Parameter& p = parameter(found, "hinge.friction");
  EXPECT_TRUE(p.identifiable);
  EXPECT_LT(std::abs(pull(found, "hinge.friction", 2.0)), 3.0);
  EXPECT_LT(p.std_error, 0.5);
  EXPECT_LT(std::abs(pull(found, "contact.restitution", 0.5)), 3.0);
}

// Its error is what the noise makes of it, though its slopes are differences of simulations.
TEST(FitHingeFriction, ErrorIsRight) {
  tests::Pulls pulls;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const datasets::Impact shot = synthetic_shot(
        hybrid_rig("0.8 ms", {{"hinge.friction", "0.3 N.m"}}), {.duration = 0.9e-3, .seed = seed});
    FitOptions options = with_friction();
    options.for_report = false;
    const Fit found = fit({shot}, hybrid_rig("0.8 ms"), options);
    pulls.add(pull(found, "hinge.friction", 0.3));
  }
  EXPECT_LT(pulls.mean_square(), pulls.square_bounds()[1]);
  EXPECT_GT(pulls.mean_square(), pulls.square_bounds()[0]);
}

// What a bearing without friction leaves: an interval from its bound, 0, to what would have shown.
TEST(FitHingeFriction, OfNoneHasAnUpperLimit) {
  const datasets::Impact shot = synthetic_shot(hybrid_rig(), {.duration = 1.6e-3});
  const Fit found = fit({shot}, hybrid_rig(), with_friction());
  const Parameter& p = parameter(found, "hinge.friction");
  EXPECT_EQ(p.ci95[0], 0.0);
  EXPECT_GT(p.ci95[1], 0.0);
  EXPECT_LT(p.ci95[1], 0.05);
}

// The force alone hardly knows it, and its interval says so.
TEST(FitHingeFriction, IsHardlyToldByTheForce) {
  const datasets::Impact shot =
      synthetic_shot(hybrid_rig("0.8 ms", {{"hinge.friction", "0.3 N.m"}}), {.duration = 0.9e-3});
  FitOptions options = with_friction();
  options.use_velocity = false;
  const Fit found = fit({shot}, hybrid_rig("0.8 ms"), options);
  const Parameter& p = parameter(found, "hinge.friction");
  EXPECT_TRUE(!p.identifiable || (p.ci95[0] < 0.3 && p.ci95[1] > 0.3));
}

}  // namespace
}  // namespace impactrig::fitting
