// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fitting/covariance.hpp"
#include "fitting/fit.hpp"
#include "fitting/fit_end.hpp"
#include "fitting/fit_problem.hpp"

namespace impactrig::fitting {

/// Degrees of freedom, information criteria, of what is determined; returns chi-square by degree of
/// freedom. chi2 is already in.
double report_goodness(const FitProblem& problem, const Uncertainty& spread, Goodness& goodness);

/// Values, intervals and correlations of all variables, those tied to others with them. goodness is
/// already in.
void report_parameters(const FitProblem& problem, const FitEnd& end, Fit& fit);

/// Measured and model of every fitted channel.
void report_channels(const FitProblem& problem, Fit& fit);

/// What a report shows besides: metrics and diagnostics of every channel, direct estimates of every
/// recording, on all cores. Impacts, channels and predictions are already in.
void report_more(const FitProblem& problem, Fit& fit);

/// The four restitutions of the first recording; rig and predictions are already in.
void report_restitution(const FitProblem& problem, const FitEnd& end, Fit& fit);

/// The rig and its sensors at the fitted values that all recordings share, or of the only one.
RigFile fitted_rig(const FitProblem& problem);

/// Warnings on residuals, mesh, bounds, flags; everything else is already in.
void report_warnings(const FitProblem& problem, const FitEnd& end, Fit& fit);

}  // namespace impactrig::fitting
