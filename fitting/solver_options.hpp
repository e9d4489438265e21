// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/solver.h>

namespace impactrig::fitting {

/// How far a pass of the search goes.
enum class SolverPass {
  rough,  ///< a start for the next pass is enough
  final   ///< to a hundredth of a standard error; begins near the minimum
};

/// Ceres' options of every fit: Levenberg-Marquardt with dense QR, so that the normal equations,
/// which square the condition number, are never formed. Silent.
ceres::Solver::Options solver_options(SolverPass pass);

}  // namespace impactrig::fitting
