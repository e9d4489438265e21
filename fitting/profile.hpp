// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fitting/fit_problem.hpp"

namespace impactrig::fitting {

/// What the data say of one parameter when all others follow as well as they can:
///
///   Δχ²(θ) = min over the others of χ² − χ² at the best fit,
///
/// data and priors. The 95 % interval is where it stays below 3.841; it needs no linearity. A side
/// on which it never gets there before the parameter's bound, or within 30 standard errors, has no
/// limit: the data do not bound the parameter there. Source: [RaueEtAl2009].
struct Profile {
  std::string name;
  std::string unit;                    ///< SI
  std::vector<double> value;           ///< ascending (n)
  std::vector<double> delta_chi2;      ///< over the square of the fit's inflation (n)
  std::optional<double> lower, upper;  ///< of the 95 % interval; none: open on that side
  bool found_better = false;           ///< a point fits better than the best fit: that is none
};

/// Of the unknowns with these numbers, on all cores. `problem` stands at the best fit; standard
/// errors [SI] are the first guess of the width (0: not known). Only for the loss of squares.
std::vector<Profile> profiles(const FitProblem& problem, const std::vector<std::size_t>& numbers,
                              const std::vector<double>& std_errors, double inflation);

}  // namespace impactrig::fitting
