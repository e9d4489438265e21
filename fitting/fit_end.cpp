// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/fit_end.hpp"

#include <cmath>
#include <exception>
#include <string>
#include <vector>

namespace impactrig::fitting {
namespace {

// What moves the residuals by less, taken together and in standard deviations, from one bound of a
// parameter to the other is what simulations round differently: its standard error would be a
// thousand times as wide as its bounds.
constexpr double least_influence = 1e-3;

/// Whether a parameter does nothing to the residuals: by its slope, and, since that may vanish at
/// one place (a restitution of 0 acts by its square), half-way to its farther bound.
bool is_idle(FitProblem& problem, const Eigen::VectorXd& residuals, std::size_t number,
             double slope) {
  const Variable& v = problem.variables()[number];
  if (!(slope * (v.upper - v.lower) < least_influence)) return false;
  const std::vector<double> here = problem.values();
  std::vector<double> there = here;
  there[number] = 0.5 * (v.value + (v.upper - v.value > v.value - v.lower ? v.upper : v.lower));
  Eigen::VectorXd moved;
  try {
    problem.set_values(there);
    problem.linearise(moved, nullptr);
  } catch (const std::exception&) {
    moved.resize(0);  // that is an effect
  }
  problem.set_values(here);
  return moved.size() == residuals.size() && (moved - residuals).norm() < least_influence;
}

}  // namespace

FitEnd linearised_end(FitProblem& problem) {
  FitEnd end;
  problem.linearise(end.residuals, &end.jacobian);
  std::vector<std::string> names;
  std::vector<bool> held;
  for (const std::size_t i : problem.unknowns()) {
    const Variable& v = problem.variables()[i];
    const auto column = static_cast<Eigen::Index>(names.size());
    if (is_idle(problem, end.residuals, i, end.jacobian.col(column).norm()))
      end.jacobian.col(column).setZero();
    names.push_back(v.name);
    held.push_back(v.prior || v.role == Variable::Role::touch);
  }
  end.spread =
      uncertainty(end.jacobian, end.residuals, problem.loss(), problem.data_size(), names, held);
  return end;
}

Eigen::VectorXd changes_by(const std::function<Eigen::VectorXd(const Shot&)>& change,
                           const FitProblem& problem, const FitEnd& end) {
  Eigen::VectorXd changes = Eigen::VectorXd::Zero(end.jacobian.rows());
  Eigen::Index row = 0;
  for (const Shot& shot : problem.shots()) {
    const Eigen::VectorXd part = change(shot);
    changes.segment(row, part.size()) = part;
    row += part.size();
  }
  return changes;
}

Eigen::VectorXd shift_by(const Eigen::VectorXd& changes, const FitEnd& end) {
  return -end.spread.covariance * (end.jacobian.transpose() * changes);
}

Eigen::VectorXd shift_by(const std::function<Eigen::VectorXd(const Shot&)>& change,
                         const FitProblem& problem, const FitEnd& end) {
  return shift_by(changes_by(change, problem, end), end);
}

}  // namespace impactrig::fitting
