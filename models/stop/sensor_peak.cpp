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

/// Solves a run again until its sensor has carried most.
class AnotherRun {
 public:
  AnotherRun(const Simulation& run, const Solver& solver, const SimulationOptions& options,
             double time_left, const SolveRig& solve)
      : run_(run),
        solver_(solver),
        options_(options),
        limit_(time_left),
        solve_(solve) {
    solver_.duration = std::min(beyond * run.sensor->peak_time, run.duration);
    options_.history = {};
    options_.sensitivities = {};
  }

  /// None where no time is left, or that fails.
  std::optional<Change> change_at(double accuracy) const {
    Solver again = solver_;
    again.accuracy = accuracy;
    again.time_limit = limit_.left();
    if (!(again.time_limit > 0.0)) return std::nullopt;
    try {
      const Simulation other = solve_(again, options_);
      if (other.duration >= run_.sensor->peak_time)
        return Change{accuracy, std::abs(other.sensor->peak_force / run_.sensor->peak_force - 1.0)};
    } catch (const std::runtime_error&) {
      // the run stands, with a warning
    }
    return std::nullopt;
  }

 private:
  const Simulation& run_;
  Solver solver_;
  SimulationOptions options_;
  TimeLimit limit_;
  const SolveRig& solve_;
};

}  // namespace

void confirm_sensor_peak(const Solver& solver, const SimulationOptions& options, double time_left,
                         const SolveRig& solve, Simulation& run) {
  if (!run.sensor || contact_of_peak(run) < 2) return;
  const AnotherRun other(run, solver, options, time_left, solve);
  const double accuracy = solver.accuracy;
  std::optional<Change> change;
  const auto agrees_at = [&](double other_accuracy) {
    const std::optional<Change> found = other.change_at(other_accuracy);
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
