// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <complex>
#include <span>

#include "models/lanes/mode_lanes.hpp"

namespace impactrig::models {

/// Moments of an exponential, μ = `exponent`, with shifted Legendre polynomials,
///
///   ∫₀¹ e^{μτ} P_n(2τ − 1) dτ = e^{z} i_n(z),   z = μ/2,
///
/// i_n the modified spherical Bessel function of the first kind, n = 0 ... moments.size() − 1. Real
/// part of μ not far above 0; |μ| up to 700, or μ real, below 0 and of any size, if the number of
/// moments, squared, is at most 2 |μ|. Absolute error a few units of rounding.
/// Source: [DLMF2010], 10.47.7, 10.51.4 (recurrence) and 10.60.7 with iz for z.
void exponential_moments(std::complex<double> exponent, std::span<std::complex<double>> moments);
void exponential_moments(double exponent, std::span<double> moments);

/// How a mode goes on after a blow: g with g̈ + d ġ + ω² g = 0, g(0) = 0, ġ(0) = 1, whether it
/// vibrates, creeps back or, with ω = 0, does not come back at all.
class ModeKernel {
 public:
  ModeKernel(double omega, double damping);  ///< ω [rad/s], d [1/s]

  struct Value {
    double answer, rate;  ///< g [s], ġ
  };

  Value at(double t) const;

  /// ∫₀¹ g(hτ) P_n(2τ − 1) dτ and the same of ġ, n up to the spans' common length: any, but where
  /// the mode starts_early(), 16.
  void moments(double h, std::span<double> answer, std::span<double> rate) const;

  /// A mode that creeps back first picks up speed, as e^{−λt} with the larger of its two λ. Whether
  /// that is over so early in a time h that a series over h would need many terms for it: then
  /// early() tells of it and late_moments() of the rest of g.
  bool starts_early(double h) const;

  void late_moments(double h, std::span<double> answer, std::span<double> rate) const;

  struct Early {
    double exponent;      ///< λ [1/s]
    double answer, rate;  ///< what stands before e^{−λt} in g [s] and ġ
  };

  Early early() const { return {fast_, -0.5 / spread_, 0.5 * fast_ / spread_}; }

  /// |λ| of the fastest e^{λt} in g [1/s].
  double fastest_rate() const { return square_ < 0.0 ? std::abs(half_damping_) + spread_ : omega_; }

  /// The same, but for one that is fast enough to be early() in every
  /// step that is too long for its series.
  double lasting_rate() const;

  /// |λ| of the fastest e^{λt} in g of which a series over h has to know [1/s].
  double rate_in_series(double h) const;

 private:
  void near_critical(double h, std::span<double> answer, std::span<double> rate) const;
  bool is_split(double ratio) const;

  double omega_, half_damping_;
  double square_;  // of the frequency with damping, < 0 where the mode creeps [1/s²]
  double spread_;  // root of its size [1/s]
  double fast_ = 0.0, slow_ = 0.0;  // λ of a mode that creeps [1/s]
};

/// As advance_modes() and step_modes(), of modes with damping.
void advance_damped_modes(ModesUnderForce& modes);
void step_damped_modes(const ModesOverStep& modes);

}  // namespace impactrig::models
