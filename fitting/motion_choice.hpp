// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
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
/// in small motion with these predictions: at most, or by those of a coarse mesh where that is
/// clear. None where only the mesh's own can tell.
std::optional<double> estimated_shift(const FitProblem& problem, const FitEnd& end,
                                      const std::vector<models::Simulation>& predictions);

/// The same by the mesh's own, which are solved once a shot at the present values. Where that is
/// not harmless, what they show beyond small motion is added to the predictions from then on if it
/// can be: no simulation of a search has to be one of them then.
struct LearnedShift {
  double shift;
  bool learned;  ///< whether it can be added
};

LearnedShift shift_by_learning(FitProblem& problem, const FitEnd& end);

/// Nothing is added any more.
void forget_full_motion(FitProblem& problem);

}  // namespace impactrig::fitting
