// SPDX-License-Identifier: BSD-3-Clause
// Digits that the fit's solver gets of NIST's nonlinear regressions, from both starts of all 27.
//
//   bench_nist [-o nist.json]
//
// First with a fit's own options, then with what gets there: tolerances at rounding, and one pass
// instead of two where the first leads astray. Digits: −log₁₀ of the largest
// relative error, at most 11; against certified values, else (marked *) against a solution in long
// double.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/nist_problems.hpp"

namespace {

using namespace impactrig::tests;

struct Line {
  const char* options;
  NistSolution found;
  double digits = 0.0, sd_digits = 0.0;
  double off = 0.0;  ///< standard deviations
};

Line measure(const NistProblem& problem, std::size_t start, bool as_fit) {
  const NistSolution best =
      polish_nist(problem, solve_nist(problem, 1, options_that_solve(problem, 1)).parameters);
  const auto passes = as_fit ? nist_options(NistOptions::fit) : options_that_solve(problem, start);
  Line line{.options = as_fit              ? "fit"
                       : passes.size() > 1 ? "tight"
                                           : "single",
            .found = solve_nist(problem, start, passes)};
  const bool known = !problem.certified.empty(), sd = !problem.standard_deviations.empty();
  line.digits = agreeing_digits(line.found.parameters, known ? problem.certified : best.parameters);
  line.sd_digits = agreeing_digits(line.found.standard_deviations,
                                   sd ? problem.standard_deviations : best.standard_deviations);
  line.off = off_by_deviations(line.found.parameters, best);
  return line;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Digits of NIST's nonlinear regressions");
  std::string output;
  app.add_option("-o,--output", output, "Write all numbers as JSON");
  CLI11_PARSE(app, argc, argv);
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  fmt::print("{:<10} {:>5} {:>7} {:>7} {:>7} {:>9} {:>11}\n", "problem", "start", "options",
             "digits", "of sd", "off [sd]", "iterations");
  for (const NistProblem& problem : nist_problems())
    for (std::size_t start : {0U, 1U})
      for (const bool as_fit : {true, false}) {
        const Line line = measure(problem, start, as_fit);
        fmt::print("{:<10} {:>5} {:>7} {:>6.1f}{} {:>6.1f}{} {:>9.1e} {:>11}{}\n", problem.name,
                   start + 1, line.options, line.digits, problem.certified.empty() ? '*' : ' ',
                   line.sd_digits, problem.standard_deviations.empty() ? '*' : ' ', line.off,
                   line.found.iterations, line.found.converged ? "" : "   not converged");
        all.push_back({{"problem", problem.name},
                       {"start", start + 1},
                       {"options", line.options},
                       {"digits", line.digits},
                       {"digits_of_sd", line.sd_digits},
                       {"off_in_sd", line.off},
                       {"iterations", line.found.iterations},
                       {"converged", line.found.converged}});
      }
  if (!output.empty()) std::ofstream(output) << all.dump(1) << '\n';
  return 0;
}
