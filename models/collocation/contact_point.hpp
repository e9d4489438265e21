// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <limits>

#include "models/collocation/bar_motion.hpp"
#include "models/contact/contact_force.hpp"
#include "models/contact_log.hpp"
#include "models/sensitivities/run_sensitivities.hpp"

namespace impactrig::models {

/// One stop of a CollocationRun: its contact force, what the step tried would make of it, and what
/// is worth keeping of the steps taken. contact_point_events.cpp finds where a phase of the contact
/// ends, contact_point_observe.cpp keeps extrema and sums.
class ContactPoint {
 public:
  enum class Event { none, gap, change };
  using Phase = ContactForce::Phase;

  /// `step` is to hold what a step does at the stop; none of the arguments is owned.
  ContactPoint(const Rig& rig, int number, BarMotion& bar, StopStep& step, ContactLog& log);

  void follow(RunSensitivities& sensitivities) { followed_ = &sensitivities; }

  int number() const { return number_; }

  const ContactForce& contact() const { return contact_; }

  ContactForce& contact() { return contact_; }

  Phase phase() const { return contact_.phase(); }

  double position() const { return position_; }

  double gap() const { return gap_; }  ///< at the straight bar where it touches [m]

  long evaluations() const { return evaluations_; }  ///< of the contact law

  void evaluated(long count) { evaluations_ += count; }

  /// The impact has this energy [J], the bar closes on the stop at this speed [m/s] and goes no
  /// deeper than this [m]. Steps of the accuracy asked for.
  void set_scales(double energy, double approach, double deepest, double accuracy);

  /// Of what the bar first has to be stopped, the energy [J].
  void set_local_energy(double energy) {
    local_force_ = std::min(force_scale_, contact_.elastic(penetration_storing(contact_, energy)));
  }

  double depth() const { return depth_; }  ///< of an impact with all the energy [m]

  /// Whether it is of an impact whose energy [J] goes elsewhere for the most part.
  bool takes_little(double energy) const { return contact_.stored(depth_) < 0.1 * energy; }

  double force_scale() const { return force_scale_; }  ///< likewise [N]

  /// Length of the first step of a phase [s]: so short that the corner of the contact law at touch
  /// does not matter.
  double first_step() const { return first_step_; }

  /// The bar's point before the stop, its displacement beyond the gap.
  PointMotion struck() const { return seen(bar_.struck(number_)); }

  PointMotion struck_at(double part, double* acceleration = nullptr) {
    return seen(bar_.struck_at(number_, part, acceleration));
  }

  PointMotion struck_in_flight(double time) { return seen(bar_.struck_in_flight(number_, time)); }

  /// First guess of the step's force, by the low terms of the last one's.
  void predict_force();

  /// How the contact answers at the end of the first part of the solved step; not at all where it
  /// does not press.
  BarMotion::ContactSlope slope_at(double part) const;

  /// The motion at the nodes as the bar told it, now seen from the stop.
  void see_nodes() {
    if (gap_ != 0.0) step_.displacement.array() -= gap_;
  }

  /// A depth at a node, no nearer to none than this part of the step's way: there laws may be
  /// singular.
  double resolved(double depth) const {
    const double least = 1e-9 * way();
    return std::abs(depth) < least ? least : depth;
  }

  /// What the solved step does at the stop, when nodes and force's series are known.
  void complete();

  /// What force and dissipation leave out over the step tried, as impulse and energy, against these
  /// [N s, J], and as force, against the peak so far or that of the energy that has to go first.
  double force_error(double impulse, double energy) const;

  /// What the motion in free flight leaves out, against what matters for finding the touch.
  double motion_error() const;

  /// The first end of the phase within the step.
  void find_event();

  Event event() const { return event_; }

  double event_part() const { return event_part_; }  ///< 2 where there is none

  void forget_event() {
    event_ = Event::none;
    event_part_ = 2.0;
  }

  /// How far behind its end the step tried passed the stop's gap, as a part of it.
  double lateness() const;

  /// The force as a history shows it, the point moving like this in the present phase [N].
  double shown_force(const PointMotion& p) const;

  /// Extrema of the part of the step that is taken, which began so long after first touch.
  void observe(double begun, double part);

  /// Its impulse and dissipation.
  void add_to_totals(double part);

  /// For predict_force(), unless an event ended the step.
  void keep_series(double part, bool ended);

  void drop_series() { last_series_.resize(0); }

  void begin_totals() { totals_ = {}; }

  const ContactTotals& totals() const { return totals_; }

  /// Of the run's first contact, the least depth at which the bar that was leaving turned back
  /// without having left [m]; infinite where it never did.
  double shallowest_turn() const { return shallowest_turn_; }

  /// Up to the end of a part of the solved step [N s].
  double impulse_until(double part) const { return totals_.impulse + integral(step_.force, part); }

 private:
  struct Rates {
    double low, high;
  };

  /// The contact's switch() at a place of the step.
  struct Look {
    double place, value;
  };

  /// The last two places looked at, and how the point moves at the last.
  struct Seen {
    Look first, last;
    PointMotion motion;
  };

  PointMotion seen(const PointMotion& p) const { return {p.displacement - gap_, p.velocity}; }

  /// Between the first and the last node of the step tried [m].
  double way() const {
    const NodeVector& displacement = step_.displacement;
    return std::abs(displacement[rule_.nodes() - 1] - displacement[0]);
  }

  bool certainly_goes_on() const;
  bool may_switch_unseen() const;
  Look look(double place, const PointMotion& p) const;
  bool look_on(Seen& seen, double here, const PointMotion& p);
  double gap_between(double before, const PointMotion& p0, double here, const PointMotion& p1);
  double switch_at(double place);
  double root_of_switch(double low, double high);
  double switch_in_dip(const Look& first, const Look& middle, const Look& last);
  double switch_before_gap(double place, double gap);
  double root_of_gap(double low, double at_low, double guess, double high);
  double most_damping() const;
  double missing_at_begin() const;
  double rounding() const;
  double answer() const;
  double integral(const NodeVector& at_nodes, double part) const;
  void note_peak(double force, double part);
  double rate_at(double place, double& force);
  double rate_near_peak(double place);
  bool may_be_largest() const;
  bool find_peak(double low, double at_low, double high, double at_high);
  Rates observe_peak(double low, double high);
  void observe_deepest(double part, double depth);
  void observe_early_peak(double high);
  void observe_jump();
  void observe_pull(double part);
  double depth_of_turn(double before, const PointMotion& p0, double here, const PointMotion& p1,
                       double& place);
  void observe_turn(double before, const PointMotion& p0, double here, const PointMotion& p1);

  int number_;
  double position_, gap_;
  BarMotion& bar_;
  const Collocation& rule_;
  StopStep& step_;
  ContactLog& log_;
  ContactForce contact_;
  ContactTotals totals_;
  double depth_ = 0.0, force_scale_ = 0.0, local_force_ = 0.0, first_step_ = 0.0, time_scale_ = 0.0;
  Event event_ = Event::none;
  double event_part_ = 2.0;
  double begun_ = 0.0;      // the step, after first touch [s]
  Eigen::VectorXd rates_;   // of the step's force, as of Collocation::rates()
  NodeVector last_series_;  // of the force over the last step; empty after an event
  double last_h_ = 0.0, last_part_ = 1.0;
  long evaluations_ = 0;
  RunSensitivities* followed_ = nullptr;
  double shallowest_turn_ = std::numeric_limits<double>::infinity();
  bool rising_ = false;      // the force, where its series says that it does not
  double peak_part_ = -1.0;  // where in the step the force was largest so far in its contact
};

}  // namespace impactrig::models
