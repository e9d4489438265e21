// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/search_watch.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace impactrig::fitting {
namespace {

/// What follows a step of a cost of 1000 by a tolerance of 1e-6 that has promised and changed so
/// much.
ceres::CallbackReturnType after(double promised, double change, bool successful,
                                double tolerance = 1e-6) {
  const std::vector<Shot> shots;
  SearchWatch watch(tolerance, shots, [] { return false; });
  ceres::IterationSummary summary;
  summary.iteration = 3;
  summary.cost = 1000.0 - change;
  summary.cost_change = change;
  summary.relative_decrease = change / promised;
  summary.step_is_valid = true;
  summary.step_is_successful = successful;
  return watch(summary);
}

// Near the end a step is as good as its linear model: what it loses by far is the simulation's
// rounding.
TEST(SearchWatch, EndsWhereAStepFailsByRounding) {
  const auto ends = ceres::SOLVER_TERMINATE_SUCCESSFULLY, goes_on = ceres::SOLVER_CONTINUE;
  EXPECT_EQ(after(0.5, -1e-4, false), ends);      // changes less than the tolerance
  EXPECT_EQ(after(1e-4, -0.08, false), ends);     // promised less
  EXPECT_EQ(after(5e-3, -0.06, false), ends);     // promised little, and lost by far more
  EXPECT_EQ(after(5e-3, -7e-3, false), goes_on);  // may curve
  EXPECT_EQ(after(0.5, -30.0, false), goes_on);   // from afar
  EXPECT_EQ(after(5e-3, 4e-3, true), goes_on);
  EXPECT_EQ(after(5.0, -30.0, false, 1e-3), goes_on);  // by a rough search, from afar
  // what cannot be simulated has the largest cost there is, and a step there promises one
  EXPECT_EQ(after(1.0, -std::numeric_limits<double>::max(), false, 1e-3), goes_on);
}

}  // namespace
}  // namespace impactrig::fitting
