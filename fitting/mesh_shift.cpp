// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/mesh_shift.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <functional>
#include <optional>
#include <stdexcept>
#include <utility>

namespace impactrig::fitting {
namespace {

/// Where an unknown cannot go as far, the others move as they do with it held there.
void keep_within_bounds(Eigen::VectorXd& shift, const FitProblem& problem,
                        const Uncertainty& spread) {
  Eigen::MatrixXd covariance = spread.covariance;
  for (std::size_t k = 0; k < problem.unknowns().size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    const Variable& v = problem.variables()[problem.unknowns()[k]];
    const double way = std::clamp(v.value + shift[row], v.lower, v.upper) - v.value - shift[row];
    if (way == 0.0 || !spread.identifiable[k] || !(covariance(row, row) > 0.0)) continue;
    const Eigen::VectorXd along = covariance.col(row) / covariance(row, row);
    shift += along * way;
    covariance -= along * covariance.row(row);  // from here on of the others, this one held
  }
}

// Errors of smooth forces fall tenfold from mesh to mesh, of one that begins at once by half. Where
// they do not fall, two meshes agree by chance or neither is fine enough to tell.
constexpr double least_beyond = 1.1, most_beyond = 3.0;

/// From what a mesh half as fine would change: errors are taken to fall on as they fell. Lengths
/// are of what the unknowns follow of the residuals' change.
double error_beyond(const FitProblem& problem, const FitEnd& end) {
  const models::Rig& rig = problem.rig().rig;
  const auto change_of = [&rig](const Shot& shot) -> Eigen::VectorXd {
    return shot.cost->change(*shot.model, *shot.model->halved(rig)).differences;
  };
  if (!problem.shots().front().model->halved(rig)) return least_beyond;
  const double finer = (end.jacobian * end.mesh_shift).norm();
  const double coarser = (end.jacobian * shift_by(change_of, problem, end)).norm();
  if (!(finer < coarser)) return finer > 0.0 ? most_beyond : least_beyond;
  return std::clamp(1.0 / (1.0 - finer / coarser), least_beyond, most_beyond);
}

/// Compares in small motion, which is faster and adds the same on both meshes as the fit's own
/// equations; by these where the rig has none. Returns why neither would do, empty where one did.
std::string compare_meshes(FitProblem& problem, const std::function<void()>& compare) {
  const models::Motion own = problem.motion();
  const auto failure_in = [&](models::Motion motion) -> std::string {
    try {
      problem.set_motion(motion);
      compare();
      return "";
    } catch (const std::exception& error) {
      return error.what();
    }
  };
  std::string failure = failure_in(models::Motion::small);
  if (!failure.empty() && own != models::Motion::small) failure = failure_in(own);
  problem.set_motion(own);
  return failure;
}

/// What a finer mesh changes of a shot. Where one cannot be solved: what one half as fine changes,
/// the other way and less by as much as that is less than what a quarter as fine does beyond.
ShotCost::Change change_by_mesh(const FitProblem& problem, const Shot& shot) {
  std::string failure;
  try {
    return shot.cost->change(*shot.model, shot.model->finer());
  } catch (const std::exception& error) {
    failure = error.what();
  }
  const models::Rig& rig = problem.rig().rig;
  const std::optional<ShotModel> half = shot.model->halved(rig);
  const std::optional<ShotModel> quarter = half ? half->halved(rig) : std::nullopt;
  if (!quarter) throw std::runtime_error(failure);
  ShotCost::Change change = shot.cost->change(*shot.model, *half);
  const double before = shot.cost->change(*half, *quarter).differences.norm();
  const double fall = std::min(1.0, change.differences.norm() / before);
  change.differences *= -fall;
  for (const auto which : {&models::Restitution::kinematic, &models::Restitution::kinetic,
                           &models::Restitution::energetic})
    change.restitution.*which *= -fall;
  return change;
}

// A fit follows more of a mesh's error than is told to first order.
constexpr double followed_beyond = 3.0;

/// What the unknowns do not follow of a mesh's error is in the residuals: beyond their noise, which
/// is known to a quarter of its power, there is room for so much of a change of which they leave
/// `left`. Room for all of it where their noise was not seen.
double room_for(double left, const FitProblem& problem, const FitEnd& end) {
  for (const Shot& shot : problem.shots())
    for (const FittedChannel& channel : shot.channels)
      if (!channel.noise_known) return 1.0;
  const auto count = static_cast<double>(end.residuals.size());
  const double room =
      followed_beyond * std::sqrt(std::max(end.residuals.squaredNorm(), misfit * count) - count);
  return left > room ? room / left : 1.0;
}

}  // namespace

double part_left_by_mesh(FitProblem& problem, const FitEnd& end) {
  double part = 0.0;
  compare_meshes(problem, [&] {
    Eigen::VectorXd changes = changes_by(
        [](const Shot& shot) -> Eigen::VectorXd {
          return shot.cost->change(*shot.model, shot.model->finer()).differences;
        },
        problem, end);
    changes += end.jacobian * shift_by(changes, end);
    part = changes.squaredNorm() / end.residuals.squaredNorm();
  });
  return part;
}

void estimate_mesh_shift(FitProblem& problem, FitEnd& end, std::vector<std::string>& warnings) {
  if (problem.rig().solver.model == models::BeamModel::rigid) return;
  const std::string failure = compare_meshes(problem, [&] {
    const auto change_of = [&](const Shot& shot) -> Eigen::VectorXd {
      ShotCost::Change change = change_by_mesh(problem, shot);
      if (&shot == &problem.shots().front()) end.mesh_change = change.restitution;
      return std::move(change.differences);
    };
    const Eigen::VectorXd changes = changes_by(change_of, problem, end);
    end.mesh_shift = shift_by(changes, end);
    end.beyond_finer = error_beyond(problem, end);
    const double left = (changes + end.jacobian * end.mesh_shift).norm();
    end.mesh_room = room_for(left, problem, end);
    end.mesh_misfit = left / end.residuals.norm();
    end.mesh_shift *= end.mesh_room;
    for (const auto which : {&models::Restitution::kinematic, &models::Restitution::kinetic,
                             &models::Restitution::energetic})
      end.mesh_change.*which *= end.mesh_room;
    keep_within_bounds(end.mesh_shift, problem, end.spread);
  });
  end.mesh_known = failure.empty();
  if (end.mesh_known) return;
  end.mesh_shift.resize(0);
  warnings.push_back(fmt::format(
      "The mesh error could not be estimated, so that no interval has it: {}", failure));
}

}  // namespace impactrig::fitting
