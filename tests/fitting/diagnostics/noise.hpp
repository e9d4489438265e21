// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

namespace impactrig::tests {

/// Gaussian noise of unit standard deviation with x_t = φ x_{t−1} + e_t.
inline std::vector<double> gaussian_noise(std::size_t count, std::uint64_t seed,
                                          double memory = 0.0) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  std::vector<double> out(count);
  double last = normal(generator);
  for (double& value : out) {
    last = memory * last + std::sqrt(1.0 - memory * memory) * normal(generator);
    value = last;
  }
  return out;
}

}  // namespace impactrig::tests
