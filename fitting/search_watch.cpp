// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/search_watch.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace impactrig::fitting {
namespace {

// Steps beyond bounds, one after the other, that a search may yet come back from.
constexpr int most_astray = 8;

}  // namespace

SearchWatch::SearchWatch(double tolerance, const std::vector<Shot>& shots,
                         std::function<bool()> strays)
    : tolerance_(tolerance),
      shots_(shots),
      strays_(std::move(strays)) {
  look_ahead(true);
}

SearchWatch::~SearchWatch() {
  look_ahead(false);
}

ceres::CallbackReturnType SearchWatch::operator()(const ceres::IterationSummary& summary) {
  if (summary.iteration > 0 && summary.step_is_valid && !summary.step_is_successful &&
      fails_by_rounding(summary))
    return ceres::SOLVER_TERMINATE_SUCCESSFULLY;
  if (summary.iteration > 0 && summary.step_is_successful) look_ahead(!is_last(summary));
  if (summary.step_is_successful) lost_ = 0;
  if (summary.step_is_successful) astray_ = strays_() ? astray_ + 1 : 0;
  if (astray_ == most_astray) return ceres::SOLVER_TERMINATE_SUCCESSFULLY;
  gradient_ = summary.gradient_norm;
  return ceres::SOLVER_CONTINUE;
}

/// Whether a step has failed for the rounding of the simulation: it has changed the cost by less
/// than the tolerance, or promised no more. Steps that promise little are as good as their linear
/// model, so that what two on end lose by far is rounding too.
bool SearchWatch::fails_by_rounding(const ceres::IterationSummary& summary) {
  constexpr double little = 10.0, near_end = 1e-5, by_far = 2.0, most = 10.0;
  constexpr int enough = 2;
  const double cost = summary.cost + summary.cost_change;         // before the step
  if (!(cost > 0.0) || summary.cost > most * cost) return false;  // or could not be simulated
  const double least = tolerance_ * cost;
  const double promised = summary.cost_change / summary.relative_decrease;
  const bool lost = promised <= std::min(little * least, near_end * cost) &&
                    -summary.cost_change > by_far * promised;
  lost_ = lost ? lost_ + 1 : 0;
  return std::abs(summary.cost_change) <= least || promised <= least || lost_ == enough;
}

/// Whether the next step probably changes the cost by less than the tolerance, after which nobody
/// asks for slopes: close to a minimum, a step gains as the square of the gradient.
bool SearchWatch::is_last(const ceres::IterationSummary& summary) const {
  const double part = summary.gradient_norm / gradient_;
  return summary.cost_change * part * part < tolerance_ * summary.cost;
}

void SearchWatch::look_ahead(bool ahead) {
  for (const Shot& shot : shots_) shot.cost->look_ahead(ahead);
}

}  // namespace impactrig::fitting
