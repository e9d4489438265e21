// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "models/beams/beam_dynamics.hpp"
#include "models/contact/contact_force.hpp"
#include "models/contact_log.hpp"
#include "models/integration/dop853.hpp"
#include "models/simulation.hpp"

namespace impactrig::models {

/// simulate() by another family of integrators, for comparison: any beam under its contact,
/// explicit and from event to event. impact_run_events.cpp finds where a phase of the contact ends
/// within a step, impact_run_observe.cpp keeps what is worth keeping of a step. The state is y = [q
/// (n), v (n), impulse, energy dissipated by the contact, energy damped in bar and hinge].
class ImpactRun {
 public:
  ImpactRun(const Rig& rig, const Solver& solver, const SimulationOptions& options,
            BeamDynamics& beam);
  Simulation simulate();

 private:
  using Phase = ContactForce::Phase;
  using Vector = Eigen::VectorXd;

  PointMotion struck(const Vector& y) const {
    return beam_->struck_point(y.head(n_), y.segment(n_, n_));
  }

  double gap_event(const Vector& y) const { return struck(y).displacement; }

  double switch_event(const Vector& y) const {
    const PointMotion p = struck(y);
    return contact_.switching(p.displacement, p.velocity).value;
  }

  /// Of the struck point, in a state of the given slope.
  double acceleration(const Vector& y, const Vector& slope) const {
    return beam_->struck_acceleration(y.head(n_), y.segment(n_, n_), slope.segment(n_, n_));
  }

  ContactTotals totals(const Vector& y) const { return {y[2 * n_], y[2 * n_ + 1]}; }

  double lost_to_damping(const Vector& y) const { return y[2 * n_ + 2] - damped_before_; }

  BeamEnergy energy(const Vector& y) const { return beam_->energy(y.head(n_), y.segment(n_, n_)); }

  RigidPart rigid_part(const Vector& y) const {
    return beam_->rigid_part(y.head(n_), y.segment(n_, n_));
  }

  void set_scales(double kinetic, double approach);
  double fastest_vibration(double depth);
  double fastest_decay();
  void swing_to_touch();
  void first_touch();
  void integrate();
  bool event_in_attempt(double& theta, bool& at_pull);
  double excursion_in_attempt(double sign);
  double root_of_event(bool pull, double theta_low, double theta_high);
  double land_on(double theta, bool pull);
  void touch();
  void observe_attempt();
  void observe_extrema();
  double peak_in_attempt(double from, double to, double& force);
  void observe_deepest(double theta);
  void sample_history();
  void conclude();

  const Rig& rig_;
  const Solver& solver_;
  const SimulationOptions& options_;
  BeamDynamics* beam_;
  int n_;
  bool damped_;
  ContactForce contact_;
  Dop853 stepper_, probe_;
  Dop853::RightHandSide f_;
  Vector weights_, scratch_;
  double t_end_ = 0.0;
  double first_step_ = 0.0, longest_step_ = 0.0;
  double time_of_touch_ = 0.0;
  double damped_before_ = 0.0;  // during the swing to first touch [J]
  double elastic_reach_;  // √(2 C): how far √energy can move the struck point elastically [m/√J]
  double approach_ = 0.0;  // speed at first touch [m/s]
  double velocity_place_ = 0.0, displacement_place_ = 0.0, laser_rest_ = 0.0;
  std::vector<int> history_rows_;
  bool done_ = false;
  Simulation result_;
  ContactLog log_;
};

}  // namespace impactrig::models
