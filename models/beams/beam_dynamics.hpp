// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "models/modal/small_motion.hpp"
#include "models/rig.hpp"

namespace impactrig::models {

using ConstVector = Eigen::Ref<const Eigen::VectorXd>;
using VectorRef = Eigen::Ref<Eigen::VectorXd>;

struct BeamEnergy {
  double kinetic = 0.0;        ///< [J]
  double elastic = 0.0;        ///< [J]
  double spring = 0.0;         ///< in the hinge [J]
  double gravitational = 0.0;  ///< relative to touching straight and undeformed [J]
  double stop = 0.0;           ///< of a compliant stop's head and spring; no bar knows it [J]
};

/// A point of the bar's axis, seen from the stop: closing positive.
struct PointMotion {
  double displacement = 0.0;  ///< from hanging straight [m]
  double velocity = 0.0;      ///< [m/s]
};

/// The bar as a rigid body with the same moment of momentum about the hinge.
struct RigidPart {
  double angle = 0.0;  ///< mean rotation from hanging straight, closing > 0 [rad]; small angles
  double rate = 0.0;   ///< [rad/s]
  /// How far its mass lies where gravity would hang it: 1 hanging straight, of a rigid bar the
  /// angle's cosine, < 0 beyond a right angle [-].
  double along = 1.0;
};

/// A bar on its hinge with generalised coordinates q (n) and velocities v (n), pressed by stops.
/// The first is touched when the struck point is where it hangs at rest; penetration is how far it
/// is beyond. Coordinates are zero for the bar hanging straight. Not for
/// concurrent use of one object: evaluations share scratch memory.
class BeamDynamics : public SmallMotionBeam {
 public:
  virtual int size() const = 0;

  /// Generalised mass of each coordinate, hanging straight; scales the error of a step.
  virtual Eigen::VectorXd inertia_diagonal() const = 0;

  /// The straight, undeformed bar at an angle [rad, closing > 0, negative before touch] turning at
  /// a rate [rad/s].
  virtual void set_rigid_motion(double angle, double rate, VectorRef q, VectorRef v) const = 0;

  /// The same of a bar that has hung and turned like this for long: its weight and its turning
  /// stretch it, the struck point goes as fast. Without that it would ring along its axis. Of a bar
  /// that they tear or crush, as set_rigid_motion(), and false.
  virtual bool set_steady_motion(double angle, double rate, VectorRef q, VectorRef v) const {
    set_rigid_motion(angle, rate, q, v);
    return true;
  }

  /// Accelerations under the contact forces [N, compression > 0] of the first stop and of further
  /// ones, as many as are given.
  virtual void acceleration(ConstVector q, ConstVector v, std::span<const double> forces,
                            VectorRef a) = 0;

  /// Under that of the first stop alone.
  void acceleration(ConstVector q, ConstVector v, double contact_force, VectorRef a) {
    acceleration(q, v, {&contact_force, 1}, a);
  }

  virtual PointMotion struck_point(ConstVector q, ConstVector v) const = 0;

  /// Rate of struck_point().velocity when v changes at the rate a [m/s^2].
  virtual double struck_acceleration(ConstVector q, ConstVector v, ConstVector a) const = 0;

  /// The same of any point, x from the hinge [m].
  virtual double point_acceleration(double x, ConstVector q, ConstVector v,
                                    ConstVector a) const = 0;

  /// Any point, x from the hinge [m].
  virtual PointMotion point(double x, ConstVector q, ConstVector v) const = 0;

  /// The coordinates point(x, q, v) looks at, in q and likewise in v; the others may hold anything.
  virtual std::vector<int> coordinates_of(double x) const = 0;

  /// What damping in bar and hinge takes [W].
  virtual double damping_power(ConstVector q, ConstVector v) const = 0;

  virtual BeamEnergy energy(ConstVector q, ConstVector v) const = 0;
  virtual RigidPart rigid_part(ConstVector q, ConstVector v) const = 0;
};

}  // namespace impactrig::models
