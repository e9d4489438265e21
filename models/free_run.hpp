// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "models/collocation/bar_motion.hpp"
#include "models/sensitivities/free_sensitivities.hpp"
#include "models/simulation.hpp"
#include "models/time_limit.hpp"

namespace impactrig::models {

/// How a bar without a stop starts: released, thrown, or turned.
MotionSlope::Start free_start(const Rig& rig);

/// One run of simulate() without a stop: the bar swings and vibrates from its start for the
/// duration asked for.
class FreeRun {
 public:
  FreeRun(const Rig& rig, const Solver& solver, const SimulationOptions& options, BarMotion& bar);

  /// Before start(): derivatives that go along.
  void follow(FreeSensitivities& sensitivities) { followed_ = &sensitivities; }

  void start();
  Simulation simulate();  ///< in steps as long as the bar's own error allows
  Simulation fly();       ///< all at once: BarMotion::fly()

 private:
  void make_room(std::size_t samples);
  bool solve();
  bool try_step(int level);
  bool land(double hinge_change);
  void change_hinge();
  void check_headway(const TimeLimit& limit, int level);
  void take_step();
  template <typename Look>
  void sample(double time, Look look);
  void conclude();

  const Rig& rig_;
  const Solver& solver_;
  const SimulationOptions& options_;
  BarMotion& bar_;
  double energy_scale_ = 0.0;  // what the start gives [J]
  double energy_at_start_ = 0.0;
  double first_ = 0.0;  // step [s]
  double t_ = 0.0, t_end_ = 0.0;
  double error_ = 0.0;          // of the step tried, to be compared with 1
  bool hinge_changes_ = false;  // where the step ends
  Looks looks_;                 // at the time
  StopStep no_stop_;
  std::vector<BarMotion::Sample> samples_;
  Simulation result_;
  FreeSensitivities* followed_ = nullptr;
};

}  // namespace impactrig::models
