// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "fitting/fit_end.hpp"
#include "fitting/fit_problem.hpp"

/// Which equations predict a fit. Small motion is faster by an order and leaves out what a noisy
/// recording seldom shows.
namespace impactrig::fitting {

/// Small motion serves to the end where the full equations would move no parameter by more than
/// this part of its standard error.
inline constexpr double harmless_shift = 0.1;

/// One choice for the whole fit: a change between two predictions would be taken for an effect of
/// the parameters.
void choose_motion(FitProblem& problem);

/// The full equations, with the slopes of small motion where it has them.
void prefer_full_motion(FitProblem& problem);

/// By how many standard errors the full equations would move a parameter of the impact, after a fit
/// in small motion with these predictions; above harmless_shift to first order, below it a limit
/// may be told instead.
double shift_by_full_motion(const FitProblem& problem, const FitEnd& end,
                            const std::vector<models::Simulation>& predictions);

}  // namespace impactrig::fitting
