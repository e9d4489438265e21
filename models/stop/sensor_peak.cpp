// SPDX-License-Identifier: BSD-3-Clause
#include "models/stop/sensor_peak.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>

namespace impactrig::models {
namespace {

// Ratio of the accuracies that are compared.
constexpr double coarser = 10.0;
// Of the time of the largest force, until when it is looked for again.
constexpr double beyond = 1.1;

/// The touch after which the sensor carried most: 1 for the first.
long contact_of_peak(const Simulation& run) {
  return std::ranges::count_if(
      run.episodes, [&](const Episode& episode) { return episode.start < run.sensor->peak_time; });
}

std::string warning_of(const Simulation& run, std::optional<double> change) {
  const std::string found =
      change ? fmt::format("changes by {:.1e} when it is solved {:g} times less accurately",
                           *change, coarser)
             : std::string("could not be solved again to see how far it is known");
  return fmt::format(
      "the sensor carries most, {:.6g} N, {:.4g} s after first touch, in contact {}, and that {}: "
      "each contact magnifies the errors of those before it. What it carries up to {:.4g} "
      "s, when the second begins, does not depend on them; state such a solver.duration, or damp "
      "contact or stop.",
      run.sensor->peak_force, run.sensor->peak_time, contact_of_peak(run), found,
      run.episodes[1].start);
}

}  // namespace

void confirm_sensor_peak(const Solver& solver, const SimulationOptions& options, double time_left,
                         const SolveRig& solve, Simulation& run) {
  if (!run.sensor || contact_of_peak(run) < 2) return;
  Solver again = solver;
  again.accuracy = std::min(coarser * solver.accuracy, Solver::coarsest_accuracy);
  again.duration = std::min(beyond * run.sensor->peak_time, run.duration);
  again.time_limit = time_left;
  SimulationOptions plain = options;
  plain.history = {};
  plain.sensitivities = {};
  std::optional<double> change;
  try {
    if (!(time_left > 0.0)) throw std::runtime_error("no time is left");
    const Simulation other = solve(again, plain);
    if (other.duration >= run.sensor->peak_time)
      change = std::abs(other.sensor->peak_force / run.sensor->peak_force - 1.0);
  } catch (const std::runtime_error&) {
    // the run stands, with a warning
  }
  if (!change || !(*change <= coarser * solver.accuracy))
    run.warnings.push_back(warning_of(run, change));
}

}  // namespace impactrig::models
