// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/iteration_callback.h>

#include <functional>
#include <vector>

#include "fitting/fit_problem.hpp"

namespace impactrig::fitting {

/// Watches a search from step to step.
class SearchWatch : public ceres::IterationCallback {
 public:
  /// `strays`: whether the search has come beyond a bound.
  SearchWatch(double tolerance, const std::vector<Shot>& shots, std::function<bool()> strays);
  SearchWatch(const SearchWatch&) = delete;
  SearchWatch& operator=(const SearchWatch&) = delete;
  ~SearchWatch() override;

  /// Ceres looks at its function tolerance after steps that succeed only. Where one fails for the
  /// rounding of the simulation there is nothing more to gain.
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override;

 private:
  bool fails_by_rounding(const ceres::IterationSummary& summary);
  bool is_last(const ceres::IterationSummary& summary) const;
  void look_ahead(bool ahead);

  double tolerance_;
  const std::vector<Shot>& shots_;
  std::function<bool()> strays_;
  double gradient_ = 0.0;  // at the last step's beginning
  int astray_ = 0;
  int lost_ = 0;  // steps on end that lost by far more than they had promised
};

}  // namespace impactrig::fitting
