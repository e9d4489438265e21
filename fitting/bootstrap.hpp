// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "fitting/bootstrap_kind.hpp"
#include "fitting/fit_problem.hpp"

namespace impactrig::fitting {

struct BootstrapOptions {
  BootstrapKind kind = BootstrapKind::parametric;
  int draws = 0;
  std::uint64_t seed = 1;
};

/// What refits of drawn data say of the variables.
struct Bootstrap {
  /// Draws that a 95 % interval takes at least: with fewer a further one lies beyond all of them in
  /// more than 5 %.
  static constexpr int fewest_for_interval = 39;

  struct Parameter {
    std::string name;
    double bias = 0.0;       ///< mean of the draws less the best fit [SI]
    double std_error = 0.0;  ///< standard deviation of the draws [SI]
    /// Basic: 2 · best fit − quantiles of the draws, within bounds; the quantiles themselves where
    /// draws pile up at a bound; 0 to 0 with too few draws.
    std::array<double, 2> ci95 = {0, 0};
    std::vector<double> draws = {};  ///< in their order [SI] (n_draws - failed)
  };

  BootstrapKind kind = BootstrapKind::parametric;
  std::uint64_t seed = 1;
  int draws = 0;   ///< asked for
  int failed = 0;  ///< of these, refits that did not converge; not in the figures
  std::vector<Parameter> parameters = {};  ///< of the physics and the sensors
  /// Parameters of which more than 2.5 % of the draws are at a bound; all intervals are quantiles
  /// then, as whatever goes with these is one-sided too.
  std::vector<std::string> at_bounds = {};
  double seconds = 0.0;
};

/// Refits `options.draws` sets of drawn data, on all cores; the same seed gives the same draws on
/// any number of them. `problem` stands at the best fit, where `jacobian` is that of
/// FitProblem::linearise(). Refits go by the best fit's Jacobian as long as that converges, to a
/// hundredth of a standard error.
Bootstrap bootstrap(const FitProblem& problem, const Eigen::MatrixXd& jacobian, double inflation,
                    const BootstrapOptions& options);

}  // namespace impactrig::fitting
