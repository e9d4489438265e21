// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/search_watch.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace impactrig::fitting {
namespace {

/// What follows steps of a cost of 1000 that have each promised and changed so much.
ceres::CallbackReturnType after(double promised, double change, bool successful, int steps = 1,
                                double tolerance = 1e-6) {
  const std::vector<Shot> shots;
  SearchWatch watch(tolerance, shots, [] { return false; });
  ceres::IterationSummary summary;
  summary.cost = 1000.0 - change;
  summary.cost_change = change;
  summary.relative_decrease = change / promised;
  summary.step_is_valid = true;
  summary.step_is_successful = successful;
  ceres::CallbackReturnType last = ceres::SOLVER_CONTINUE;
  for (summary.iteration = 1; summary.iteration <= steps; ++summary.iteration)
    last = watch(summary);
  return last;
}

// Near the end a step is as good as its linear model: what two on end lose by far is the
// simulation's rounding.
TEST(SearchWatch, EndsWhereStepsFailByRounding) {
  const auto ends = ceres::SOLVER_TERMINATE_SUCCESSFULLY, goes_on = ceres::SOLVER_CONTINUE;
  EXPECT_EQ(after(0.5, -1e-4, false), ends);      // changes less than the tolerance
  EXPECT_EQ(after(1e-4, -0.08, false), ends);     // promised less
  EXPECT_EQ(after(5e-3, -0.06, false), goes_on);  // promised little, and lost by far more
  EXPECT_EQ(after(5e-3, -0.06, false, 2), ends);
  EXPECT_EQ(after(5e-3, -7e-3, false, 2), goes_on);  // may curve
  EXPECT_EQ(after(0.5, -30.0, false, 2), goes_on);   // from afar
  EXPECT_EQ(after(5e-3, 4e-3, true, 2), goes_on);
  EXPECT_EQ(after(5.0, -30.0, false, 2, 1e-3), goes_on);  // by a rough search, from afar
  // what cannot be simulated has the largest cost there is, and a step there promises one
  EXPECT_EQ(after(1.0, -std::numeric_limits<double>::max(), false, 2, 1e-3), goes_on);
}

}  // namespace
}  // namespace impactrig::fitting
