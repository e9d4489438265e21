// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace impactrig::models {

/// Gauss-Legendre rule on [0, 1].
struct GaussRule {
  std::vector<double> points;
  std::vector<double> weights;
};

/// n points, exact for polynomials of degree 2n − 1. n >= 1. Newton on the Legendre recurrence, to
/// rounding; each rule is worked out once.
const GaussRule& gauss_legendre(int n);

}  // namespace impactrig::models
