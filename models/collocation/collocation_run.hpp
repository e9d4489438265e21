// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <functional>
#include <vector>

#include "models/collocation/bar_motion.hpp"
#include "models/contact/contact_force.hpp"
#include "models/contact_log.hpp"
#include "models/modal/modal_sensitivities.hpp"
#include "models/simulation.hpp"
#include "models/time_limit.hpp"

namespace impactrig::models {

/// One run of simulate() by collocation of the contact force: over a step the force is a polynomial
/// through its values at the nodes, which satisfy the contact law with the motion they cause
/// (Newton). Steps are as long as the Legendre series of force and motion converge, and end where a
/// phase of the contact ends. In free flight nothing is evaluated at the stop but the gap.
/// collocation_events.cpp finds where a phase ends, collocation_run_observe.cpp keeps what is worth
/// keeping of a step.
///
/// Calls: complete(), or begin() and then propose(), solve() and judge() until done(), where
/// solve() may be done elsewhere for several runs at a time; in the end conclude().
class CollocationRun {
 public:
  enum class Event { none, gap, pull, end };

  /// A step tried: what it would make of the force and the struck point, σ in [0, 1].
  struct Attempt {
    NodeVector force, displacement, velocity, dissipation;  // at the nodes
    NodeVector force_series, displacement_series, dissipation_series;
    PointMotion at_end;
    double error = 0.0;  ///< to be compared with 1
    Event event = Event::none;
    double part = 1.0;  ///< of the step that is taken: up to the event
  };

  CollocationRun(const Rig& rig, const Solver& solver, const SimulationOptions& options,
                 BarMotion& bar);

  /// The run is followed with derivatives; not owned. For a ModalMotion that begins at touch.
  void follow(ModalSensitivities& sensitivities) { followed_ = &sensitivities; }

  void complete();  ///< the whole run

  void begin();

  bool done() const { return done_; }

  /// Begins the next step, with a first guess of its force.
  void propose();

  /// Brings the force to the contact law and the bar to the force; false when that fails.
  bool solve();

  const Attempt& proposed() const { return tried_; }

  /// For a step solved elsewhere, by so many evaluations of the contact law: to be filled from
  /// force to at_end, and the bar to be told.
  Attempt& solution(long evaluations);

  /// Takes the step, up to its event, or rejects it.
  void judge(bool solved);

  Simulation conclude();

  const ContactForce& contact() const { return contact_; }

  double newton_tolerance() const;  ///< of the force [N]

 private:
  using Phase = ContactForce::Phase;

  void solve_attempt();
  bool solve_step();
  void weigh(bool solved);
  bool solve_force(const NodeVector& displacement, const NodeVector& velocity, NodeVector& change);
  void predict_force(double h);
  double force_error() const;
  double motion_error() const;
  double derivative_error() const;
  void find_event();
  double gap_between(double before, const PointMotion& p0, double here, const PointMotion& p1);
  double pull_between(double before, double here, const PointMotion& p1);
  double root_of_gap(double low, double at_low, double guess, double high);
  bool land_on_event();
  void set_scales();
  void first_touch();
  void take_attempt();
  void add_to_totals();
  void touch();
  void observe_attempt();
  void note_peak(double force, double part);
  void observe_peak(double low, double high);
  void observe_deepest(double part, double depth);
  void observe_turn(double before, const PointMotion& p0, double here, const PointMotion& p1);
  bool leap();
  void sample_history(double time, const std::function<void(double, double)>& look);
  double integral(const NodeVector& at_nodes, double part) const;
  int level_after_rejection(int level) const;
  int next_level() const;
  bool leave_event();
  bool ends_early();
  bool out_of_time();
  void reject(int level);
  void take_or_land();
  void take_shorter();

  const Rig& rig_;
  const Solver& solver_;
  const SimulationOptions& options_;
  BarMotion& bar_;
  ContactForce contact_;
  const Collocation& rule_;
  double longest_ = 0.0, first_ = 0.0;  // step [s]; the first in a phase of the contact
  int level_ = 0;                       // of the step to try next
  bool rejected_ = false;               // the one before was
  bool done_ = false;
  std::chrono::steady_clock::time_point started_;

  double t_ = 0.0, time_of_touch_ = 0.0, t_end_ = 0.0;
  Attempt tried_;
  Eigen::VectorXd rates_;   // of the attempt's force, as of Collocation::rates()
  NodeVector last_series_;  // of the force over the last step; empty after an event
  double last_h_ = 0.0;
  std::vector<BarMotion::Sample> samples_;
  double laser_rest_ = 0.0;  // displacement seen at first touch [m]

  double approach_ = 0.0, depth_ = 0.0, impulse_scale_ = 0.0, force_scale_ = 0.0,
         energy_scale_ = 0.0;
  ContactTotals totals_;
  double elastic_reach_;  // √(2 C): how far √energy can move the struck point elastically [m/√J]
  long evaluations_ = 0;
  TimeLimit time_limit_{0.0};
  Simulation result_;
  ContactLog log_;
  ModalSensitivities* followed_ = nullptr;
  double peak_part_ = -1.0;  // where in the step the force was largest so far in its contact
};

}  // namespace impactrig::models
