// SPDX-License-Identifier: BSD-3-Clause
#include "tests/models/differences.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "tests/models/scenes.hpp"

namespace impactrig::tests {

using namespace models;

namespace {

/// What is differentiated, one number after the other.
std::vector<double> numbers(const Simulation& run) {
  const Episode& e = run.episodes.front();
  return {e.peak_force,
          e.max_penetration,
          e.end,
          e.impulse,
          e.separation_velocity,
          run.restitution.kinematic,
          run.restitution.kinetic,
          run.restitution.energetic,
          run.sensor ? run.sensor->peak_force : 1.0};
}

std::vector<double> numbers(const Sensitivity& s) {
  return {s.peak_force,
          s.max_penetration,
          s.duration,
          s.impulse,
          s.separation_velocity,
          s.restitution.kinematic,
          s.restitution.kinetic,
          s.restitution.energetic,
          s.sensor_peak_force};
}

/// Of the force's jumps, one after the other.
std::vector<double> jumps(const History& history) {
  std::vector<double> all;
  for (const ForceJump& jump : history.jumps)
    all.insert(all.end(), {jump.time, jump.before, jump.after});
  return all;
}

/// What a history shows, one channel after the other.
std::vector<std::vector<double>> channels(const History& history) {
  std::vector<std::vector<double>> all = {history.force, history.penetration, history.velocity,
                                          history.displacement};
  if (!history.sensor_force.empty()) all.push_back(history.sensor_force);
  for (const StopHistory& stop : history.further) {
    all.push_back(stop.force);
    all.push_back(stop.penetration);
  }
  return all;
}

double size_for(const Rig& rig, const Named& parameter) {
  Rig copy = rig;
  const std::string name = parameter.name;
  if (name == "position" || name == "beam length") return copy.beam.length - copy.contact.position;
  if (name == "gravity direction") return 1.0;
  if (name == "first length" || name == "last length") return 0.1;
  if (name == "its position") return copy.beam.length - parameter.of(copy);
  return name.ends_with("radius") ? copy.contact.counter_radius - copy.contact.radius
                                  : parameter.of(copy);
}

/// Differences of simulations by a parameter.
struct Differences {
  std::vector<double> numbers, jumps;
  std::vector<std::vector<double>> channels;
};

/// Of the sixth order.
struct Stencil6 {
  std::vector<double> offsets, weights;  // of a sixtieth

