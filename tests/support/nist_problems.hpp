// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/solver.h>

#include <string>
#include <vector>

namespace impactrig::tests {

/// A nonlinear regression of NIST's Statistical Reference Datasets.
struct NistProblem {
  std::string name;
  std::string model;  ///< as printed there
  std::vector<std::vector<double>> starts;
  std::vector<double> certified;            ///< parameters; empty where not at hand
  std::vector<double> standard_deviations;  ///< certified; likewise
  std::vector<std::vector<double>> data;    ///< y, x or y, x1, x2
};

/// All 27, from tests/support/nist.json.
std::vector<NistProblem> nist_problems();

/// What a search found.
struct NistSolution {
  std::vector<double> parameters;
  std::vector<double> standard_deviations;  ///< √(s² diag (J'J)⁻¹) by fitting::uncertainty()
  double sum_of_squares = 0.0;
  int iterations = 0;
  bool converged = false;
};

/// Runs Ceres with automatic derivatives once for each of the options, each from where the last
/// ended; parameters are divided by their starting values, as in a fit.
NistSolution solve_nist(const NistProblem& problem, std::size_t start,
                        const std::vector<ceres::Solver::Options>& passes);

/// How a problem is solved.
enum class NistOptions {
  fit,    ///< the passes of a fit as they are
  tight,  ///< the same with tolerances at rounding and iterations enough
  single  ///< the last of these alone, from Ceres' own trust region, not one that trusts the start
};

std::vector<ceres::Solver::Options> nist_options(NistOptions which);

/// What gets there from a start: `tight`, but for two of the 54 (MGH10 and BoxBOD from start 1).
/// The first pass of a fit leaves them on a plain, where its second, which trusts its start, finds
/// no way down.
std::vector<ceres::Solver::Options> options_that_solve(const NistProblem& problem,
                                                       std::size_t start);

/// Gauss-Newton in long double from a solution: parameters and standard deviations to some 17
/// digits.
NistSolution polish_nist(const NistProblem& problem, const std::vector<double>& from);

/// The largest difference in units of the standard deviation.
double off_by_deviations(const std::vector<double>& found, const NistSolution& best);

/// −log₁₀ of the largest relative error, at most 11, as the certified values have 11 digits.
double agreeing_digits(const std::vector<double>& found, const std::vector<double>& expected);

}  // namespace impactrig::tests
