// SPDX-License-Identifier: BSD-3-Clause
#include "models/settled_swing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "models/beams/bending_modes.hpp"
#include "models/contact_log.hpp"
#include "models/free_run.hpp"
#include "models/rigid_swing.hpp"
#include "models/time_limit.hpp"

namespace impactrig::models {
namespace {

// Of two solutions that show what the coarser one errs by, the ratio of their accuracies, and how
// many times in a row they have to agree.
constexpr double apart = 10.0;
constexpr int agreements = 2;
constexpr int most_attempts = 6;
// Solutions that differ by so many accuracies, and again by more than half as much, have parted.
constexpr double parted = 100.0, hardly_less = 0.5;
// Parts of the energy of standing upright: a pendulum with that changes its period by up to 0.8
// times the relative change of its energy, by ever more the closer it comes.
constexpr double least_upright = 0.8, most_upright = 1.25;
// Part of the energy, beyond which a bar that turns as it vibrates may be chaotic.
constexpr double much_vibration = 0.01;
// Of a cantilever's slowest vibration, the rate of turning from which on a bar may move like a
// chain, whatever energy that leaves in it in the end.
constexpr double limp = 0.2;
// Of a bar in hybrid coordinates, as parts of its length: the slope of a tip that bends so far is
// some 0.4, of which half the square is left out. No bar of its length is further from the hanging
// line than that.
constexpr double most_deflection = 0.3, most_displacement = 1.05;
// Displacements that two solutions are compared by, over the run.
constexpr int looks = 256;

double energy_at_start(const Rig& rig) {
  const auto [angle, rate] = free_start(rig);
  return 0.5 * rig.beam.hinge_inertia() * rate * rate + RigidSwing(rig).available(angle);
}

/// At most how fast it turns, as a rigid bar [rad/s].
double fastest_turn(const Rig& rig) {
  if (rig.hinge.rotation) return std::abs(rig.hinge.rotation->rate);
  return std::sqrt(2.0 * energy_at_start(rig) / rig.beam.hinge_inertia());
}

/// What magnifies errors of a swing that came out like this; "" where nothing does.
std::string magnifier(const Rig& rig, const Simulation& run) {
  const double vibration = std::abs(run.energy.vibration) / run.energy.initial;
  if (vibration > much_vibration)
    return fmt::format("the bar vibrates with {:.2g} times the energy of its swing", vibration);
  const double turn = fastest_turn(rig) / slowest_vibration(rig.beam);
  if (run.solver.model != BeamModel::rigid && turn > limp)
    return fmt::format("the bar turns {:.2g} times as fast as it would vibrate as a cantilever",
                       turn);
  if (rig.hinge.rotation) return "";
  if (rig.hinge.friction > 0.0) return "friction stops the hinge of the bar and lets it go";
  const double upright = 2.0 * rig.gravity * rig.beam.first_moment();
  const double energy = energy_at_start(rig);
  if (energy < least_upright * upright || energy > most_upright * upright) return "";
  return "the bar has about the energy to stand upright";
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

/// Largest difference of displacements over the run, as a part of the bar's length.
double change_between(const Rig& rig, const Simulation& one, const Simulation& other) {
  const History &a = one.history, &b = other.history;
  return std::max({largest_difference(a.displacement, b.displacement),
                   largest_difference(a.deflection, b.deflection),
                   largest_difference(a.extension, b.extension)}) /
         rig.beam.length;
}

double largest(const std::vector<double>& samples) {
  double found = 0.0;
  for (const double sample : samples) found = std::max(found, std::abs(sample));
  return found;
}

/// Hybrid coordinates have deflections to second order: beyond, what holds a real bar back is not
/// in them, and they may grow without bound.
std::optional<std::string> warning_of_deflection(const Rig& rig, const Simulation& run) {
  if (run.solver.model != BeamModel::hybrid) return std::nullopt;
  const double deflection = largest(run.history.deflection) / rig.beam.length;
  const double displacement = largest(run.history.displacement) / rig.beam.length;
  if (deflection <= most_deflection && displacement <= most_displacement) return std::nullopt;
  const std::string found =
      deflection > most_deflection
          ? fmt::format("the bar bends by up to {:.2g} of its length", deflection)
          : fmt::format("the bar's tip is up to {:.2g} times its length from where it hangs",
                        displacement);
  return found +
         ": the hybrid model knows small deflections only. Take solver.model = \"ancf\", which "
         "bends as far as it has to.";
}

std::string warning_of(std::optional<double> change, const std::string& magnified) {
  const std::string found = change ? fmt::format("change by {:.1e} of the bar's length", *change)
                                   : std::string("could not be shown to stay as they are");
  return fmt::format(
      "displacements {} when they are solved more accurately: {}, and such motion magnifies every "
      "error. State a shorter solver.duration, a larger solver.accuracy, or a longer "
      "solver.time_limit.",
      found, magnified);
}

class Swing {
 public:
  Swing(const Rig& rig, const Solver& solver, const SimulationOptions& options,
        const SolveFully& solve)
      : rig_(rig),
        solver_(solver),
        accuracy_(solver.accuracy),
        options_(options),
        limit_(solver.time_limit),
        solve_(solve) {}

  Simulation settle();

 private:
  Simulation at(double accuracy, const SimulationOptions& options) {
    Solver solver = solver_;
    solver.accuracy = accuracy;
    solver.time_limit = limit_.left();
    return solve_(solver, options);
  }

  /// None where no time is left for it, or it fails.
  std::optional<Simulation> attempt(double accuracy, const SimulationOptions& options) {
    try {
      return at(accuracy, options);
    } catch (const std::runtime_error&) {
      return std::nullopt;
    }
  }

  Simulation agree(Simulation run, const SimulationOptions& options, const std::string& magnified);
  Simulation with_slopes(Simulation run);

  const Rig& rig_;
  const Solver& solver_;
  double accuracy_;  // of the last solution
  const SimulationOptions& options_;
  TimeLimit limit_;
  const SolveFully& solve_;
  std::string warning_;
};

/// Solved more accurately until that changes nothing, twice in a row.
Simulation Swing::agree(Simulation run, const SimulationOptions& options,
                        const std::string& magnified) {
  const auto coarser = [&](double factor) {
    return attempt(std::min(factor * solver_.accuracy, Solver::coarsest_accuracy), options);
  };
  std::optional<double> change, change_before;
  const auto agrees = [&](const Simulation& one, const Simulation& other) {
    change_before = change;
    change = change_between(rig_, one, other);
    return *change <= solver_.accuracy;
  };
  int agreed = 0;
  if (const std::optional<Simulation> before = coarser(apart); before && agrees(*before, run)) {
    const std::optional<Simulation> first = coarser(apart * apart);
    agreed = first && agrees(*first, *before) ? 2 : 1;
  }
  for (int k = 0; k < most_attempts && agreed < agreements; ++k) {
    if (accuracy_ <= Solver::finest_accuracy) break;
    const double finer = std::max(accuracy_ / apart, Solver::finest_accuracy);
    std::optional<Simulation> after = attempt(finer, options);
    if (!after) break;
    accuracy_ = finer;
    agreed = agrees(run, *after) ? agreed + 1 : 0;
    run = *std::move(after);
    const double before = change_before.value_or(0.0);
    if (before > parted * solver_.accuracy && *change > hardly_less * before) break;
  }
  if (agreed < agreements) warning_ = warning_of(std::max(change, change_before), magnified);
  return run;
}

/// Solved once more, with its derivatives.
Simulation Swing::with_slopes(Simulation run) {
  if (std::optional<Simulation> followed = attempt(accuracy_, options_))
    return *std::move(followed);
  run.warnings.push_back(
      fmt::format("no time was left for the derivatives of {} numbers; ask for fewer, or state a "
                  "longer solver.time_limit.",
                  options_.sensitivities.size()));
  return run;
}

Simulation Swing::settle() {
  SimulationOptions options = options_;
  options.sensitivities = {};
  const bool shown = options.history.interval > 0.0;
  if (!shown) options.history.interval = *solver_.duration / looks;
  Simulation run = at(solver_.accuracy, options);
  const std::string magnified = magnifier(rig_, run);
  if (!magnified.empty()) run = agree(std::move(run), options, magnified);
  const std::optional<std::string> bends_far = warning_of_deflection(rig_, run);
  if (!shown) run.history = {};
  if (!options_.sensitivities.empty()) run = with_slopes(std::move(run));
  warn_of_imbalance(solver_.accuracy, run);
  if (!warning_.empty()) run.warnings.push_back(warning_);
  if (bends_far) run.warnings.push_back(*bends_far);
  return run;
}

}  // namespace

Simulation solve_swing_until_settled(const Rig& rig, const Solver& solver,
                                     const SimulationOptions& options, const SolveFully& solve) {
  return Swing(rig, solver, options, solve).settle();
}

}  // namespace impactrig::models
