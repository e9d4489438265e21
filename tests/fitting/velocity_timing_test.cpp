// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/velocity_timing.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "models/simulation.hpp"
#include "tests/fitting/synthetic_shot.hpp"

namespace impactrig::fitting {
namespace {

using datasets::Impact;
using datasets::ImpactSignal;
using testing::HasSubstr;

RigFile paper() {
  RigFile file = parse_rig_file(tests::paper_rig, "rig.toml");
  file.solver.accuracy = 1e-4;
  return file;
}

/// What the rig shows 0.5 ms before touch and 1.5 ms after it, the velocity so much too late [s].
Impact shot(const RigFile& file, double late) {
  models::SimulationOptions options;
  options.history.interval = 1e-6;
  models::Solver solver = file.solver;
  solver.duration = 1.5e-3;
  const models::Simulation run = models::simulate(file.rig, solver, options);
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, 1e-3);
  Impact impact;
  impact.trigger = "Force";
  impact.start = 0.0;
  impact.end = run.episodes.front().end;
  ImpactSignal force, velocity;
  force.channel = "Force";
  velocity.channel = "Velocity";
  force.interval = velocity.interval = 1e-6;
  force.start = velocity.start = -500e-6;
  velocity.noise = 1e-3;
  const auto at = [&](const std::vector<double>& values, double t, double before) {
    const auto i = static_cast<long>(std::lround((t - run.history.start) / 1e-6));
    if (t < 0.0 || i < 0) return before;
    return i < static_cast<long>(values.size()) ? values[static_cast<std::size_t>(i)] : 0.0;
  };
  for (int k = 0; k < 1900; ++k) {
    const double t = -500e-6 + 1e-6 * k;
    force.values.push_back(at(run.history.force, t, 0.0));
    velocity.values.push_back(at(run.history.velocity, t - late, file.rig.start.velocity) +
                              noise(random));
  }
  impact.force = force;
  impact.velocity = velocity;
  return impact;
}

TEST(VelocityTiming, OfAnEarlyVelocityIsTold) {
  const RigFile file = paper();
  for (const double early : {250e-6, 300e-6, 400e-6}) {
    const std::string sentence = velocity_out_of_time(shot(file, -early), file);
    ASSERT_THAT(sentence, HasSubstr("'Velocity' leaves its course some ")) << early;
    EXPECT_NEAR(std::stod(sentence.substr(34)), 1e6 * early, 60.0) << sentence;
  }
}

TEST(VelocityTiming, IsTold) {
  const RigFile file = paper();
  for (const double late : {200e-6, 300e-6, 1e-3}) {
    const std::string sentence = velocity_out_of_time(shot(file, late), file);
    ASSERT_THAT(sentence, HasSubstr("'Velocity' keeps its course until ")) << late;
    EXPECT_NEAR(std::stod(sentence.substr(34)), 1e6 * late, 15.0) << sentence;
    EXPECT_THAT(sentence, HasSubstr("after 'Force' rises"));
  }
}

// Where it must not fire: right records of any law and damping, and delays that a fit can follow.
TEST(VelocityTiming, IsNotToldOfRightRecords) {
  for (const char* law : {"goldsmith", "johnson", "hertz-point"})
    for (const double restitution : {0.05, 0.5, 1.0})
      for (const double position : {0.3, 0.85, 0.97}) {
        RigFile file = paper();
        file.rig.contact.law = law;
        file.rig.contact.restitution = restitution;
        file.rig.contact.position = position * file.rig.beam.length;
        for (const double late : {0.0, -20e-6, 20e-6})
          EXPECT_EQ(velocity_out_of_time(shot(file, late), file), "")
              << law << " " << restitution << " " << position << " " << late;
      }
}

TEST(VelocityTiming, IsNotToldWhereItCannotBe) {
  RigFile file = paper();
  const Impact late = shot(file, 300e-6);
  ASSERT_NE(velocity_out_of_time(late, file), "");
  Impact short_before = late;
  short_before.velocity->values.erase(short_before.velocity->values.begin(),
                                      short_before.velocity->values.begin() + 490);
  short_before.velocity->start += 490e-6;
  EXPECT_EQ(velocity_out_of_time(short_before, file), "");
  Impact noisy = late;
  noisy.velocity->noise = 0.1;
  EXPECT_EQ(velocity_out_of_time(noisy, file), "");
  Impact by_velocity = late;
  by_velocity.trigger = "Velocity";
  EXPECT_EQ(velocity_out_of_time(by_velocity, file), "");
  datasets::Sensor laser;
  laser.quantity = datasets::Quantity::velocity;
  laser.position = file.rig.contact.position;
  RigFile other = file;
  other.velocity = laser;
  EXPECT_NE(velocity_out_of_time(late, other), "");
  other.velocity->position = 0.4;
  EXPECT_EQ(velocity_out_of_time(late, other), "");
  other.velocity = laser;
  other.velocity->high_cut = datasets::BandLimit{1e3, 2};
  EXPECT_EQ(velocity_out_of_time(late, other), "");
}

}  // namespace
}  // namespace impactrig::fitting
