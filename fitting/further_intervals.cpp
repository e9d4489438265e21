// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/further_intervals.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "fitting/bound_interval.hpp"

namespace impactrig::fitting {
namespace {

/// Whether a likelihood may tell an interval of what is at a bound: not where the model does not
/// explain the data at all, nor where they want more than two standard errors beyond. A standard
/// error wider than the bounds knows neither.
bool bound_tells(const FitProblem& problem, const FitEnd& end, std::size_t unknown) {
  constexpr double hopeless = 10.0;  // times what the noise leaves
  if (end.inflation > hopeless) return false;
  const auto k = static_cast<Eigen::Index>(unknown);
  const Variable& v = problem.variables()[problem.unknowns()[unknown]];
  const double error = std::sqrt(end.spread.covariance(k, k));
  if (!(end.inflation * error < v.upper - v.lower)) return true;
  return std::abs(end.jacobian.col(k).dot(end.residuals)) * error <= 2.0 * end.inflation;
}

/// Profile likelihoods of what is at a bound, of all else where the options ask for them.
void profile(FitProblem& problem, const FitEnd& end, const FitOptions& options, bool out_of_time,
             Fit& fit) {
  if (problem.loss() != Loss::squares) {
    if (options.profile)
      fit.warnings.push_back(fmt::format(
          "No profile likelihood was made: a likelihood goes with the loss squares, not with {}.",
          name(problem.loss())));
    return;
  }
  std::vector<std::size_t> numbers;
  std::vector<double> std_errors;
  for (std::size_t k = 0; k < problem.unknowns().size(); ++k) {
    const std::size_t i = problem.unknowns()[k];
    const Parameter& p = fit.parameters[i];
    const bool wanted =
        options.profile || (p.at_bound && !out_of_time && bound_tells(problem, end, k));
    if (!problem.variables()[i].of_interest() || !wanted) continue;
    numbers.push_back(i);
    std_errors.push_back(p.at_bound ? 0.0 : p.std_error);
  }
  fit.profiles = profiles(problem, numbers, std_errors, end.inflation);
  for (const Profile& profile : fit.profiles)
    if (profile.found_better)
      fit.warnings.push_back(
          fmt::format("The profile of {} found values that fit better: the fit ended in a false "
                      "minimum. Start from another {} or fix a parameter.",
                      profile.name, profile.name));
}

/// Along what the data do not determine, draws stay where their search began: that is no spread.
void forget_unknown(Fit& fit) {
  constexpr double not_known = std::numeric_limits<double>::quiet_NaN();
  for (const Parameter& of_fit : fit.parameters)
    for (Bootstrap::Parameter& p : fit.bootstrap->parameters) {
      if (p.name != of_fit.name || of_fit.identifiable) continue;
      p.bias = p.std_error = not_known;
      p.ci95 = {not_known, not_known};
    }
}

void add_bootstrap(FitProblem& problem, const FitEnd& end, const FitOptions& options, Fit& fit) {
  fit.bootstrap =
      bootstrap(problem, end.jacobian, end.inflation,
                {.kind = options.bootstrap_kind, .draws = options.bootstrap, .seed = options.seed});
  forget_unknown(fit);
  if (fit.bootstrap->draws < Bootstrap::fewest_for_interval)
    fit.warnings.push_back(
        fmt::format("{} draws of the bootstrap tell standard errors, no 95 % interval: that takes "
                    "{}, and some hundreds for one that is not a matter of chance.",
                    fit.bootstrap->draws, Bootstrap::fewest_for_interval));
  if (!fit.bootstrap->at_bounds.empty())
    fit.warnings.push_back(fmt::format(
        "Fits of the bootstrap end with {} at a bound: its intervals are quantiles of the draws "
        "and not mirrored about the best fit.",
        fmt::join(fit.bootstrap->at_bounds, ", ")));
  if (fit.bootstrap->failed > 0)
    fit.warnings.push_back(fmt::format("{} of {} fits of the bootstrap did not converge.",
                                       fit.bootstrap->failed, fit.bootstrap->draws));
}

}  // namespace

void add_further_intervals(FitProblem& problem, const FitEnd& end, const FitOptions& options,
                           bool out_of_time, Fit& fit) {
  profile(problem, end, options, out_of_time, fit);
  settle_bounds(fit);
  if (options.bootstrap > 0) add_bootstrap(problem, end, options, fit);
}

}  // namespace impactrig::fitting
