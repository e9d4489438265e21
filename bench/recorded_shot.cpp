// SPDX-License-Identifier: BSD-3-Clause
#include "bench/recorded_shot.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <utility>

#include "acquisition/random_stream.hpp"
#include "fitting/force_curve.hpp"
#include "models/simulation.hpp"

namespace impactrig::bench {
namespace {

constexpr double margin = 50e-6;  // of the truth beyond the recording [s]
constexpr double finer = 20.0;    // than the recording's samples

}  // namespace

acquisition::SensorSet sensors_of(const fitting::RigFile& rig) {
  return {rig.force, rig.velocity, rig.displacement};
}

std::vector<fitting::Override> overrides(const std::vector<std::string>& assignments) {
  std::vector<fitting::Override> list;
  for (const std::string& text : assignments) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) throw CLI::ValidationError("--set", "needs key=value");
    list.push_back({text.substr(0, equals), text.substr(equals + 1)});
  }
  return list;
}

void draw_truth(std::uint64_t seed, models::Rig& rig) {
  acquisition::RandomStream random(seed, "truth");
  rig.contact.restitution = random.uniform(0.3, 0.8);
  rig.contact.stiffness_factor = random.uniform(0.8, 1.25);
  rig.start.velocity = random.uniform(0.3, 0.5);
}

RecordedShot record_shot(const fitting::RigFile& rig, const Recording& how) {
  models::SimulationOptions request;
  request.history = {.interval = 1.0 / (finer * how.sample_rate), .lead = how.pre_trigger + margin};
  if (rig.velocity) request.history.velocity_position = rig.velocity->position;
  models::Solver solver = rig.solver;
  solver.duration = how.duration - how.pre_trigger + margin;
  solver.accuracy = how.accuracy;
  const models::Simulation truth = models::simulate(rig.rig, solver, request);
  const models::History& h = truth.history;
  datasets::SampledCurve force = fitting::force_curve(h);
  const acquisition::Trajectory trajectory = {.start = h.start,
                                              .interval = h.interval,
                                              .force = std::move(force.values),
                                              .velocity = h.velocity,
                                              .displacement = h.displacement,
                                              .force_jumps = std::move(force.jumps),
                                              .force_spikes = std::move(force.spikes)};
  const acquisition::SensorSet sensors = sensors_of(rig);
  RecordedShot shot;
  shot.options = how.day(sensors, acquisition::shown_peaks(trajectory, sensors));
  shot.options.sample_rate = how.sample_rate;
  shot.options.pre_trigger = how.pre_trigger;
  shot.options.duration = how.duration;
  if (how.change) how.change(shot.options, truth.peak_force);
  shot.record = acquisition::synthesise(trajectory, sensors, shot.options);
  return shot;
}

}  // namespace impactrig::bench
