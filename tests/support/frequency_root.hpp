// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <stdexcept>

namespace impactrig::tests {

/// Root of a frequency equation between two values where it has different signs, by bisection.
template <typename Equation>
double frequency_root(const Equation& equation, double low, double high) {
  const bool rising = equation(high) > 0.0;
  if (rising == (equation(low) > 0.0)) throw std::logic_error("frequency_root: no change of sign");
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    ((equation(middle) > 0.0) == rising ? high : low) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace impactrig::tests
