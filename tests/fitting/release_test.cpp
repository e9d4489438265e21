// SPDX-License-Identifier: BSD-3-Clause
//
// A bar that is let go: fits take its speed at touch from the data.
#include <gmock/gmock.h>

#include <array>

#include "fitting/fit.hpp"
#include "models/rig.hpp"
#include "tests/fitting/fast_fit.hpp"

namespace impactrig::fitting {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;
using tests::hybrid_rig;
using tests::parameter;
using tests::synthetic_shot;

constexpr const char* warned = "Letting a straight bar go leaves vibration of up to";

RigFile released() {
  RigFile file = hybrid_rig("0.8 ms");
  file.rig.gravity = 9.81;
  file.rig.start = {};
  file.rig.start.release_angle = 0.15;
  return file;
}

/// A shot with the speed of the release, and its fit.
Fit fitted(const RigFile& file, double noise) {
  RigFile touching = file;
  touching.rig.start.release_angle.reset();
  const double speed = models::touch_velocity(file.rig);
  const datasets::Impact shot = synthetic_shot(touching, {.velocity = speed,
                                                          .force_noise = 2.0 * noise,
                                                          .velocity_noise = 1e-3 * noise,
                                                          .duration = 0.9e-3});
  const Fit found = fit({shot}, file, {});
  EXPECT_NEAR(parameter(found, "start.velocity").value, speed, 0.02);
  return found;
}

TEST(FitOfARelease, WarnsOfVibrationThatItDoesNotKnow) {
  EXPECT_THAT(fitted(released(), 0.2).warnings, Contains(HasSubstr(warned)));
}

TEST(FitOfARelease, LeavesItInPeaceWhereNoiseIsMoreOrVibrationHasDied) {
  EXPECT_THAT(fitted(released(), 20.0).warnings, Not(Contains(HasSubstr(warned))));
  RigFile damped = released();
  damped.rig.beam.damping.stiffness = 1e-4;
  EXPECT_THAT(fitted(damped, 0.2).warnings, Not(Contains(HasSubstr(warned))));
}

// A laser that shows 0.1 m/s at rest, or a model that wants it so.
TEST(FitOfAVelocity, WarnsOfAZeroThatWasMovedFar) {
  constexpr const char* moved = "the fit moved the laser's zero by that";
  datasets::Impact shot = synthetic_shot(hybrid_rig("0.8 ms"), {.duration = 0.9e-3});
  EXPECT_THAT(fit({shot}, hybrid_rig("0.8 ms"), {}).warnings, Not(Contains(HasSubstr(moved))));
  for (double& value : shot.velocity->values) value += 0.1;
  FitOptions options;
  options.setting("start.velocity").prior = std::array{0.441, 0.001};
  EXPECT_THAT(fit({shot}, hybrid_rig("0.8 ms"), options).warnings, Contains(HasSubstr(moved)));
}

}  // namespace
}  // namespace impactrig::fitting
