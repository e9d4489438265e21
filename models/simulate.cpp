// SPDX-License-Identifier: BSD-3-Clause
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "models/implicit/ancf_motion.hpp"
#include "models/implicit/dense_motion.hpp"
#include "models/modal/small_motion_run.hpp"

namespace impactrig::models {
namespace {

Simulation simulate_small_motion(const Rig& rig, const Solver& solver,
                                 const SimulationOptions& options) {
  BarCache own;
  BarCache& cache = options.bars ? *options.bars : own;
  SmallMotionRun run(rig, solver, options, cache.bar(rig, solver));
  run.run().complete();
  return run.conclude();
}

/// Small motion, where it may be tried and its own estimate of what it leaves out allows it.
std::optional<Simulation> try_small_motion(const Rig& rig, const Solver& solver,
                                           const SimulationOptions& options) {
  const bool asked = options.motion == Motion::small;
  if (options.exact || options.motion == Motion::full) return std::nullopt;
  if (const std::string refusal = small_motion_refusal(rig, solver); !refusal.empty()) {
    if (asked) throw std::invalid_argument(refusal);
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

}  // namespace

Simulation simulate(const Rig& rig, const Solver& solver, const SimulationOptions& options) {
  validate(rig, solver);
  std::optional<Simulation> result = try_small_motion(rig, solver, options);
  if (!result) {
    const std::unique_ptr<BarMotion> motion = solver.model == BeamModel::ancf
                                                  ? make_ancf_motion(rig, solver, options.history)
                                                  : make_dense_motion(rig, solver, options.history);
    CollocationRun run(rig, solver, options, *motion);
    run.complete();
    result = run.conclude();
  }
  tell_swing(rig, options, *result);
  return *std::move(result);
}

}  // namespace impactrig::models
