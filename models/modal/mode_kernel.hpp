// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <span>

#include "models/lanes/mode_lanes.hpp"

namespace impactrig::models {

/// Moments of an exponential, μ = `exponent`, with shifted Legendre polynomials,
///
///   ∫₀¹ e^{μτ} P_n(2τ − 1) dτ = e^{z} i_n(z),   z = μ/2,
///
/// i_n the modified spherical Bessel function of the first kind, n = 0 ... moments.size() − 1. Real
/// part of μ not far above 0. Absolute error a few units of rounding.
/// Source: [DLMF2010], 10.47.7, 10.51.4 (recurrence) and 10.60.7 with iz for z.
void exponential_moments(std::complex<double> exponent, std::span<std::complex<double>> moments);

/// How a mode goes on after a blow: g with g̈ + d ġ + ω² g = 0, g(0) = 0, ġ(0) = 1, whether it
/// vibrates, creeps back or, with ω = 0, does not come back at all.
class ModeKernel {
 public:
  ModeKernel(double omega, double damping);  ///< ω [rad/s], d [1/s]

  struct Value {
    double answer, rate;  ///< g [s], ġ
  };

  Value at(double t) const;

  /// ∫₀¹ g(hτ) P_n(2τ − 1) dτ and the same of ġ, n up to the spans' common length.
  void moments(double h, std::span<double> answer, std::span<double> rate) const;

 private:
  void near_critical(double h, std::span<double> answer, std::span<double> rate) const;

  double omega_, half_damping_;
  double square_;  // of the frequency with damping, < 0 where the mode creeps [1/s²]
};

/// As advance_modes() and step_modes(), of modes with damping.
void advance_damped_modes(ModesUnderForce& modes);
void step_damped_modes(const ModesOverStep& modes);

}  // namespace impactrig::models
