// SPDX-License-Identifier: BSD-3-Clause
// Searches of FitProblem where bounds are in the way: an active set [NocedalWright2006, 16.5]
// around Levenberg-Marquardt. A bound that stops a search would pass for its end otherwise.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "fitting/fit_problem.hpp"

namespace impactrig::fitting {
namespace {

/// Cost and constraints about the present values, by the unknowns in units of their scales.
struct LinearCost {
  double value = 0.0;
  Eigen::VectorXd gradient;
  Eigen::MatrixXd curvature;        // JᵀJ
  Eigen::VectorXd lowest, highest;  // ways to the bounds
};

LinearCost linear_cost(const FitProblem& problem) {
  Eigen::VectorXd residuals;
  Eigen::MatrixXd jacobian;
  problem.linearise(residuals, &jacobian);
  for (Eigen::Index i = 0; i < problem.data_size(); ++i) {
    const LossResidual loss = loss_residual(problem.loss(), residuals[i]);
    residuals[i] = loss.value;
    jacobian.row(i) *= loss.slope;
  }
  const auto n = static_cast<Eigen::Index>(problem.unknowns().size());
  LinearCost cost;
  cost.lowest.resize(n);
  cost.highest.resize(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const Variable& v = problem.variables()[problem.unknowns()[static_cast<std::size_t>(k)]];
    jacobian.col(k) *= v.scale;
    cost.lowest[k] = (v.lower - v.value) / v.scale;
    cost.highest[k] = (v.upper - v.value) / v.scale;
  }
  cost.value = 0.5 * residuals.squaredNorm();
  cost.gradient = jacobian.transpose() * residuals;
  cost.curvature = jacobian.transpose() * jacobian;
  return cost;
}

/// To where the linear cost is least.
struct GaussNewtonStep {
  std::vector<Eigen::Index> moving;  ///< unknowns
  Eigen::VectorXd by;                ///< of each of them
  double gain = 0.0;                 ///< by how much the cost falls
};

/// Of the unknowns that `free` names, as far as the data tell them.
template <typename Free>
GaussNewtonStep gauss_newton_step(const LinearCost& cost, const Free& free) {
  GaussNewtonStep step;
  for (Eigen::Index k = 0; k < cost.gradient.size(); ++k)
    if (free(k) && cost.curvature(k, k) > 0.0) step.moving.push_back(k);
  if (step.moving.empty()) return step;
  const Eigen::VectorXd size = cost.curvature.diagonal()(step.moving).cwiseSqrt();
  const Eigen::MatrixXd curvature = size.cwiseInverse().asDiagonal() *
                                    cost.curvature(step.moving, step.moving) *
                                    size.cwiseInverse().asDiagonal();
  const Eigen::VectorXd downhill = -size.cwiseInverse().cwiseProduct(cost.gradient(step.moving));
  const Eigen::VectorXd scaled = curvature.ldlt().solve(downhill);
  step.by = scaled.cwiseQuotient(size);
  step.gain = 0.5 * scaled.dot(downhill);
  return step;
}

/// Which unknowns are held, and how often each was.
class ActiveSet {
 public:
  ActiveSet(const FitProblem& problem, const std::vector<std::size_t>& held)
      : held_(problem.unknowns().size(), false),
        times_(problem.unknowns().size(), 0) {
    for (std::size_t k = 0; k < held_.size(); ++k)
      fixed_.push_back(std::ranges::find(held, problem.unknowns()[k]) != held.end());
  }

  bool free(Eigen::Index k) const {
    return !fixed_[static_cast<std::size_t>(k)] && !held_[static_cast<std::size_t>(k)];
  }

  bool at_bound(Eigen::Index k) const { return held_[static_cast<std::size_t>(k)]; }

  /// Those at their bounds; true where there are some. `moved`: but for those that begin there.
  bool hold_reached(const FitProblem& problem, bool moved);

  /// Numbers of all that do not move.
  std::vector<std::size_t> numbers(const FitProblem& problem) const;

  void hold(Eigen::Index k) {
    held_[static_cast<std::size_t>(k)] = true;
    ++times_[static_cast<std::size_t>(k)];
  }

  /// The one whose release lowers the cost most, by more than `least`; -1: none. One that came back
  /// twice stays.
  Eigen::Index to_release(const LinearCost& cost, double least) const;

  void release(Eigen::Index k) { held_[static_cast<std::size_t>(k)] = false; }

  struct Bound {
    Eigen::Index of = -1;  ///< none
    bool lower = false;
  };

  /// The bound that first stops a free unknown on the way to the minimum, if that is lower by more
  /// than `least`.
  Bound to_hold(const LinearCost& cost, double least) const;

