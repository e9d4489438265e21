// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "fitting/fit.hpp"
#include "tests/fitting/synthetic_shot.hpp"

namespace impactrig::tests {

/// A fast rig for studies: four pinned-free modes.
inline fitting::RigFile hybrid_rig(const std::string& duration = "1.5 ms",
                                   std::vector<fitting::Override> more = {}) {
  more.insert(more.begin(), {{"solver.model", "hybrid"},
                             {"solver.basis", "pinned-free"},
                             {"solver.modes", "4"},
                             {"solver.duration", duration}});
  return fitting::parse_rig_file(paper_rig, "rig.toml", more);
}

inline const fitting::Parameter& parameter(const fitting::Fit& fit, const std::string& name) {
  for (const fitting::Parameter& p : fit.parameters)
    if (p.name == name) return p;
  throw std::out_of_range(name);
}

/// Distance from the truth in standard errors.
inline double pull(const fitting::Fit& fit, const std::string& name, double truth) {
  const fitting::Parameter& p = parameter(fit, name);
  return (p.value - truth) / p.std_error;
}

/// Pulls of repeated shots: standard normal where the standard errors are right.
struct Pulls {
  int count = 0;
  double sum = 0.0, squares = 0.0;

  void add(double pull) {
    ++count;
    sum += pull;
    squares += pull * pull;
  }

  double mean() const { return sum / count; }

  double mean_square() const { return squares / count; }

  /// What the mean leaves with probability 1e-4.
  double mean_bound() const { return 3.89 / std::sqrt(count); }

  /// What the mean square leaves with probability 1e-4, χ² over its degrees of freedom.
  std::array<double, 2> square_bounds() const {
    const boost::math::chi_squared_distribution<double> chi2(count);
    return {boost::math::quantile(chi2, 5e-5) / count,
            boost::math::quantile(boost::math::complement(chi2, 5e-5)) / count};
  }
};

}  // namespace impactrig::tests