  static Stencil6 to(Side side) {
    if (side == Side::both)
      return {{-3.0, -2.0, -1.0, 1.0, 2.0, 3.0}, {-1.0, 9.0, -45.0, 45.0, -9.0, 1.0}};
    Stencil6 above{{0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0},
                   {-147.0, 360.0, -450.0, 400.0, -225.0, 72.0, -10.0}};
    if (side == Side::below)
      for (std::vector<double>* values : {&above.offsets, &above.weights})
        for (double& value : *values) value = -value;
    return above;
  }
};

/// A bar is as long as its segments.
Rig moved(const Rig& rig, const Named& parameter, double by) {
  Rig there = rig;
  parameter.of(there) += by;
  for (std::size_t i = 0; i < rig.beam.segments.size(); ++i)
    there.beam.length += there.beam.segments[i].length - rig.beam.segments[i].length;
  return there;
}

Differences differences(const Rig& rig, const Solver& solver, const Named& parameter, double step,
                        Motion motion, Side side) {
  const auto [offsets, weights] = Stencil6::to(side);
  const double spacing = step * size_for(rig, parameter);
  Differences sum;
  for (std::size_t j = 0; j < weights.size(); ++j) {
    const Simulation run = sharp(moved(rig, parameter, offsets[j] * spacing), solver, motion);
    const double weight = weights[j] / (60.0 * spacing);
    const std::vector<double> values = numbers(run);
    sum.numbers.resize(values.size(), 0.0);
    for (std::size_t k = 0; k < values.size(); ++k) sum.numbers[k] += weight * values[k];
    const std::vector<double> jumped = jumps(run.history);
    sum.jumps.resize(jumped.size(), 0.0);
    for (std::size_t k = 0; k < jumped.size(); ++k) sum.jumps[k] += weight * jumped[k];
    const std::vector<std::vector<double>> parts = channels(run.history);
    sum.channels.resize(parts.size());
    for (std::size_t c = 0; c < parts.size(); ++c) {
      sum.channels[c].resize(parts[c].size(), 0.0);
      for (std::size_t k = 0; k < parts[c].size(); ++k) sum.channels[c][k] += weight * parts[c][k];
    }
  }
  return sum;
}

/// Whether the force begins or ends within ten samples: the differences straddle the corner.
bool beside_event(const std::vector<double>& force, std::size_t sample) {
  const std::size_t first = sample < 10 ? 0 : sample - 10;
  const std::size_t last = std::min(sample + 11, force.size());
  const auto pressed = std::count_if(force.begin() + static_cast<std::ptrdiff_t>(first),
                                     force.begin() + static_cast<std::ptrdiff_t>(last),
                                     [](double f) { return f > 0.0; });
  return pressed > 0 && pressed < static_cast<std::ptrdiff_t>(last - first);
}

/// At any stop.
bool beside_event(const Simulation& run, std::size_t sample) {
  return beside_event(run.history.force, sample) ||
         std::ranges::any_of(run.history.further, [&](const StopHistory& stop) {
           return beside_event(stop.force, sample);
         });
}

}  // namespace

Rig damped_rig() {
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  rig.contact.damping = "lankarani-nikravesh";
  rig.contact.restitution = 0.5;
  return rig;
}

Rig stepped_rig() {
  Rig rig = damped_rig();
  const BeamSegment whole{
      .length = 0.8, .area = rig.beam.area, .second_moment = rig.beam.second_moment};
  rig.beam.segments = {whole, whole};
  rig.beam.segments[0].length = 0.45;
  rig.beam.segments[1].length = 0.35;
  rig.beam.segments[1].area *= 0.8;
  rig.beam.segments[1].second_moment *= 0.6;
  rig.beam.segments[1].youngs_modulus = 0.9 * rig.beam.youngs_modulus;
  rig.beam.segments[1].density = 0.95 * rig.beam.density;
  for (BeamSegment& segment : rig.beam.segments) segment.shear_coefficient = 0.9;
  return rig;
}

Simulation sharp(const Rig& rig, Solver solver, Motion motion, std::vector<RigParameter> by) {
  solver.accuracy = 1e-12;
  SimulationOptions options;
  options.motion = motion;
  options.exact = motion == Motion::full;
  options.history = {
      .interval = 5e-6, .lead = 2e-5, .velocity_position = 0.6, .displacement_position = 0.35};
  options.sensitivities = std::move(by);
  return simulate(rig, solver, options);
}

void expect_equal_derivatives(const Rig& rig, const Solver& solver, double tolerance,
                              std::span<const Named> of, double spacing, Motion motion, Side side) {
  std::vector<RigParameter> by;
  for (const Named& parameter : of) by.push_back(parameter.of);
  const Simulation run = sharp(rig, solver, motion, by);
  ASSERT_EQ(run.sensitivities.size(), of.size());
  const std::vector<double> values = numbers(run);
  for (std::size_t i = 0; i < of.size(); ++i) {
    SCOPED_TRACE(of[i].name);
    const double size = size_for(rig, of[i]);
    const Differences d = differences(rig, solver, of[i], spacing, motion, side);
    const std::vector<double> slopes = numbers(run.sensitivities[i]);
    for (std::size_t k = 0; k < slopes.size(); ++k)
      EXPECT_NEAR(slopes[k] * size / values[k], d.numbers[k] * size / values[k], tolerance) << k;
    const std::vector<double> jumped = jumps(run.sensitivities[i].history);
    ASSERT_EQ(jumped.size(), jumps(run.history).size());
    ASSERT_EQ(jumped.size(), d.jumps.size());
    for (std::size_t k = 0; k < jumped.size(); ++k) {
      const double scale = k % 3 == 0 ? run.episodes.front().end : run.peak_force;
      EXPECT_NEAR(jumped[k] * size / scale, d.jumps[k] * size / scale, 10.0 * tolerance) << k;
    }
    const std::vector<std::vector<double>> mine = channels(run.sensitivities[i].history);
    const std::vector<std::vector<double>> shown = channels(run.history);
    ASSERT_EQ(mine.size(), shown.size());
    for (std::size_t c = 0; c < mine.size(); ++c) {
      ASSERT_EQ(mine[c].size(), shown[c].size()) << c;
      double scale = 0.0, worst = 0.0;
      std::size_t at = 0;
      for (std::size_t k = 0; k < mine[c].size(); ++k) {
        if (beside_event(run, k)) continue;
        scale = std::max(scale, std::abs(shown[c][k]));
        if (const double off = std::abs(mine[c][k] - d.channels[c][k]); off > worst) {
          worst = off;
          at = k;
        }
      }
      // fast vibration after the contact: a change of its frequency is a large one of its phase
      EXPECT_LT(worst * size / scale, 30.0 * tolerance) << "channel " << c << ", sample " << at;
    }
  }
}

}  // namespace impactrig::tests
