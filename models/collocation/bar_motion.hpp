// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <span>

#include "models/beams/beam_dynamics.hpp"
#include "models/collocation/collocation.hpp"
#include "models/collocation/step_ladder.hpp"

namespace impactrig::models {

class MotionSlope;
class RigEffect;
struct HistoryRequest;

/// What a step tried does at a stop, σ in [0, 1]; the bar's point before the stop moves as its
/// PointMotion tells.
struct StopStep {
  NodeVector force, displacement, velocity, dissipation;  // at the nodes
  NodeVector force_series, displacement_series, dissipation_series;
  NodeVector change;             // of the force at the nodes, to be answered by press()
  NodeVector to_depth, to_rate;  // of a law that presses at the nodes, as its solution last saw it
  PointMotion at_end;
};

/// A bar in motion as CollocationRun drives it, a step at a time, under contact forces given by
/// their values at the collocation nodes of the step. The points before the stops answer changes of
/// the forces linearly, or nearly, so that contact laws and bar are solved apart: the laws with the
/// bar's response, the bar by improve() until it is at rest with the forces.
///
/// Stops are numbered as in Rig::contact_of(). The displacement of the point before a stop is
/// counted from where the bar hangs straight, towards the stop.
///
/// Calls: start(); then for each step begin_step(), improve() and press() in turn, finish(), looks
/// at the motion, and take().
class BarMotion {
 public:
  /// A point at the nodes under a unit force at each node (s, s).
  struct Response {
    NodeMatrix displacement_of_force, velocity_of_force;
    double most_displacement = 0.0, most_velocity = 0.0;  ///< of a force of at most 1 N

    void set_most() {
      const auto largest_row_sum = [](const NodeMatrix& matrix) {
        return matrix.cwiseAbs().rowwise().sum().maxCoeff();
      };
      most_displacement = largest_row_sum(displacement_of_force);
      most_velocity = largest_row_sum(velocity_of_force);
    }
  };

  /// What a history shows at one instant, before the first stop.
  struct Sample {
    PointMotion struck;
    double velocity = 0.0, displacement = 0.0;              // at the lasers' spots
    double velocity_slope = 0.0, displacement_slope = 0.0;  // there, along the bar, where asked for
    double sensor_force = 0.0;                              // of a compliant stop
    double deflection = 0.0, extension = 0.0;               // of a hinge that is turned as stated
    double deflection_slope = 0.0, extension_slope = 0.0;   // there, as velocity_slope
  };

  /// How a contact answers: its force by depth [N/m] and by the rate of that [N s/m].
  struct ContactSlope {
    double to_depth = 0.0, to_rate = 0.0;
  };

  virtual ~BarMotion() = default;

  virtual const Collocation& rule() const = 0;
  virtual const StepLadder& ladder() const = 0;

  /// Of a step that does not miss how the contact acts on what moves fastest [s].
  virtual double longest_step() const { return ladder().longest; }

  /// The straight bar at an angle [rad, negative before touch] turning at a rate [rad/s].
  virtual void start(double angle, double rate) = 0;

  /// Whether it began stretched as it would hang and turn; not where that would tear or crush it.
  virtual bool began_steady() const { return true; }

  struct Scales {
    double energy = 0.5;        ///< of what the contact has to stop first [J]
    double contact_time = 1.0;  ///< in which it does so [s]; faster vibration moves it little,
    double damping = 0.0;       ///< but where its law is damped, by μ [s/m]
    double force = 1.0;         ///< that the first stop's contact stops it with [N]
    double impulse = 1.0;       ///< likewise [N s]
    /// What a stop's head that rings makes of vibration that comes with the bar.
    double magnification = 1.0;
  };

  /// What errors are measured against.
  virtual void set_scales(const Scales& scales) = 0;

  virtual PointMotion struck(int stop) const = 0;
  virtual BeamEnergy energy() const = 0;
  virtual RigidPart rigid_part() const = 0;

  /// Whether the sensor of a stop that gives way, pressed no more, may yet carry more than it has.
  virtual bool sensor_may_rise() const { return false; }

  /// Of the point before the first stop, the swing apart [m/N].
  virtual double elastic_compliance() const = 0;

  /// The point before a stop touches it and will press. Its displacement there [m] is this,
  /// whatever landing on the touch and rounding have left of it.
  virtual void expect_contact(int /*stop*/, double /*displacement*/) {}

