// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "models/sensitivities/slope_progress.hpp"
#include "models/simulation.hpp"

namespace impactrig::models {

/// Derivatives of a FreeRun's history by numbers of the rig: a MotionSlope a parameter, carried on
/// from step to step. Where friction in the hinge changes, the time of that moves with the number.
class FreeSensitivities {
 public:
  FreeSensitivities(const Rig& rig, const Solver& solver, const SimulationOptions& options,
                    BarMotion& motion);

  /// False where the motion cannot be followed; then it is of no further use.
  bool known() const { return known_; }

  /// The run begins, with room for so many samples.
  void start(std::size_t samples);

  /// The step at hand is solved. False where its slopes could not be.
  bool solve();

  /// Within the solved step, by parts of it.
  void sample(double first, double spacing, std::size_t count);

  /// The solved step is taken, before the motion takes it; `changes`: it ends where friction in the
  /// hinge does.
  void take(bool changes);

  void change_hinge();  ///< as BarMotion::change_hinge() did

  std::vector<Sensitivity> take_results();

 private:
  struct Direction {
    std::unique_ptr<RigEffect> effect;
    std::unique_ptr<MotionSlope> slope;
    SlopeProgress progress;
    double time = 0.0;  ///< slope of the time at which the step at hand begins
    Sensitivity result;
  };

  bool solve(Direction& d);
  void show(Direction& d, double part);

  const SimulationOptions& options_;
  const bool turned_;  // the hinge, as stated
  std::vector<NodeVector> no_force_;
  std::vector<Direction> directions_;
  bool known_ = true;
};

}  // namespace impactrig::models
