// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/solver_options.hpp"

namespace impactrig::fitting {
namespace {

// Ceres stops when a step changes the cost by less than this part: in the first pass a start for
// the second is enough; at the end this leaves less than a hundredth of a standard error in 25 of
// NIST's 27 regressions (the other two end at the limit of iterations and say so).
constexpr double rough_tolerance = 1e-3;
constexpr double final_tolerance = 2e-7;
// Ceres' trust region where the start is good: hardly any damping, which would make the solver
// creep along the directions that offset, drift and hum nearly share.
constexpr double near_minimum = 1e8;

}  // namespace

ceres::Solver::Options solver_options(SolverPass pass) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 60;
  options.function_tolerance = pass == SolverPass::final ? final_tolerance : rough_tolerance;
  if (pass == SolverPass::final) options.initial_trust_region_radius = near_minimum;
  options.parameter_tolerance = 1e-8;
  options.gradient_tolerance = 1e-14;
  options.logging_type = ceres::SILENT;
  return options;
}

}  // namespace impactrig::fitting
