// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/motion_choice.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>

namespace impactrig::fitting {
namespace {

constexpr double no_limit = std::numeric_limits<double>::infinity();
// Small motion predicts the fit where it leaves out less than this part of the energy. Up to the
// third figure its slopes serve the full equations.
constexpr double smallest_motion = 1e-3;
constexpr double near_harmless = 0.3;
constexpr double like_small_motion = 0.1;

/// The largest of some shifts, of a parameter of the impact, in standard errors.
double largest(const Eigen::VectorXd& shift, const FitProblem& problem, const FitEnd& end) {
  double largest = 0.0;
  for (std::size_t k = 0; k < problem.unknowns().size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    const double variance = end.spread.covariance(row, row);
    if (problem.variables()[problem.unknowns()[k]].physics && variance > 0.0)
      largest = std::max(largest, std::abs(shift[row]) / std::sqrt(variance));
  }
  return largest;
}

/// An upper limit of the shift by full motion, from what small motion says of itself: of peak,
/// duration and impulse of the first contact it leaves out a part, which changes all that follows
/// as a change of the speed or of the contact by the same part would; histories between these three
/// may change by more. Residuals that change by a length move no parameter by more standard errors.
/// Infinite where none of these is free.
double most_shift_by_neglect(const FitProblem& problem, const FitEnd& end,
                             const std::vector<models::Simulation>& predictions) {
  constexpr double of_histories = 3.0;  // 1.3 seen
  double neglected = 0.0;
  for (const models::Simulation& prediction : predictions)
    neglected = std::max(neglected, prediction.neglected);
  double by_part = 0.0;  // length of the residuals' change by a relative change
  for (std::size_t k = 0; k < problem.unknowns().size(); ++k) {
    const Variable& v = problem.variables()[problem.unknowns()[k]];
    if (v.name == "contact.restitution" || v.name == "contact.stiffness_factor" ||
        v.name.starts_with("start.velocity"))
      by_part += end.jacobian.col(static_cast<Eigen::Index>(k)).norm() * std::abs(v.value);
  }
  if (by_part == 0.0) return no_limit;
  for (const Shot& shot : problem.shots()) by_part += shot.cost->signal_size();
  return of_histories * neglected * by_part;
}

/// By what both equations differ on a coarse mesh: that is a matter of the bar's large motion,
/// hardly of its high modes. Where it is anywhere near what matters, the mesh itself has to decide.
std::optional<double> screened_shift(const FitProblem& problem, const FitEnd& end) {
  const auto change = [&](const Shot& shot) -> Eigen::VectorXd {
    const ShotModel small = shot.model->coarser(problem.rig().rig);
    ShotModel full = small;
    full.set_motion(models::Motion::full);
    return shot.cost->change(small, full).differences;
  };
  const double shift = largest(shift_by(change, problem, end), problem, end);
  if (shift < near_harmless * harmless_shift) return shift;
  return std::nullopt;
}

}  // namespace

void choose_motion(FitProblem& problem) {
  double neglected = 0.0;
  const bool full_only = std::ranges::any_of(problem.variables(), [](const Variable& v) {
    return v.physics && v.physics->of_full_motion_only;
  });
  try {
    problem.set_motion(models::Motion::small);
    for (const Shot& shot : problem.shots())
      neglected = std::max(neglected, shot.model->simulate(problem.rig().rig, 0.0).neglected);
    if (neglected <= smallest_motion && !full_only) return;
  } catch (const std::exception&) {
    neglected = no_limit;  // the full equations have the last word on what is wrong with the rig
  }
  problem.set_motion(models::Motion::full);
  if (neglected <= like_small_motion && !full_only) prefer_full_motion(problem);
}

void prefer_full_motion(FitProblem& problem) {
  problem.set_motion(models::Motion::full);
  try {
    const std::vector<models::RigParameter> any = {
        [](models::Rig& rig) -> double& { return rig.start.velocity; }};
    for (const Shot& shot : problem.shots())
      if (shot.model->in_small_motion().simulate(problem.rig().rig, 0.0, any).sensitivities.empty())
        return;
    problem.take_small_slopes();
  } catch (const std::exception&) {
    return;  // this rig's are differences of simulations
  }
}

std::optional<double> estimated_shift(const FitProblem& problem, const FitEnd& end,
                                      const std::vector<models::Simulation>& predictions) {
  // each contact magnifies what the motion before it leaves out, by how much is the mesh's own
  const auto hits_again = [](const models::Simulation& prediction) {
    return prediction.episodes.size() > 1;
  };
  if (std::ranges::any_of(predictions, hits_again)) return std::nullopt;
  const double limit = most_shift_by_neglect(problem, end, predictions);
  if (limit > harmless_shift) return screened_shift(problem, end);
  return limit;
}

LearnedShift shift_by_learning(FitProblem& problem, const FitEnd& end) {
  std::vector<ShotModel> others;
  bool learned = true;
  for (const Shot& shot : problem.shots()) {
    others.push_back(*shot.model);
    if (others.back().learn_full_motion(shot.cost->rig(), shot.cost->chains())) continue;
    others.back().set_motion(models::Motion::full);
    learned = false;
  }
  problem.add_simulations(static_cast<long>(others.size()));
  const auto change = [&](const Shot& shot) -> Eigen::VectorXd {
    const auto number = static_cast<std::size_t>(&shot - problem.shots().data());
    return shot.cost->change(*shot.model, others[number]).differences;
  };
  const double shift = largest(shift_by(change, problem, end), problem, end);
  if (learned && shift > harmless_shift) problem.set_models(others);
  return {shift, learned};
}

void forget_full_motion(FitProblem& problem) {
  for (Shot& shot : problem.shots()) shot.model->forget_full_motion();
  problem.rebuild_costs();
}

}  // namespace impactrig::fitting
