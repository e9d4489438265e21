// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/LU>
#include <chrono>
#include <functional>
#include <vector>

#include "models/collocation/bar_motion.hpp"
#include "models/collocation/contact_point.hpp"
#include "models/contact/contact_force.hpp"
#include "models/contact_log.hpp"
#include "models/sample_impulses.hpp"
#include "models/sensitivities/run_sensitivities.hpp"
#include "models/simulation.hpp"
#include "models/time_limit.hpp"

namespace impactrig::models {

/// One run of simulate() by collocation of the contact forces: over a step a force is a polynomial
/// through its values at the nodes, which satisfy the contact law with the motion they cause
/// (Newton, for all stops that press together). Steps are as long as the Legendre series of force
/// and motion converge, and end where a phase of a contact ends. In free flight nothing is
/// evaluated at a stop but the gap. What belongs to one stop is a ContactPoint's.
///
/// Calls: complete(), or begin() and then propose(), solve() and judge() until done(), where
/// solve() may be done elsewhere for several runs at a time; in the end conclude().
class CollocationRun {
 public:
  CollocationRun(const Rig& rig, const Solver& solver, const SimulationOptions& options,
                 BarMotion& bar);

  /// The run is followed with derivatives, by what knows the bar's motion; not owned.
  void follow(RunSensitivities& sensitivities) {
    followed_ = &sensitivities;
    points_.front().follow(sensitivities);
  }

  void complete();  ///< the whole run

  void begin();

  bool done() const { return done_; }

  /// Begins the next step, with a first guess of its force.
  void propose();

  /// Brings the force to the contact law and the bar to the force; false when that fails.
  bool solve();

  const StopStep& proposed() const { return steps_.front(); }

  /// For a step against a single stop solved elsewhere, by so many evaluations of the contact law:
  /// to be filled, but for `change`, and the bar to be told.
  StopStep& solution(long evaluations);

  /// Takes the step, up to its event, or rejects it.
  void judge(bool solved);

  /// By how much the first contact fell short of what its errors were compared with: of the
  /// accuracy asked for, the part to solve it to again; 1 where the scales were right, as they are
  /// but for a bar that hardly touches, or hardly parts.
  double smallness() const;

  /// What is known of the result while it runs.
  const Simulation& so_far() const { return result_; }

  Simulation conclude();

  const ContactForce& contact() const { return points_.front().contact(); }

  /// Of the first contact: ContactPoint::shallowest_turn().
  double shallowest_turn() const { return points_.front().shallowest_turn(); }

  /// Of the first stop's force [N].
  double newton_tolerance() const { return newton_tolerance(points_.front()); }

 private:
  using Phase = ContactForce::Phase;

  // Events this close are one, as a part of the step.
  static constexpr double coincidence = 1e-9;
  // Of phases that end at once, one after the other, this many of each stop are believed: a step
  // too long for how a contact begins has its law let go and press again without end.
  static constexpr int most_stalled = 2;
  // A first contact that ends slower than this part of its approach is to be solved again: errors
  // of the way then count that much more as time.
  static constexpr double slowest_part = 0.1;

  /// What the step tried ends with.
  enum class End { step, event, hinge, run };

  struct Attempt {
    double error = 0.0;  ///< to be compared with 1
    double part = 1.0;   ///< of the step that is taken
    End end = End::step;
  };

  /// Newton's equations for stops that press together, all stops in turn.
  struct Equations {
    Eigen::MatrixXd jacobian;
    Eigen::VectorXd residual, correction;
    Eigen::PartialPivLU<Eigen::MatrixXd> factor;
  };

  /// A stop under the forces found so far, and df/dδ, at the nodes.
  struct Together {
    NodeVector depth, rate;
    std::array<ContactForce::Response, most_nodes> law;
  };

  const StopStep& step_of(const ContactPoint& point) const {
    return steps_[static_cast<std::size_t>(point.number())];
  }

  StopStep& step_of(const ContactPoint& point) {
    return steps_[static_cast<std::size_t>(point.number())];
  }

  double newton_tolerance(const ContactPoint& point) const;
  void solve_attempt();
  bool solve_step();
  bool press();
  bool solve_force(ContactPoint& point, StopStep& step);
  bool solve_forces();
  void linearise(ContactPoint& point);
  double correct(ContactPoint& point);
  void weigh(bool solved);
  double derivative_error() const;
  void find_events();
  bool begun_rightly();
  void change_hinge();
  bool land_on_event();
  double speed_before(const ContactPoint& point) const;
  void set_scales();
  double share_of_contact() const;
  void grow_scales();
  void limit_steps();
  void first_touch();
  void take_attempt();
  void follow_step();
  bool over_at(const ContactPoint& point);
  void touch(ContactPoint& point);
  bool records_jumps(const ContactPoint& point) const;
  void note_jump(const ContactPoint& point, double before, const PointMotion& motion);
  void sample_history(double time, const std::function<void(double, double)>& look,
                      const std::function<PointMotion(ContactPoint&, double)>& struck_at,
                      const std::function<double(double)>& impulse_until);
  bool free() const;
  bool leap();
  int level_after_rejection(int level) const;
  int level_until_event() const;
  bool ends_far_beyond_contact() const;
  int next_level() const;
  double longest_step() const;
  bool leave_event(ContactPoint& point);
  void leave_events(int& next);
  bool ends_early();
  bool out_of_time();
  void reject(int level);
  void take_or_land();
  void stop_without_headway();
  void take_shorter();

  const Rig& rig_;
  const Solver& solver_;
  const SimulationOptions& options_;
  BarMotion& bar_;
  const Collocation& rule_;
  std::vector<StopStep> steps_;  // at the stops
  std::vector<ContactPoint> points_;
  std::vector<double> gaps_;  // [m]
  Equations equations_;
  std::vector<Together> together_;
  double longest_ = 0.0;   // step that sees the contacts [s]
  double parted_ = 0.0;    // the last contact, when it ended [s]
  int level_ = 0;          // of the step to try next
  bool rejected_ = false;  // the one before was
  int stalled_ = 0;        // phases that ended at once, without a step between
  RefusedLevel refused_;   // by its error
  bool done_ = false;
  std::chrono::steady_clock::time_point started_;

  // [s] from first touch; of the swing before, from release.
  double t_ = 0.0, t_end_ = 0.0;
  Attempt tried_;
  std::vector<BarMotion::Sample> samples_;
  SampleImpulses impulses_;
  double laser_rest_ = 0.0, slope_rest_ = 0.0;  // displacement seen at first touch [m], [-]

  double approach_ = 0.0, impulse_scale_ = 0.0, energy_scale_ = 0.0;
  bool held_ = false;                // the bar, by more than the contacts
  double contact_time_ = 0.0;        // of the shortest that is expected [s]
  bool resolved_ = true;             // the bar's vibration, in all steps of the first contact
  std::optional<double> smallness_;  // of the first contact, where the scales are another's
  double damped_ = 0.0;              // in bar, hinge and compliant stop since first touch [J]
  // √(2 C) for each stop: how far √energy can move its point elastically [m/√J]
  std::vector<double> elastic_reach_;
  Looks looks_;                          // at the time
  std::optional<TimeLimit> time_limit_;  // of small motion from the first look at it
  Simulation result_;
  ContactLog log_;
  RunSensitivities* followed_ = nullptr;
};

}  // namespace impactrig::models
