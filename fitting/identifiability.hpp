// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "fitting/fit_problem.hpp"

namespace impactrig::fitting {

/// A product of powers of the impact's parameters, ∏ p_i^x_i with Σ x_i² = 1, and how well the data
/// know it, whatever the measuring chain is.
struct Combination {
  /// Parameters and exponents, the largest first; below 0.1 they are left out.
  std::vector<std::pair<std::string, double>> exponents;
  double relative_error = 0.0;  ///< standard error of its logarithm; infinite: not determined
};

/// Elastic stiffness of the first contact at a force, which logarithmic contact laws leave as the
/// one thing that a single impact tells of their parameters.
struct ContactStiffness {
  double force = 0.0;           ///< [N]; 0 where there is none to tell
  double stiffness = 0.0;       ///< dF/dδ there [N/m]
  double relative_error = 0.0;  ///< standard error; infinite: not determined
};

/// What the data know of the parameters of the impact together.
struct Identifiability {
  std::vector<Combination> combinations;  ///< worst known first, as many as parameters
  ContactStiffness contact;
  std::string remedy;  ///< what to do where a combination is hardly known; else empty
};

/// From the Jacobian of FitProblem::linearise() at its present values: the columns of the physics,
/// less what the columns of the measuring chain can do, by the logarithms of the parameters; their
/// singular values are the inverse errors. `inflation` multiplies all errors, `peak_force` [N] is
/// where the contact's stiffness is told. Source: [RaueEtAl2009], [BelsleyEtAl1980].
Identifiability identifiability(const FitProblem& problem, const Eigen::MatrixXd& jacobian,
                                double inflation, double peak_force);

}  // namespace impactrig::fitting
