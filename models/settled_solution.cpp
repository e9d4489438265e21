// SPDX-License-Identifier: BSD-3-Clause
#include "models/settled_solution.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>

#include "models/beams/bar_element.hpp"
#include "models/beams/bending_modes.hpp"
#include "models/time_limit.hpp"

namespace impactrig::models {
namespace {

// Of strain.
constexpr double much = 0.05;
// Of a cantilever's slowest vibration, the rate of turning or swinging from which on a bar may move
// like a chain; by how much it turns or swings while a contact is long [rad]. A strip of rubber had
// impulses that agreed to 1e-9 up to 4.6 rad and to 1e-3 up to 11 rad.
constexpr double limp = 0.2, long_contact = 3.0;
// Of two solutions that show what the coarser one errs by, the ratio of their accuracies.
constexpr double apart = 10.0;
// Times in a row that they have to agree: where a hinge sticks or not, solutions of a range of
// accuracies agree on what finer ones find wrong.
constexpr int agreements = 2;
constexpr double safety = 3.0;
constexpr int most_attempts = 5;
// Of the processor time allowed, what a solution may take that ends with the first contact.
constexpr double share_of_time = 0.1;

/// What may magnify errors, and what to do about it.
struct Magnifier {
  std::string cause, remedy;
};

/// What strains the bar beyond the beam theories, where that is much. A tip that is stopped strains
/// the bar by its speed, as a part of the speed of sound along the bar; a bar that hangs, by its
/// weight. A softer end counts as all of the bar.
std::optional<Magnifier> strain(const Rig& rig) {
  double sound = std::numeric_limits<double>::infinity(), stiffness = sound;
  for (const BarElement& piece : bar_pieces(rig.beam)) {
    sound = std::min(sound, std::sqrt(piece.axial_stiffness / piece.line_density));
    stiffness = std::min(stiffness, piece.axial_stiffness);
  }
  const double mach = touch_velocity(rig) * rig.beam.length / rig.contact.position / sound;
  const double weight = rig.gravity * rig.beam.total_mass() / stiffness;
  if (std::max(mach, weight) < much) return std::nullopt;
  std::string cause = mach >= weight
                          ? fmt::format(
                                "at touch the tip moves at {:.2g} of the speed of sound in the "
                                "bar, which strains it by as much",
                                mach)
                          : fmt::format("the bar's weight strains it by up to {:.2g}", weight);
  return Magnifier{
      std::move(cause),
      "The beam theories, linear in the strain, do not hold there; strike more slowly, "
      "or take a stiffer bar."};
}

/// What lets a limp bar move like a chain while a contact lasts: its turning or its weight, against
/// what its stiffness does by itself.
std::optional<Magnifier> whip(const Rig& rig, const Simulation& run) {
  const Episode& contact = run.episodes.front();
  const double turns = touch_velocity(rig) / rig.contact.position;
  const double swings = std::sqrt(rig.gravity * rig.beam.first_moment() / rig.beam.hinge_inertia());
  const double rate = std::max(turns, swings);
  const double slowest = slowest_vibration(rig.beam);
  if (rate < limp * slowest || rate * (contact.end - contact.start) < long_contact)
    return std::nullopt;
  return Magnifier{
      fmt::format("the bar {} {:.2g} times as fast as it would vibrate as a cantilever, for {:.3g} "
                  "s of contact",
                  turns > swings ? "turns" : "swings", rate / slowest, contact.end - contact.start),
      "State a shorter solver.duration, or take a stiffer bar."};
}

std::optional<Magnifier> magnifier(const Rig& rig, const Simulation& run) {
  if (std::optional<Magnifier> found = strain(rig)) return found;
  if (rig.hinge.friction == 0.0) return whip(rig, run);
  return Magnifier{"friction stops the hinge of the vibrating bar and lets it go",
                   "Ask for a finer accuracy, or damp the bar."};
}

/// Largest relative difference of the first contacts' peak force, duration and impulse; all where
/// one of them ends and the other does not.
double change_between(const Simulation& one, const Simulation& other) {
  const Episode& a = one.episodes.front();
  const Episode& b = other.episodes.front();
  if (a.open != b.open) return 1.0;
  const auto change = [](double x, double y) { return std::abs(x - y) / std::abs(y); };
  return std::max({change(a.peak_force, b.peak_force), change(a.end - a.start, b.end - b.start),
                   change(a.impulse, b.impulse)});
}

/// Solves the first contact alone.
class FirstContact {
 public:
  FirstContact(const Simulation& run, const Solver& solver, const SimulationOptions& options,
               const TimeLimit& limit, const SolveFully& solve)
      : solver_(solver),
        options_(options),
        limit_(limit),
        solve_(solve) {
    const double until = 1.5 * run.episodes.front().end;
    solver_.duration = solver.duration ? std::min(*solver.duration, until) : until;
    solver_.time_limit *= share_of_time;
    options_.history = {};
    options_.sensitivities = {};
  }