 private:
  std::vector<bool> fixed_, held_;
  std::vector<int> times_;
};

bool ActiveSet::hold_reached(const FitProblem& problem, bool moved) {
  bool some = false;
  for (std::size_t k = 0; k < held_.size(); ++k) {
    const Variable& v = problem.variables()[problem.unknowns()[k]];
    const bool reached = v.value == v.lower || v.value == v.upper;
    if (fixed_[k] || held_[k] || !reached || (moved && v.value == v.initial)) continue;
    hold(static_cast<Eigen::Index>(k));
    some = true;
  }
  return some;
}

std::vector<std::size_t> ActiveSet::numbers(const FitProblem& problem) const {
  std::vector<std::size_t> all;
  for (std::size_t k = 0; k < held_.size(); ++k)
    if (fixed_[k] || held_[k]) all.push_back(problem.unknowns()[k]);
  return all;
}

Eigen::Index ActiveSet::to_release(const LinearCost& cost, double least) const {
  Eigen::Index best = -1;
  for (Eigen::Index k = 0; k < cost.gradient.size(); ++k) {
    if (!at_bound(k) || times_[static_cast<std::size_t>(k)] > 2) continue;
    const bool low = -cost.lowest[k] < cost.highest[k];
    const bool inwards = low ? cost.gradient[k] < 0.0 : cost.gradient[k] > 0.0;
    const double gain = 0.5 * std::pow(cost.gradient[k], 2) / cost.curvature(k, k);
    if (!inwards || !(gain > least)) continue;
    least = gain;
    best = k;
  }
  return best;
}

ActiveSet::Bound ActiveSet::to_hold(const LinearCost& cost, double least) const {
  const GaussNewtonStep step = gauss_newton_step(cost, [&](Eigen::Index k) { return free(k); });
  if (!step.by.allFinite() || !(step.gain > least)) return {};
  Bound first;
  double part = 1.0;  // of the way
  for (std::size_t m = 0; m < step.moving.size(); ++m) {
    const Eigen::Index k = step.moving[m];
    const double way = step.by[static_cast<Eigen::Index>(m)];
    const double room = way < 0.0 ? cost.lowest[k] : cost.highest[k];
    if (way == 0.0 || !(room / way < part)) continue;
    part = room / way;
    first = {k, way < 0.0};
  }
  return first;
}

}  // namespace

double FitProblem::linear_end(const std::vector<std::size_t>& held) const {
  const LinearCost cost = linear_cost(*this);
  const ActiveSet active(*this, held);
  const GaussNewtonStep step =
      gauss_newton_step(cost, [&](Eigen::Index k) { return active.free(k); });
  return std::isfinite(step.gain) ? std::max(0.0, cost.value - step.gain) : 0.0;
}

SearchEnd FitProblem::search(const Search& how, const std::vector<std::size_t>& held) {
  std::vector<std::size_t> all = held;
  for (const std::size_t i : unknowns_) {
    const Variable& v = (*variables_)[i];
    if (how.hold_hum && v.role == Variable::Role::background && v.background.periodic())
      all.push_back(i);
  }
  ActiveSet active(*this, all);
  const bool held_some = active.hold_reached(*this, true);  // by a search before
  SearchEnd end = search_once(how, active.numbers(*this));
  if (!end.started) throw std::runtime_error("the fit could not start: " + end.message);
  if (!end.strayed && !held_some) return end;

  const auto most = 6 * unknowns_.size();
  for (std::size_t round = 0; round < most; ++round) {
    if (out_of_time()) break;
    const LinearCost cost = linear_cost(*this);
    const double least = how.tolerance * end.cost;
    const Eigen::Index release = active.to_release(cost, least);
    const ActiveSet::Bound hold = release >= 0 ? ActiveSet::Bound{} : active.to_hold(cost, least);
    // a search that was stopped beyond a bound is not at its end
    if (release < 0 && hold.of < 0 && !(end.strayed && active.hold_reached(*this, false)))
      return end;
    if (release >= 0) active.release(release);
    if (hold.of >= 0) {
      active.hold(hold.of);
      const std::size_t number = unknowns_[static_cast<std::size_t>(hold.of)];
      std::vector<double> there = values();
      there[number] = hold.lower ? (*variables_)[number].lower : (*variables_)[number].upper;
      set_values(there);
    }
    const int before = end.iterations;
    end = search_once(how, active.numbers(*this));
    end.iterations += before;
    if (!end.started) throw std::runtime_error("the fit could not start: " + end.message);
  }
  end.converged = false;
  end.message = "bounds that take turns";
  return end;
}

}  // namespace impactrig::fitting
