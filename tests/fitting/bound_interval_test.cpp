// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/bound_interval.hpp"

#include <gmock/gmock.h>

#include <cmath>

namespace impactrig::fitting {
namespace {

/// A parameter at its upper bound 1, where the data want it `beyond` standard errors of 1e-4 more;
/// its profile at `points` distances from there on.
Fit at_upper_bound(double beyond, int points) {
  const auto delta = [beyond](double u) { return u * u + 2.0 * beyond * u; };
  const double end = std::sqrt(beyond * beyond + 3.841) - beyond;
  Profile profile;
  profile.name = "contact.restitution";
  for (int k = points; k >= 0; --k) {
    const double u = 3.0 * static_cast<double>(k) / points;
    profile.value.push_back(1.0 - 1e-4 * u);
    profile.delta_chi2.push_back(delta(u));
  }
  profile.lower = 1.0 - 1e-4 * end;
  Fit fit;
  Parameter p;
  p.name = "contact.restitution";
  p.unit = "1";
  p.value = p.upper = 1.0;
  p.lower = 0.0;
  p.at_bound = true;
  fit.parameters = {p};
  fit.profiles = {profile};
  return fit;
}

// However few points the profile has: a straight line between them would see 1.74 for 1.55.
TEST(BoundInterval, HoldsUpTo1_6StandardErrorsBeyondTheBound) {
  for (const int points : {2, 3, 7, 40})
    for (const double beyond : {0.0, 0.5, 0.93, 1.5, 1.55, 1.7, 2.5}) {
      Fit fit = at_upper_bound(beyond, points);
      const double end = *fit.profiles[0].lower;
      settle_bounds(fit);
      ASSERT_EQ(fit.warnings.size(), 1U);
      const bool told = fit.warnings[0].find("means little") != std::string::npos;
      EXPECT_EQ(told, beyond > 1.6) << beyond << ", " << points;
      if (!told) {
        EXPECT_EQ(fit.parameters[0].ci95[0], end);
      }
    }
}

}  // namespace
}  // namespace impactrig::fitting
