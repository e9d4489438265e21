// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/solver.h>

namespace impactrig::fitting {

/// How far a search goes.
struct Search {
  /// Ceres stops when a step changes the cost by less than this part.
  double tolerance = 2e-7;
  /// Ceres' first trust region; large: hardly any damping, which would make the solver creep along
  /// the directions that offset, drift and hum nearly share.
  double trust_radius = 1e8;
  bool hold_hum = false;  ///< leave mains hum as it is
  bool rough = false;     ///< by predictions just good enough to start another search from
  /// Weigh samples as if their noise were white. Noise that hangs together is known best by its
  /// steps, which weigh the steps of the signal: a touch or a delay that is off by more than these
  /// take has a false minimum at each period of what rings.
  bool one_by_one = false;
};

/// From afar: a start for the next search is enough.
inline constexpr Search first_search = {
    .tolerance = 1e-3, .trust_radius = 1e4, .hold_hum = true, .rough = true, .one_by_one = true};

/// From near the minimum, to the end: less than a hundredth of a standard error is left in 25 of
/// NIST's 27 regressions (the other two end at the limit of iterations and say so).
inline constexpr Search last_search = {};

/// Ceres' options of every search: Levenberg-Marquardt with dense QR, so that the normal equations,
/// which square the condition number, are never formed. Silent.
ceres::Solver::Options solver_options(const Search& search);

/// From now on nothing that Ceres logs of steps that fail reaches stderr: they are a search's own
/// business. For programs; of the whole process.
void silence_solver();

}  // namespace impactrig::fitting
