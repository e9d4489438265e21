// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace impactrig::models {

/// How many steps StepLanes solves at once.
inline constexpr int lane_count = 8;

/// One number of each lane.
struct alignas(64) LaneRow {
  double at[lane_count] = {};
};

/// Steps of bars in their modes, one a lane: what ModalStep, ContactForce and the state of a run
/// give, and what CollocationRun::solution() takes back. Rows of m modes or s nodes; matrices by
/// columns of s nodes.
struct StepLanes {
  int modes = 0, nodes = 0;           ///< m; s: 6 or 8
  const double *to_series = nullptr;  ///< of the rule, by columns (s, s)

  // the bar's response to a state (s, m), to a force (s, s), and its state after the step
  LaneRow *displacement_of_a, *displacement_of_rate, *velocity_of_a;
  LaneRow *displacement_of_force, *velocity_of_force;
  LaneRow *cosine, *sine_over_omega, *minus_omega_sine, *struck;  // (m)
  LaneRow *a_of_force, *rate_of_force;                            // (s, m)

  // in: the state, and the force as guessed; out: the force, the motion, the state at the end
  LaneRow *a, *rate;  // (m)
  LaneRow *force, *displacement, *velocity, *dissipation;
  LaneRow *force_series, *displacement_series, *dissipation_series;
  LaneRow *end_a, *end_rate;  // (m)
  LaneRow end_displacement, end_velocity;

  // the contact: pressed and slack are 0 or 1; a linear spring where compliance is 0
  LaneRow pressed, slack, compliance, limit_force, spring, mu, tolerance;
  LaneRow iterations;  ///< of Newton's method
  LaneRow solved;      ///< 0 where it failed
};

/// Newton's method for the force and the state it leaves, in every lane; what happens in a lane
/// does not depend on the others. Uses what the processor has.
void solve_steps(StepLanes &lanes);

}  // namespace impactrig::models
