// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace impactrig::models {

/// How many steps StepLanes solves at once.
inline constexpr int lane_count = 8;

/// One number of each lane.
struct alignas(64) LaneRow {
  double at[lane_count] = {};
};

/// Steps of bars, one a lane: what ModalStep, ContactForce and the state of a run give, and what
/// CollocationRun::solution() takes back. Rows of s nodes; matrices by columns of them.
struct StepLanes {
  int nodes = 0;                                       ///< s: 6 or 8
  const double *to_series = nullptr;                   ///< of the rule, by columns (s, s)
  LaneRow *displacement_of_force, *velocity_of_force;  // (s, s)

  // in: the force as guessed, and the struck point free of it; out: both as solved
  LaneRow *force, *displacement, *velocity;
  // out
  LaneRow *dissipation, *force_series, *displacement_series, *dissipation_series;
  LaneRow *to_depth, *to_rate;  ///< of the law while it presses, as Newton's method last saw it

  // the contact: pressed and slack are 0 or 1; a linear spring where compliance is 0
  LaneRow pressed, slack, compliance, limit_force, spring, mu, tolerance;
  LaneRow iterations;  ///< of Newton's method
  LaneRow solved;      ///< 0 where it failed
};

/// Newton's method for the force, in every lane; what happens in a lane
/// does not depend on the others. Uses what the processor has.
void solve_steps(StepLanes &lanes);

}  // namespace impactrig::models
