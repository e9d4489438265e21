// SPDX-License-Identifier: BSD-3-Clause
#include "tests/models/reference/spherical_bessel.hpp"

#include <algorithm>
#include <cmath>

namespace impactrig::models {

void spherical_bessel(double z, std::span<double> j) {
  if (j.empty()) return;
  std::ranges::fill(j, 0.0);
  if (z < 1e-8) {  // the next terms of the series are below rounding
    j[0] = 1.0;
    if (j.size() > 1) j[1] = z / 3.0;
    return;
  }
  const int wanted = static_cast<int>(j.size());
  if (z > wanted + 10.0) {  // forward is stable up to n = z
    j[0] = std::sin(z) / z;
    if (wanted > 1) j[1] = (j[0] - std::cos(z)) / z;
    for (std::size_t n = 2; n < j.size(); ++n)
      j[n] = (2.0 * static_cast<double>(n) - 1.0) / z * j[n - 1] - j[n - 2];
    return;
  }
  // Where j_n has fallen below rounding: the recurrence starts there from nothing.
  const int start = std::max(wanted, static_cast<int>(z + 16.0 + 6.0 * std::cbrt(z))) + 4;
  double above = 0.0;
  double here = 1e-120;
  double squares = 0.0;
  double last = 0.0;  // j_1 on the way
  for (int n = start; n >= 0; --n) {
    squares += (2.0 * n + 1.0) * here * here;
    if (n < wanted) j[static_cast<std::size_t>(n)] = here;
    if (n == 1) last = here;
    if (n == 0) break;
    const double below = (2.0 * n + 1.0) / z * here - above;
    above = here;
    here = below;
    if (std::abs(here) > 1e100) {
      const double down = 1e-100;
      here *= down;
      above *= down;
      squares *= down * down;
      for (int m = n; m < wanted; ++m) j[static_cast<std::size_t>(m)] *= down;
      last *= down;
    }
  }
  // The sign from whichever of the first two is larger.
  const double sine = std::sin(z) / z;
  const double next = sine / z - std::cos(z) / z;
  const bool from_first = std::abs(sine) >= std::abs(next);
  const double sign = (from_first ? here * sine : last * next) < 0.0 ? -1.0 : 1.0;
  const double scale = sign / std::sqrt(squares);
  for (double& value : j) value *= scale;
}

}  // namespace impactrig::models
