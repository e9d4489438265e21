// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "tests/support/nist_problems.hpp"

namespace impactrig::tests {
namespace {

// All 27 problems from both starts, by the fit's own solver (its options with tolerances at
// rounding; two exceptions: options_that_solve). Certified values where they are at hand, else a
// solution in long double.
TEST(Nist, IsSolvedFromBothStartsToSixDigits) {
  const std::vector<NistProblem> problems = nist_problems();
  ASSERT_EQ(problems.size(), 27u);
  for (const NistProblem& problem : problems)
    for (std::size_t start : {0U, 1U}) {
      const NistSolution found = solve_nist(problem, start, options_that_solve(problem, start));
      const NistSolution best = polish_nist(problem, found.parameters);
      EXPECT_TRUE(found.converged) << problem.name << " from start " << start + 1;
      const auto& expected = problem.certified.empty() ? best.parameters : problem.certified;
      EXPECT_GE(agreeing_digits(found.parameters, expected), 6.0)
          << problem.name << " from start " << start + 1;
    }
}

// Standard deviations by fitting::uncertainty(), to five digits. Lanczos1's data have no noise but
// that of their 13 digits, so that a residual sum of squares in double has three: there only their
// ratios can be compared.
TEST(Nist, HasTheCertifiedStandardDeviations) {
  for (const NistProblem& problem : nist_problems()) {
    const NistSolution found = solve_nist(problem, 1, options_that_solve(problem, 1));
    const NistSolution best = polish_nist(problem, found.parameters);
    std::vector<double> expected = problem.standard_deviations.empty()
                                       ? best.standard_deviations
                                       : problem.standard_deviations;
    std::vector<double> deviations = found.standard_deviations;
    if (problem.name == "Lanczos1")
      for (std::size_t i = expected.size(); i-- > 0;) {
        expected[i] /= expected[0];
        deviations[i] /= deviations[0];
      }
    EXPECT_GE(agreeing_digits(deviations, expected), 5.0) << problem.name;
  }
}

// What the others are compared with: the solution in long double has the certified digits where
// there are any, parameters and deviations (11 digits are printed, the last is rounded).
TEST(Nist, IsSolvedInLongDoubleToTheCertifiedDigits) {
  int certified = 0;
  for (const NistProblem& problem : nist_problems()) {
    if (problem.certified.empty()) continue;
    ++certified;
    const NistSolution best =
        polish_nist(problem, solve_nist(problem, 1, options_that_solve(problem, 1)).parameters);
    EXPECT_TRUE(best.converged) << problem.name;
    EXPECT_GE(agreeing_digits(best.parameters, problem.certified), 9.5) << problem.name;
    if (problem.standard_deviations.empty()) continue;
    EXPECT_GE(agreeing_digits(best.standard_deviations, problem.standard_deviations), 9.5)
        << problem.name;
  }
  EXPECT_EQ(certified, 19);
}

// A fit stops earlier: where it says it has converged, from the start that is near, it is within a
// hundredth of a standard deviation, which no interval shows.
TEST(Nist, EndsAFitWithinAHundredthOfAStandardDeviation) {
  int converged = 0;
  for (const NistProblem& problem : nist_problems()) {
    const NistSolution found = solve_nist(problem, 1, nist_options(NistOptions::fit));
    if (!found.converged) continue;
    ++converged;
    if (problem.name == "Lanczos1") continue;  // no noise: its deviations are of the 13th digit
    const NistSolution best =
        polish_nist(problem, solve_nist(problem, 1, options_that_solve(problem, 1)).parameters);
    EXPECT_LT(off_by_deviations(found.parameters, best), 0.01) << problem.name;
  }
  EXPECT_GE(converged, 25);  // Bennett5 and MGH10 need more than the 60 iterations of a pass
}

}  // namespace
}  // namespace impactrig::tests
