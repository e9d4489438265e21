// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "models/contact/contact_force.hpp"

namespace impactrig::models {

/// A free impact of one degree of freedom, m δ̈ = −f(δ, δ̇), δ(0) = 0, δ̇(0) = v.
struct FreeImpact {
  /// −δ̇ / v where the bodies part, or where the force ends; 0 where a contact that may pull holds
  /// them for good [-].
  double rebound_ratio = 0.0;
  double duration = 0.0;         ///< until then, infinite where they are held [s]
  double peak_force = 0.0;       ///< [N]
  double max_penetration = 0.0;  ///< [m]
  double lowest_force = 0.0;     ///< below zero where the contact pulls [N]

  struct Point {
    double penetration, force;  ///< [m], [N]
  };

  std::vector<Point> loop = {};  ///< from touch to the end
};

/// Solves the impact in the angle of its phase plane, tan φ = √(2 U(δ) / m) / δ̇: from touch at 0
/// over the deepest point at π/2 to δ = 0 at π, with steps that crowd at both ends, where δ of φ is
/// not smooth. `contact` has begun its episode. Of the fourth order in `steps` of each half: errors
/// of the rebound below 3e-8 at 64 and 1e-9 at 512 for e >= 0.3, tenfold and more for stronger
/// damping. The loop only on request; peak and depth are the largest of its points.
///
/// An independent method beside simulate(), for laws of every form; what a rigid bar does. Throws
/// std::runtime_error where the law has no finite force on the way.
FreeImpact free_impact(const ContactForce& contact, double mass, double speed, int steps = 512,
                       bool loop = false);

}  // namespace impactrig::models
