// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "models/beams/bending_modes.hpp"
#include "tests/models/scenes.hpp"

// Timoshenko's bar: closed forms.
namespace impactrig::tests {

/// The paper's bar with another radius, round, by Timoshenko's theory.
inline models::Rig shearing(double radius) {
  models::Rig rig = paper_rig();
  rig.beam.area = std::numbers::pi * radius * radius;
  rig.beam.second_moment = std::numbers::pi * std::pow(radius, 4) / 4.0;
  rig.beam.theory = models::BeamTheory::timoshenko;
  rig.beam.shear_coefficient = 6.0 * 1.3 / (7.0 + 6.0 * 0.3);
  return rig;
}

struct Constants {
  explicit Constants(const models::Beam& beam)
      : bending(beam.youngs_modulus * beam.second_moment),
        shear(beam.shear_coefficient * beam.youngs_modulus / 2.6 * beam.area),
        line(beam.density * beam.area),
        rotary(beam.density * beam.second_moment) {}

  double bending, shear, line, rotary;  ///< EI, κGA, ρA, ρI
};

/// Pinned at the hinge, free at the tip: w = A sinh αx + C sin βx, below the cut-off frequency.
/// What is left of bending moment and shear force at the tip.
inline double free_end(const models::Beam& beam, double omega) {
  const Constants c(beam);
  const double square = omega * omega;
  const double s = c.line * square / c.shear;
  const double half = 0.5 * (c.rotary * square / c.bending + s);
  const double load = c.line * square / c.bending * (1.0 - c.rotary * square / c.shear);
  const double root = std::sqrt(half * half + load);
  const double alpha = std::sqrt(root - half), beta = std::sqrt(root + half);
  return alpha * (alpha * alpha + s) * std::tanh(alpha * beam.length) *
             std::cos(beta * beam.length) -
         beta * (beta * beta - s) * std::sin(beta * beam.length);
}

/// The lowest roots, by steps and bisection.
inline std::vector<double> pinned_free_frequencies(const models::Beam& beam, std::size_t count) {
  const Constants c(beam);
  const double cut_off = std::sqrt(c.shear / c.rotary);
  std::vector<double> roots;
  const double step =
      models::BendingMode(beam, models::Basis::pinned_free, 1).angular_frequency() / 50.0;
  for (double low = step; low + step < cut_off && roots.size() < count; low += step) {
    if (free_end(beam, low) * free_end(beam, low + step) > 0.0) continue;
    double a = low, b = low + step;
    for (int i = 0; i < 100; ++i) {
      const double middle = 0.5 * (a + b);
      (free_end(beam, a) * free_end(beam, middle) > 0.0 ? a : b) = middle;
    }
    roots.push_back(a);
  }
  return roots;
}

}  // namespace impactrig::tests