  /// None where that takes too long, or fails.
  std::optional<Simulation> at(double accuracy) const {
    Solver solver = solver_;
    solver.accuracy = accuracy;
    solver.time_limit = std::min(solver.time_limit, limit_.left());
    try {
      Simulation run = solve_(solver, options_);
      if (!run.episodes.empty()) return run;
    } catch (const std::runtime_error&) {
      // the run at the accuracy asked for stands, with a warning
    }
    return std::nullopt;
  }

 private:
  Solver solver_;
  SimulationOptions options_;
  const TimeLimit& limit_;
  const SolveFully& solve_;
};

/// Whether a solution of this accuracy, too, differs from a coarser one by no more than that.
bool had_settled(const Simulation& run, double accuracy, const FirstContact& first) {
  const double coarser = std::min(apart * accuracy, Solver::coarsest_accuracy);
  const std::optional<Simulation> before = first.at(coarser);
  return before && change_between(*before, run) <= accuracy;
}

std::string warning_of(double change, const Magnifier& magnifier) {
  const std::string found = change > 0.0 ? fmt::format("changes by {:.1e}", change)
                                         : std::string("could not be shown to stay as it is");
  return fmt::format(
      "the first contact {} when it is solved more accurately: {}, and such motion magnifies every "
      "error. {}",
      found, magnifier.cause, magnifier.remedy);
}

}  // namespace

Simulation solve_until_settled(const Rig& rig, const Solver& solver,
                               const SimulationOptions& options, const SolveFully& solve) {
  const TimeLimit limit(solver.time_limit);
  Simulation run = solve(solver, options);
  if (solver.model == BeamModel::rigid || run.episodes.empty()) return run;
  const std::optional<Magnifier> magnified = magnifier(rig, run);
  if (!magnified) return run;
  const FirstContact first(run, solver, options, limit, solve);
  const double coarse = std::min(apart * solver.accuracy, Solver::coarsest_accuracy);
  std::optional<Simulation> before = first.at(coarse);
  std::optional<double> change;
  if (before) change = change_between(*before, run);
  if (change && *change <= solver.accuracy && had_settled(*before, coarse, first)) return run;
  double largest = change.value_or(0.0);
  int agreed = 0;

  Solver used = solver;
  before = first.at(used.accuracy);
  for (int attempt = 0; before && agreed < agreements && attempt < most_attempts; ++attempt) {
    if (used.accuracy <= Solver::finest_accuracy) break;
    const double wanted = solver.accuracy / (safety * change.value_or(1.0));
    const double finer =
        std::max(used.accuracy * std::clamp(wanted, 1e-2, 1.0 / apart), Solver::finest_accuracy);
    std::optional<Simulation> after = first.at(finer);
    if (!after) break;
    used.accuracy = finer;
    change = change_between(*before, *after);
    largest = std::max(largest, *change);
    agreed = *change <= solver.accuracy ? agreed + 1 : 0;
    before = std::move(after);
  }
  bool settled = agreed == agreements;
  if (used.accuracy < solver.accuracy) {
    used.time_limit = limit.left();
    try {
      run = solve(used, options);
      run.solver = solver;
      largest = *change;
    } catch (const std::runtime_error&) {
      settled = false;  // no time is left for it
    }
  }
  if (!settled) run.warnings.push_back(warning_of(largest, *magnified));
  return run;
}

}  // namespace impactrig::models
