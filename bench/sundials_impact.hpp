// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "models/rig.hpp"

namespace impactrig::bench {

enum class SundialsMethod {
  adams,  ///< CVODE, Adams to order 12, fixed-point iteration
  bdf,    ///< CVODE, BDF, Newton with a difference-quotient Jacobian, dense or (ANCF) banded
  erk     ///< ARKODE, explicit Runge-Kutta
};

struct SundialsSettings {
  SundialsMethod method = SundialsMethod::adams;
  double tolerance = 1e-6;  ///< relative
  /// Absolute tolerance: this times `tolerance` times what the impact's energy gives a coordinate.
  double absolute = 1.0;
  int most_order = 0;        ///< 0: the method's own
  std::string table{};       ///< of ARKODE, by its name
  int band_nodes = 3;        ///< BDF on ANCF: neighbours kept in the Jacobian; 0: dense
  double time_limit = 30.0;  ///< [s]
};

struct SundialsRun {
  double peak_force = 0.0;     ///< over the run [N]
  double first_end = 0.0;      ///< of the first contact [s]
  double first_impulse = 0.0;  ///< [N s]
  long contacts = 0;
  long steps = 0;
  long evaluations = 0;  ///< of the right-hand side, for whatever purpose
  std::string failure;   ///< "" when it came to the end
};

/// The same equations as models::simulate() with exact = true (bar, contact force, impulse and
/// dissipated energy), carried over `solver.duration` from first touch by SUNDIALS, with its own
/// step sizes and root finding; a damping coefficient for each contact as models::simulate() has
/// it.
SundialsRun run_sundials(const models::Rig& rig, const models::Solver& solver,
                         const SundialsSettings& settings);

}  // namespace impactrig::bench
