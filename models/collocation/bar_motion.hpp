// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "models/beams/beam_dynamics.hpp"
#include "models/collocation/collocation.hpp"
#include "models/collocation/step_ladder.hpp"

namespace impactrig::models {

/// A bar in motion as CollocationRun drives it, a step at a time, under a contact force given by
/// its values at the collocation nodes of the step. The struck point answers changes of the force
/// linearly, or nearly, so that contact law and bar are solved apart: the law with the bar's
/// response, the bar by improve() until it is at rest with the force.
///
/// Calls: start(); then for each step begin_step(), improve() and press() in turn, finish(), looks
/// at the motion, and take().
class BarMotion {
 public:
  /// The struck point at the nodes under a unit force at each node (s, s).
  struct Response {
    NodeMatrix displacement_of_force, velocity_of_force;
  };

  /// What a history shows at one instant.
  struct Sample {
    PointMotion struck;
    double velocity = 0.0, displacement = 0.0;  // at the lasers' spots
    double sensor_force = 0.0;                  // of a compliant stop
  };

  virtual ~BarMotion() = default;

  virtual const Collocation& rule() const = 0;
  virtual const StepLadder& ladder() const = 0;

  /// The straight bar at an angle [rad, negative before touch] turning at a rate [rad/s].
  virtual void start(double angle, double rate) = 0;

  /// Errors are measured against this energy [J], of what the contact has to stop first; vibration
  /// much faster than it does so [s] moves the force little.
  virtual void set_scales(double kinetic, double contact_time) = 0;

  virtual PointMotion struck() const = 0;
  virtual BeamEnergy energy() const = 0;
  virtual RigidPart rigid_part() const = 0;
  virtual double elastic_compliance() const = 0;  ///< of the struck point, the swing apart [m/N]

  /// The steps that follow press.
  virtual void expect_contact() {}

  virtual void begin_step(int level) = 0;
  /// Begins the step tried last again, shorter: its first part alone. Not called when
  /// parts_exact().
  virtual void begin_part(double part) = 0;
  virtual double step() const = 0;  ///< length of the step tried [s]

  virtual const Response& response() const = 0;

  /// Brings the bar nearer to its equations of motion under the force; tells how the struck point
  /// then moves at the nodes. False when that leads nowhere.
  virtual bool improve(const NodeVector& force, NodeVector& displacement, NodeVector& velocity) = 0;

  /// The force changes; so does the motion, by the response.
  virtual void press(const NodeVector& change) = 0;

  /// Whether improve() and press() leave nothing to improve.
  virtual bool settled() const = 0;

  /// The step is solved, under the force of a Legendre series.
  virtual void finish(const NodeVector& force, const NodeVector& force_series) = 0;

  /// Energy that damping outside the contact takes over the first part of the solved step [J].
  virtual double damped(double) const { return 0.0; }

  virtual PointMotion struck_at_end() const = 0;

  /// Error of the bar's motion by the step, as a part of the speed its energy would give it; what
  /// the force leaves out apart.
  virtual double error() const = 0;

  /// The struck point within the solved step.
  virtual PointMotion struck_at(double part, double* acceleration = nullptr) = 0;

  /// samples[k] is at first + k spacing, as parts of the solved step.
  virtual void sample(double first, double spacing, std::span<Sample> samples) = 0;

  /// Whether a step may be taken in part as exactly as a whole.
  virtual bool parts_exact() const = 0;

  /// For how long from the last step taken the struck point certainly stays away from the stop, in
  /// free flight [s]; zero where that is not known.
  virtual double clear_time() const { return 0.0; }

  /// Free flight for as long as that, or longer where there is no stop. Called where clear_time()
  /// is not zero.
  virtual void fly(double) {}

  /// samples[k] is at first + k spacing [s] of the flight from where the bar is.
  virtual void sample_flight(double, double, std::span<Sample>) {}

  /// The solved step is taken, or the first part of it where parts_exact().
  virtual void take(double part) = 0;
};

}  // namespace impactrig::models
