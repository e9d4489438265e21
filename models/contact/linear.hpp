// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>

#include "models/contact/force_and_stiffness.hpp"

namespace impactrig::models {

/// A linear spring, f = k δ for δ > 0. Valid as far as the user says; the reference every other law
/// is compared with.
struct LinearContact {
  static constexpr const char* name = "linear";

  double spring = 0.0;  ///< k [N/m], > 0

  double limit_penetration() const { return std::numeric_limits<double>::infinity(); }

  double force(double penetration) const { return penetration > 0.0 ? spring * penetration : 0.0; }

  double energy(double penetration) const {
    return penetration > 0.0 ? 0.5 * spring * penetration * penetration : 0.0;
  }

  double stiffness(double penetration) const { return penetration > 0.0 ? spring : 0.0; }

  ForceAndStiffness force_and_stiffness(double penetration) const {
    return {force(penetration), stiffness(penetration)};
  }

  LinearContact scaled(double factor) const { return {spring * factor}; }
};

}  // namespace impactrig::models
