// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fitting/fit.hpp"
#include "fitting/fit_end.hpp"
#include "fitting/fit_problem.hpp"

namespace impactrig::fitting {

/// Intervals of other kinds than the covariance's: profile likelihoods of what is at a bound, and
/// those and a bootstrap where the options ask for them. Everything else is already in.
void add_further_intervals(FitProblem& problem, const FitEnd& end, const FitOptions& options,
                           bool out_of_time, Fit& fit);

}  // namespace impactrig::fitting
