// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "models/beams/bar_element.hpp"
#include "models/collocation/collocation_run.hpp"
#include "models/free_run.hpp"
#include "models/implicit/ancf_motion.hpp"
#include "models/implicit/dense_motion.hpp"
#include "models/make_beam.hpp"
#include "models/modal/bar_cache.hpp"
#include "models/modal/modal_motion.hpp"
#include "models/run_limits.hpp"
#include "models/stop/stopped_motion.hpp"

namespace impactrig::models {
namespace {

// Beyond, computing all modes costs more than it saves: the work grows with the cube of their
// number.
constexpr int most_modes = 260;
// The error of small motion is at most about twice what ModalMotion::neglected() and the weight's
// share say (120 random scenes against the full equations); twice that again for safety.
constexpr double safety = 4.0;

// Of the accuracy asked for, what full equations are solved to: scenes may magnify errors (a bar
// that turns back just before it stands on its head: 18 times). A rigid bar costs next to nothing.
constexpr double share_of_full = 0.3, share_of_rigid = 0.03;

/// A bar that can stretch begins without tension; until its first axial vibration is over the
/// weight does not turn it back as small motion has it. As a part of the energy.
double missing_tension(const Rig& rig, const Solver& solver, double duration) {
  const bool stretches = solver.model == BeamModel::ancf ||
                         (solver.model == BeamModel::hybrid && solver.axial_modes > 0);
  if (!stretches) return 0.0;
  // its period at most, by Dunkerley's formula
  const Beam& beam = rig.beam;
  double flexibility = 0.0;  // of the whole bar, with as much of it at its end as is enough
  for (const BarElement& piece : bar_pieces(beam))
    flexibility += piece.length / piece.axial_stiffness;
  const bool uniform = beam.segments.empty();
  double square =
      (uniform ? 4.0 / std::pow(std::numbers::pi, 2) : 1.0) * beam.bar_mass() * flexibility;
  for (const LumpedMass& lump : beam.masses)
    square += lump.mass * flexibility * (uniform ? lump.position / beam.length : 1.0);
  const double period = 2.0 * std::numbers::pi * std::sqrt(square);
  const double time = std::min(duration, period);
  return 0.5 * rig.gravity * beam.first_moment() / beam.hinge_inertia() * time * time;
}

int nodes_for(double accuracy) {
  return accuracy > 2e-4 ? 6 : accuracy > 2e-7 ? 8 : 12;
}

/// The bar against its stop, if there is one. `sensitivities` follow a rigid stop.
Simulation run(const Rig& rig, const Solver& solver, const SimulationOptions& options,
               BarMotion& bar, ModalSensitivities* sensitivities = nullptr) {
  if (!rig.has_stop()) return FreeRun(rig, solver, options, bar).simulate();
  if (!rig.stop) {
    CollocationRun run(rig, solver, options, bar);
    if (sensitivities) run.follow(*sensitivities);
    return run.simulate();
  }
  StoppedMotion stopped(bar, *rig.stop);
  Simulation result = CollocationRun(rig, solver, options, stopped).simulate();
  result.sensor = stopped.sensor(result.impulse);
  return result;
}

Simulation simulate_small_motion(const Rig& rig, const Solver& solver,
                                 const SimulationOptions& options) {
  BarCache own;
  BarCache& cache = options.bars ? *options.bars : own;
  const std::shared_ptr<const ModalBar> bar = cache.bar(rig, solver);
  ModalMotion motion(*bar, Collocation::of(nodes_for(solver.accuracy)), options.history);
  std::optional<ModalSensitivities> sensitivities;
  const bool begins_at_touch = !rig.start.release_angle || !spring_bends_bar(rig);
  if (!options.sensitivities.empty() && begins_at_touch && !rig.stop)
    sensitivities.emplace(rig, solver, options, motion);
  Simulation result = run(rig, solver, options, motion, sensitivities ? &*sensitivities : nullptr);
  if (sensitivities) result.sensitivities = sensitivities->take_results();
  result.small_motion = true;
  result.neglected = safety * (motion.neglected() + missing_tension(rig, solver, result.duration));
  result.skipped.push_back(fmt::format(
      "foreshortening and large rotation: the bar was solved in its own modes; the energy this "
      "leaves out is {:.1e} of the whole, peak force, duration and impulse err by no more",
      result.neglected));
  return result;
}

/// Small motion, where it may be tried and its own estimate of what it leaves out allows it.
std::optional<Simulation> try_small_motion(const Rig& rig, const Solver& solver,
                                           const SimulationOptions& options) {
  const bool asked = options.motion == Motion::small;
  if (options.exact || options.motion == Motion::full) return std::nullopt;
  if (const std::string keys = beyond_small_motion(rig); !keys.empty()) {
    if (asked)
      throw std::invalid_argument(fmt::format(
          "small motion was asked for, but it does not know {}; ask for the full equations", keys));
    return std::nullopt;
  }
  const int modes = solver.model == BeamModel::ancf
                        ? 2 * (solver.elements[0] + solver.elements[1]) + 1
                        : 1 + solver.modes;
  if (modes > most_modes) {
    if (asked)
      throw std::invalid_argument(
          fmt::format("small motion was asked for, but {} modes are too many to be computed; at "
                      "most {}",
                      modes, most_modes));
    return std::nullopt;
  }
  if (asked) return simulate_small_motion(rig, solver, options);
  try {
    Simulation result = simulate_small_motion(rig, solver, options);
    if (result.neglected <= solver.accuracy) return result;
  } catch (const std::runtime_error&) {
    // what is wrong with the scene the full equations tell
  }
  return std::nullopt;
}

Simulation simulate_full_equations(const Rig& rig, const Solver& solver,
                                   const SimulationOptions& options) {
  Solver used = solver;
  used.accuracy *= solver.model == BeamModel::rigid ? share_of_rigid : share_of_full;
  const std::unique_ptr<BarMotion> motion = solver.model == BeamModel::ancf
                                                ? make_ancf_motion(rig, used, options.history)
                                                : make_dense_motion(rig, used, options.history);
  Simulation result = run(rig, used, options, *motion);
  result.solver = solver;
  return result;
}

}  // namespace

Simulation simulate(const Rig& rig, const Solver& solver, const SimulationOptions& options) {
  validate(rig, solver);
  std::optional<Simulation> result = try_small_motion(rig, solver, options);
  if (!result) result = simulate_full_equations(rig, solver, options);
  if (rig.has_stop() && rig.start.release_angle && !options.exact && !spring_bends_bar(rig))
    result->skipped.push_back(fmt::format(
        "the swing from {:.4g} rad to first touch: the rigid bar's {} gives {:.6g} m/s at the "
        "struck point; a swing this slow hardly bends the bar",
        *rig.start.release_angle, damped(rig) ? "damped swing" : "energy", touch_velocity(rig)));
  return *std::move(result);
}

}  // namespace impactrig::models
