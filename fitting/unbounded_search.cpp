// SPDX-License-Identifier: BSD-3-Clause
// Searches of FitProblem as if there were no bounds, by Ceres.
#include <ceres/problem.h>
#include <ceres/sized_cost_function.h>
#include <ceres/solver.h>

#include <algorithm>

#include "fitting/fit_problem.hpp"
#include "fitting/search_watch.hpp"

namespace impactrig::fitting {
namespace {

constexpr double edge = 1e-12;  // of a scale, beyond a bound by rounding

/// What is known of a variable beside the data: (value − mean) / uncertainty.
class PriorCost : public ceres::SizedCostFunction<1, 1> {
 public:
  explicit PriorCost(const Variable& variable) : variable_(variable) {}

  bool Evaluate(const double* const* parameters, double* residuals,
                double** jacobians) const override {
    const auto [mean, uncertainty] = *variable_.prior;
    const double value = variable_.value_at(parameters[0][0]);
    residuals[0] = (value - mean) / uncertainty;
    if (jacobians && jacobians[0]) jacobians[0][0] = variable_.slope_at(value) / uncertainty;
    return true;
  }

 private:
  const Variable& variable_;
};

SearchEnd end_of(const ceres::Solver::Summary& summary) {
  return {.started = !summary.iterations.empty(),
          .cost = summary.final_cost,
          .converged = summary.termination_type == ceres::CONVERGENCE ||
                       summary.termination_type == ceres::USER_SUCCESS,
          .iterations = summary.num_successful_steps,
          .message = summary.message};
}

}  // namespace

/// Blocks and priors of a Ceres problem, which does not own the priors.
FitProblem::Priors FitProblem::state(const std::vector<std::size_t>& held, std::vector<double>& x,
                                     ceres::Problem& problem) const {
  Priors priors;
  for (const Shot& shot : shots_) {
    std::vector<double*> blocks;
    for (const std::size_t i : shot.cost->blocks()) blocks.push_back(&x[i]);
    problem.AddResidualBlock(shot.cost.get(), nullptr, blocks);
  }
  for (const std::size_t i : held) problem.SetParameterBlockConstant(&x[i]);
  for (const std::size_t i : priors_) {
    priors.push_back(std::make_unique<PriorCost>((*variables_)[i]));
    problem.AddResidualBlock(priors.back().get(), nullptr, &x[i]);
  }
  return priors;
}

SearchEnd FitProblem::search_once(const Search& how, const std::vector<std::size_t>& held) {
  for (const Shot& shot : shots_) shot.cost->forget_failure();
  std::vector<double> x(variables_->size());
  for (std::size_t i = 0; i < x.size(); ++i)
    x[i] = (*variables_)[i].coordinate((*variables_)[i].value);
  ceres::Problem::Options ownership;
  ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(ownership);
  const Priors priors = state(held, x, problem);
  ceres::Solver::Options solver = solver_options(how);
  const auto strays = [&] {
    return std::ranges::any_of(unknowns_, [&](std::size_t i) {
      const Variable& v = (*variables_)[i];
      const double value = v.value_at(x[i]), rounding = edge * v.scale;
      return value < v.lower - rounding || value > v.upper + rounding;
    });
  };
  SearchWatch watch(how.tolerance, shots_, strays);
  solver.callbacks.push_back(&watch);
  solver.update_state_every_iteration = true;
  solver.max_solver_time_in_seconds =
      std::clamp(time_left(), 0.0, solver.max_solver_time_in_seconds);
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  SearchEnd end = end_of(summary);
  end.strayed = strays();
  std::vector<double> values(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) values[i] = (*variables_)[i].value_at(x[i]);
  for (const Shot& shot : shots_) {
    if (shot.cost->failure().empty()) continue;
    end.strayed = true;
    if (!end.started) end.message = shot.cost->failure();
  }
  set_values(values);
  return end;
}

}  // namespace impactrig::fitting
