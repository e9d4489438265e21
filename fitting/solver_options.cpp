// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/solver_options.hpp"

#include <glog/logging.h>

namespace impactrig::fitting {
namespace {

constexpr int most_iterations = 60;
constexpr int most_invalid_steps = 20;  // beyond bounds, or where a simulation fails

}  // namespace

ceres::Solver::Options solver_options(const Search& search) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = most_iterations;
  options.max_num_consecutive_invalid_steps = most_invalid_steps;
  options.function_tolerance = search.tolerance;
  options.initial_trust_region_radius = search.trust_radius;
  options.parameter_tolerance = 1e-8;
  options.gradient_tolerance = 1e-14;
  options.logging_type = ceres::SILENT;
  return options;
}

void silence_solver() {
  FLAGS_minloglevel = google::GLOG_FATAL;
}

}  // namespace impactrig::fitting
