// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>

#include "fitting/covariance.hpp"
#include "fitting/fit_problem.hpp"

namespace impactrig::fitting {

/// A reduced chi-square above this is no chance: the noise itself is known to a tenth from the few
/// hundred samples before a trigger.
inline constexpr double misfit = 1.25;

/// What is known of a problem's parameters where its search ended.
struct FitEnd {
  Eigen::VectorXd residuals;  ///< of data and priors
  Eigen::MatrixXd jacobian;   ///< of these by the unknowns; 0 where one does nothing to the data
  Uncertainty spread;         ///< of the unknowns, in their order
  double inflation = 1.0;     ///< of all standard errors, where the residuals exceed the noise
  /// Of the unknowns, as far as mesh_room goes; empty where there is none, or none known.
  Eigen::VectorXd mesh_shift;
  bool mesh_known = true;  ///< false: it could not be estimated
  /// What part of what a finer mesh changes the residuals have room for, 0 to 1.
  double mesh_room = 1.0;
  double mesh_misfit = 0.0;  ///< what it changes that no unknown follows, in residuals
  /// The error of the mesh against that shift, to a mesh twice as fine.
  double beyond_finer = 1.0;
  /// How much else a finer mesh changes the first recording's restitutions, parameters held; as far
  /// as mesh_room goes.
  models::Restitution mesh_change = {};
};

/// Linearises a problem at its present values, where its search ended.
FitEnd linearised_end(FitProblem& problem);

/// A change of each shot's weighted differences, of all residuals; none of priors.
Eigen::VectorXd changes_by(const std::function<Eigen::VectorXd(const Shot&)>& change,
                           const FitProblem& problem, const FitEnd& end);

/// By how much the unknowns would move, to first order, if the residuals changed by that.
Eigen::VectorXd shift_by(const Eigen::VectorXd& changes, const FitEnd& end);

/// By how much the unknowns would move, to first order, if the weighted differences of each shot
/// changed by change(shot).
Eigen::VectorXd shift_by(const std::function<Eigen::VectorXd(const Shot&)>& change,
                         const FitProblem& problem, const FitEnd& end);

}  // namespace impactrig::fitting
