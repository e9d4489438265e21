// SPDX-License-Identifier: BSD-3-Clause
#include "models/explain.hpp"

#include <algorithm>
#include <ctime>
#include <limits>
#include <stdexcept>

namespace impactrig::models {
namespace {

// Short runs are repeated for this long, and the quickest counts [s].
constexpr double timing_time = 0.02;

double processor_time() {
  std::timespec now = {};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct TimedRun {
  Simulation simulation;
  double seconds = std::numeric_limits<double>::infinity();
};

TimedRun timed(const Rig& rig, const Solver& solver, const SimulationOptions& options) {
  TimedRun run;
  const double begun = processor_time();
  do {
    const double before = processor_time();
    run.simulation = simulate(rig, solver, options);
    run.seconds = std::min(run.seconds, processor_time() - before);
  } while (processor_time() - begun < timing_time);
  return run;
}

void compare(const Simulation& run, const Simulation& without, Explanation& explanation) {
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  explanation.peak_force = explanation.duration = explanation.impulse = unknown;
  if (run.episodes.empty() || without.episodes.empty()) return;
  const Episode& a = run.episodes.front();
  const Episode& b = without.episodes.front();
  if (a.open || b.open) return;
  explanation.peak_force = a.peak_force / b.peak_force - 1.0;
  explanation.duration = (a.end - a.start) / (b.end - b.start) - 1.0;
  explanation.impulse = a.impulse / b.impulse - 1.0;
}

}  // namespace

std::string_view name(Simplification what) {
  switch (what) {
    case Simplification::small_motion:
      return "small motion";
    case Simplification::fast_vibration:
      return "fast vibration";
    case Simplification::swing_to_touch:
      return "swing to touch";
    case Simplification::flight_at_once:
      return "flight at once";
    case Simplification::hinge_friction:
      return "hinge friction";
  }
  return "?";
}

std::vector<Explanation> explain(const Rig& rig, const Solver& solver,
                                 const SimulationOptions& asked, double time_limit) {
  SimulationOptions options = asked;
  options.sensitivities.clear();  // of the full equations they take far longer than the run
  const TimedRun run = timed(rig, solver, options);
  std::vector<Explanation> explanations;
  for (std::size_t i = 0; i < run.simulation.taken.size(); ++i) {
    Explanation& explanation = explanations.emplace_back();
    explanation.what = run.simulation.taken[i];
    explanation.sentence = run.simulation.skipped[i];
    explanation.seconds = run.seconds;
    SimulationOptions kept = options;
    kept.kept.push_back(explanation.what);
    // steps of wide flights are no small motion, but it is the flights that are to be compared
    if (explanation.what == Simplification::flight_at_once) kept.motion = Motion::small;
    Solver limited = solver;
    limited.time_limit = std::min(time_limit, solver.time_limit);
    try {
      const TimedRun without = timed(rig, limited, kept);
      explanation.seconds_without = without.seconds;
      compare(run.simulation, without.simulation, explanation);
    } catch (const std::runtime_error& error) {
      explanation.failure = error.what();
    }
  }
  return explanations;
}

}  // namespace impactrig::models
