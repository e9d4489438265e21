// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "models/collocation/collocation_run.hpp"
#include "models/modal/bar_cache.hpp"
#include "models/modal/modal_motion.hpp"
#include "models/modal/modal_sensitivities.hpp"
#include "models/simulation.hpp"
#include "models/stop/stopped_motion.hpp"

namespace impactrig::models {

/// Why a rig cannot be solved as small motion; empty when it can.
std::string small_motion_refusal(const Rig& rig, const Solver& solver);

/// One run of a bar in its modes.
class SmallMotionRun {
 public:
  SmallMotionRun(const Rig& rig, const Solver& solver, const SimulationOptions& options,
                 std::shared_ptr<const ModalBar> bar);

  CollocationRun& run() { return run_; }

  ModalMotion& motion() { return motion_; }

  const ModalBar& bar() const { return *bar_; }

  /// The bar's own response to the contact force is all there is.
  bool faces_single_rigid_stop() const { return !stopped_ && rig_.further_stops.empty(); }

  const Collocation& rule() const { return motion_.rule(); }

  /// What the run gave, and what small motion left out of it.
  Simulation conclude();

 private:
  bool judges() const;

  const Rig& rig_;
  const Solver& solver_;
  const SimulationOptions& options_;
  std::shared_ptr<const ModalBar> bar_;
  ModalMotion motion_;
  std::unique_ptr<StoppedMotion> stopped_;  // before a stop that gives way
  CollocationRun run_;
  std::unique_ptr<ModalSensitivities> sensitivities_;
  double of_swing_ = 0.0;  // θ²/16: by how much a swing's period exceeds that of a small one
};

/// Small motion of a bar without a stop.
Simulation swing_freely(const Rig& rig, const Solver& solver, const SimulationOptions& options,
                        const ModalBar& bar);

/// What simulate() tells of a swing that it did not integrate.
void tell_swing(const Rig& rig, const SimulationOptions& options, Simulation& result);

}  // namespace impactrig::models
