// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "models/collocation/collocation_run.hpp"
#include "models/modal/bar_cache.hpp"
#include "models/modal/modal_motion.hpp"
#include "models/modal/modal_sensitivities.hpp"
#include "models/simulation.hpp"
#include "models/stop/stopped_motion.hpp"
#include "models/time_limit.hpp"

namespace impactrig::models {

/// How many modes a rig has in small motion.
int modes_of(const Solver& solver);

/// Nodes of a step.
int nodes_of(const Solver& solver);

/// Why a rig cannot be solved as small motion in all its modes; empty when it can.
std::string small_motion_refusal(const Rig& rig, const Solver& solver);

/// Whether fewer coordinates than a mesh has may be enough: their forces are known beforehand, and
/// nothing is asked for that moves them.
bool may_leave_out_vibration(const Rig& rig, const Solver& solver,
                             const SimulationOptions& options);

/// One run of a bar in its modes.
class SmallMotionRun {
 public:
  SmallMotionRun(const Rig& rig, const Solver& solver, const SimulationOptions& options,
                 std::shared_ptr<const ModalBar> bar);

  CollocationRun& run() { return run_; }

  ModalMotion& motion() { return motion_; }

  const ModalBar& bar() const { return *bar_; }

  const std::shared_ptr<const ModalBar>& shared_bar() const { return bar_; }

  /// The bar's own response to the contact force is all there is.
  bool faces_single_rigid_stop() const { return !stopped_ && rig_.further_stops.empty(); }

  const Collocation& rule() const { return motion_.rule(); }

  /// By when the first contact has to be over, and what small motion may leave out of it, for the
  /// run to go on.
  struct Trial {
    TimeLimit time;
    double accuracy;
  };

  /// The whole run. Throws std::runtime_error where a trial of it fails, if there is one.
  void complete(const std::optional<Trial>& trial);

  /// What the run gave, and what small motion left out of it.
  Simulation conclude();
  /// The same without the sentences of Simulation::skipped, for callers who read none.
  Simulation conclude_untold();

  /// What vibration that a ReducedBar does not have changes at most of peak, duration and impulse
  /// of the first contact, and of histories that are asked for: as a part of the touch speed. Once
  /// concluded.
  double left_out() const { return left_out_; }

 private:
  bool judges() const;
  bool promises(double accuracy) const;
  double neglected(const Simulation& result) const;
  double neglected_of_forces(const Simulation& result) const;
  bool may_end_otherwise(const Simulation& result, double part) const;
  double of_swing(const Simulation& result) const;
  double rounding_of_load(const Simulation& result) const;
  Eigen::VectorXd rung_at_touch(int stop) const;
  void find_left_out(const Simulation& result);
  void tell_taken(Simulation& result) const;

  const Rig& rig_;
  const Solver& solver_;
  const SimulationOptions& options_;
  std::shared_ptr<const ModalBar> bar_;
  ModalMotion motion_;
  std::unique_ptr<StoppedMotion> stopped_;  // before a stop that gives way
  CollocationRun run_;
  std::unique_ptr<ModalSensitivities> sensitivities_;
  double left_out_ = 0.0;
  double of_arrival_ = 0.0;  // what Arrival leaves out
};

/// Small motion of a bar without a stop.
Simulation swing_freely(const Rig& rig, const Solver& solver, const SimulationOptions& options,
                        const ModalBar& bar);

/// What simulate() tells of a swing that it did not integrate.
void tell_swing(const Rig& rig, const SimulationOptions& options, Simulation& result);

}  // namespace impactrig::models
