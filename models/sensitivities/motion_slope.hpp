// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "models/collocation/bar_motion.hpp"
#include "models/sensitivities/rig_effect.hpp"

namespace impactrig::models {

/// The stencil along which a motion of this accuracy is differentiated: two places err by 1e-8,
/// half as many evaluations as five take, and less than a run that is not more accurate than that.
/// Of a bar that swings far they err by what its slopes, straight ways through a turn, stretch it.
inline ParameterStencil stencil_of_motion(const RigEffect& effect, const Solver& solver) {
  constexpr double coarse = 1e-7;
  const bool light = solver.accuracy > coarse && !swings_far(effect.by().rig());
  return light ? effect.by().lighter() : effect.by();
}

/// The derivative of a BarMotion by one number of the rig, carried on from step to step: it solves
/// the equations of motion linearised about the motion's own solution, at the same nodes. Points
/// before stops and forces are those of BarMotion, gaps apart.
class MotionSlope {
 public:
  /// The straight bar at an angle [rad] turning at a rate [rad/s].
  struct Start {
    double angle = 0.0, rate = 0.0;
  };

  /// Slopes of a point at the nodes (s).
  struct Nodes {
    NodeVector displacement, velocity;
  };

  /// Slopes of what the lasers see and of what the sensor of a compliant stop carries, and how fast
  /// that itself changes in time.
  struct Spots {
    double velocity = 0.0, displacement = 0.0, sensor_force = 0.0;
    double velocity_rate = 0.0, displacement_rate = 0.0, sensor_force_rate = 0.0;
    double deflection = 0.0, extension = 0.0;  ///< of a hinge that is turned as stated
  };

  /// Of an improvement, as parts of the speed that counts and for the parameter's size.
  struct Change {
    double size = 0.0;
    double of = 0.0;        ///< size of the slopes themselves
    double rounding = 0.0;  ///< of slopes as large as the motion, where nothing is left to improve
  };

  virtual ~MotionSlope() = default;

  /// The motion starts; `starts`: how it would at each place of the parameter's stencil.
  virtual void start(std::span<const Start> starts) = 0;

  /// The motion's step is solved under these forces, stop by stop (s each): a first guess.
  virtual void begin_step(std::span<const NodeVector> forces) = 0;

  /// Brings the slopes nearer to their equations, under these slopes of the forces; tells those of
  /// the points before the stops.
  virtual Change improve(std::span<const NodeVector> forces, std::span<Nodes> points) = 0;

  /// The forces' slopes change by so much; the motion's by the response. Returns the size of that.
  virtual double press(std::span<const NodeVector> changes) = 0;

  /// Where the next step begins.
  virtual PointMotion struck(int stop) const = 0;

  /// Goes to a place of the solved step, or, at 0, to where the next one begins.
  virtual void look(double part) = 0;

  virtual PointMotion struck_at_place(int stop) const = 0;
  virtual Spots spots() const = 0;  ///< at the place

  /// The solved step is taken, its end later by `shift` [s a unit]. Before the motion takes it.
  virtual void take(double shift) = 0;

  /// By how much later friction in the hinge changes, where the solved step ends with that [s a
  /// unit].
  virtual double hinge_shift() = 0;

  /// Friction in the hinge has changed where the next step begins.
  virtual void change_hinge() = 0;
};

}  // namespace impactrig::models