  /// The steps that follow press at no stop.
  virtual void expect_flight() {}

  virtual void begin_step(int level) = 0;
  /// Begins the step tried last again, shorter: its first part alone. Not called when
  /// parts_exact().
  virtual void begin_part(double part) = 0;
  virtual double step() const = 0;  ///< length of the step tried [s]

  /// Of the point before a stop to the force of a stop.
  virtual const Response& response(int point, int stop) const = 0;

  /// Brings the bar nearer to its equations of motion under the forces; tells how the points then
  /// move at the nodes. False when that leads nowhere.
  virtual bool improve(std::span<StopStep> stops) = 0;

  /// The forces change; so does the motion, by the response.
  virtual void press(std::span<const StopStep> stops) = 0;

  /// Whether improve() and press() leave nothing to improve.
  virtual bool settled() const = 0;

  /// The step is solved, under these forces and their series.
  virtual void finish(std::span<const StopStep> stops) = 0;

  /// Energy that damping outside the contacts takes over the first part of the solved step [J].
  virtual double damped(double) const { return 0.0; }

  /// Work of what turns the hinge as stated over the solved step [J].
  virtual double driven() const { return 0.0; }

  /// Where in the solved step friction in the hinge changes first, as a part of it: above 1 where
  /// it does not, 0 where the step should not have begun as it did.
  virtual double hinge_change() { return 2.0; }

  /// How far behind its end the step tried passed that change, as a part of it.
  virtual double hinge_lateness() const { return 0.0; }

  /// Friction changes as hinge_change() found: at the end of the step taken since, or where the
  /// step has to be tried again.
  virtual void change_hinge() {}

  /// Whether even the bar's fastest vibration turns by at most a radian from node to node of the
  /// solved step: its end then errs far less than the force between the nodes.
  virtual bool resolves_vibration() const { return false; }

  /// How fast the point before a stop vibrates, at the end of the solved step, in modes that turn
  /// by more than a radian from node to node of it: what of that a damper of the contact that the
  /// force does not know would take within a time [m/s]. `damping` in N s/m.
  virtual double undamped_speed(int /*stop*/, double /*damping*/, double /*time*/) const {
    return 0.0;
  }

  virtual PointMotion struck_at_end(int stop) const = 0;

  /// Error of the bar's motion by the step, as a part of the speed its energy would give it; what
  /// the forces leave out apart.
  virtual double error() const = 0;

  /// The point before a stop within the solved step.
  virtual PointMotion struck_at(int stop, double part, double* acceleration = nullptr) = 0;

  /// samples[k] is at first + k spacing, as parts of the solved step.
  virtual void sample(double first, double spacing, std::span<Sample> samples) = 0;

  /// Whether a step may be taken in part as exactly as a whole.
  virtual bool parts_exact() const = 0;

  /// For how long from the last step taken the points before the stops, with these gaps [m],
  /// certainly stay away from them, in free flight [s]; zero where that is not known. More than
  /// `most` is of no use [s].
  virtual double clear_time(std::span<const double> /*gaps*/, double /*most*/) { return 0.0; }

  /// Free flight for as long as that, or longer where there is no stop. Called where clear_time()
  /// is not zero.
  virtual void fly(double) {}

  /// samples[k] is at first + k spacing [s] of the flight from where the bar is.
  virtual void sample_flight(double, double, std::span<Sample>) {}

  /// The point before a stop after a time of the flight from where the bar is [s].
  virtual PointMotion struck_in_flight(int stop, double) { return struck(stop); }

  /// Its derivative by a number of the rig, of which both are kept; none where it cannot be
  /// followed.
  virtual std::unique_ptr<MotionSlope> follow(const RigEffect& effect, const Solver& solver,
                                              const HistoryRequest& history);

  /// The first part of the solved step is to be taken: what is worth keeping of it.
  virtual void observe(double) {}

  /// Whether see_contact() is of use.
  virtual bool asks_for_contact() const { return false; }

  /// How the contact of the first stop answers at the end of what is to be taken.
  virtual void see_contact(const ContactSlope&) {}

  /// The solved step is taken, or the first part of it where parts_exact().
  virtual void take(double part) = 0;
};

}  // namespace impactrig::models
