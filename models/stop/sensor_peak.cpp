// SPDX-License-Identifier: BSD-3-Clause
#include "models/stop/sensor_peak.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>

#include "models/time_limit.hpp"

namespace impactrig::models {
namespace {

// Ratio of the accuracies that are compared.
constexpr double apart = 10.0;
// Of the time of the largest force, until when it is looked for again.
constexpr double beyond = 1.1;
// Of the largest force, what makes one from the second touch on its rival: errors that grow from
// contact to contact do not make more than that of less.
constexpr double rival_part = 0.75;
// Of what a rival lacks, how much it may change in another solution: one that is left to chance
// changes by about a tenth of the force, and only seldom by a thirtieth of what it lacks.
constexpr double rival_change = 1.0 / 30.0;

/// By how much the largest force changes in another solution.
struct Change {
  double accuracy;  ///< of that solution
  double part;      ///< of the force
};

/// The touch after which the sensor carried most: 1 for the first.
long contact_of_peak(const Simulation& run) {
  return std::ranges::count_if(
      run.episodes, [&](const Episode& episode) { return episode.start < run.sensor->peak_time; });
}

std::string text_of(const Change& change, double accuracy) {
  const bool finer = change.accuracy < accuracy;
  return fmt::format("changes by {:.1e} when it is solved {:.3g} times {} accurately", change.part,
                     finer ? accuracy / change.accuracy : change.accuracy / accuracy,
                     finer ? "more" : "less");
}

std::string warning_of(const Simulation& run, const std::optional<Change>& change,
                       double accuracy) {
  const std::string found =
      change ? text_of(*change, accuracy)
             : std::string("could not be solved again to see how far it is known");
  return fmt::format(
      "the sensor carries most, {:.6g} N, {:.4g} s after first touch, in contact {}, and that {}: "
      "each contact magnifies the errors of those before it. What it carries up to {:.4g} "
      "s, when the second begins, does not depend on them; state such a solver.duration, or damp "
      "contact or stop.",
      run.sensor->peak_force, run.sensor->peak_time, contact_of_peak(run), found,
      run.episodes[1].start);
}

std::string rival_warning_of(const Simulation& run, const std::optional<Change>& change,
                             double accuracy) {
  const std::string found =
      change ? "that " + text_of(*change, accuracy)
             : std::string("it could not be solved again to see how far that is known");
  return fmt::format(
      "the sensor carries most, {:.6g} N, {:.4g} s after first touch, in the first contact, but up "
      "to {:.4g} N from the second on, and {}: each contact magnifies the errors of those before "
      "it, so that it may be more. What it carries up to {:.4g} s does not depend on them; state "
      "such a solver.duration, or damp contact or stop.",
      run.sensor->peak_force, run.sensor->peak_time, run.sensor->later_peak_force, found,
      run.episodes[1].start);
}

/// Solves a run again until a time that is of interest, and a little further.
class AnotherRun {
 public:
  AnotherRun(const Simulation& run, double until, const Solver& solver,
             const SimulationOptions& options, double time_left, const SolveRig& solve)
      : run_(run),
        until_(until),
        solver_(solver),
        options_(options),
        limit_(time_left),
        solve_(solve) {
    solver_.duration = std::min(beyond * until, run.duration);
    options_.history = {};
    options_.sensitivities = {};
  }

  /// Of a force, in parts of the largest. None where no time is left, or that fails.
  std::optional<Change> change_at(double accuracy, double SensorForce::*force) const {
    Solver again = solver_;
    again.accuracy = accuracy;
    again.time_limit = limit_.left();
    if (!(again.time_limit > 0.0)) return std::nullopt;
    try {
      const Simulation other = solve_(again, options_);
      const SensorForce& sensor = *run_.sensor;
      const double change = (*other.sensor).*force - sensor.*force;
      if (other.duration >= until_) return Change{accuracy, std::abs(change) / sensor.peak_force};
    } catch (const std::runtime_error&) {
      // the run stands, with a warning
    }
    return std::nullopt;
  }

 private:
  const Simulation& run_;
  double until_;
  Solver solver_;
  SimulationOptions options_;
  TimeLimit limit_;
  const SolveRig& solve_;
};

/// Of a largest force before the second touch, whether one after it may be larger.
void confirm_no_later_one(const AnotherRun& other, double accuracy, Simulation& run) {
  const double coarse = apart * accuracy;
  const bool may_be_coarser = coarse <= Solver::coarsest_accuracy;
  const std::optional<Change> change =
      other.change_at(may_be_coarser ? coarse : accuracy / apart, &SensorForce::later_peak_force);
  const double lacking = 1.0 - run.sensor->later_peak_force / run.sensor->peak_force;
  if (change && change->part <= rival_change * lacking) return;
  run.sensor->peak_known = false;
  run.warnings.push_back(rival_warning_of(run, change, accuracy));
}

}  // namespace

void confirm_sensor_peak(const Solver& solver, const SimulationOptions& options, double time_left,
                         const SolveRig& solve, Simulation& run) {
  if (!run.sensor) return;
  const double accuracy = solver.accuracy;
  const SensorForce& sensor = *run.sensor;
  if (contact_of_peak(run) < 2) {
    if (sensor.later_peak_force < rival_part * sensor.peak_force) return;
    const AnotherRun other(run, run.duration, solver, options, time_left, solve);
    return confirm_no_later_one(other, accuracy, run);
  }
  const AnotherRun other(run, sensor.peak_time, solver, options, time_left, solve);
  std::optional<Change> change;
  const auto agrees_at = [&](double other_accuracy) {
    const std::optional<Change> found = other.change_at(other_accuracy, &SensorForce::peak_force);
    if (found) change = found;
    return found && found->part <= accuracy;
  };
  const double coarse = apart * accuracy;
  const bool may_be_coarser = coarse <= Solver::coarsest_accuracy;
  if (may_be_coarser && agrees_at(coarse)) return;
  const bool hopeless = may_be_coarser && !(change && change->part <= coarse);
  if (!hopeless && agrees_at(std::max(accuracy / apart, Solver::finest_accuracy))) return;
  run.sensor->peak_known = false;
  run.warnings.push_back(warning_of(run, change, accuracy));
}

}  // namespace impactrig::models
