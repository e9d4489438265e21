// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "fitting/metrics/history_pair.hpp"

namespace impactrig::fitting {

/// Scores of ISO/TS 18571 [-], each in [0, 1], 1 the best, and what they were made of.
struct Iso18571 {
  double corridor = 0.0;   ///< Z
  double phase = 0.0;      ///< E_P
  double magnitude = 0.0;  ///< E_M
  double slope = 0.0;      ///< E_S
  double rating = 0.0;     ///< R = 0.4 Z + 0.2 (E_P + E_M + E_S)

  /// n_ε [samples], > 0 where the computed history comes late.
  std::ptrdiff_t shift = 0;
  double correlation = 0.0;      ///< ρ at that shift
  double magnitude_error = 0.0;  ///< ε_mag
  double slope_error = 0.0;      ///< ε_slope
  std::size_t path_length = 0;   ///< pairs of samples along the warping path
};

/// ISO/TS 18571 with its default constants. N samples, of which M = N − |n_ε| overlap.
///
/// Corridor: with δ_i = 0.05 max|m| and δ_o = 0.5 max|m| a sample scores 1 where |c − m| < δ_i, 0
/// where |c − m| > δ_o and ((δ_o − |c − m|) / (δ_o − δ_i))² between; Z is the mean.
///
/// Phase: n_ε is the shift, up to ⌊0.2 N⌋ samples either way, of the largest Pearson correlation
/// over the overlap; 0 is tried first, then each n to the left (c late) before the right, and a
/// shift replaces another only where its correlation is larger by more than 10⁻¹² (a decaying
/// oscillation correlates with itself to 1 at each whole period, and rounding would choose among
/// them). A constant segment correlates to 1 with one equal to it, else to 0. E_P = 1 − |n_ε| /
/// (0.2 N), at least 0.
///
/// Magnitude: dynamic time warping of the shifted pair with cost (c_i − m_j)², steps of (1, 0), (0,
/// 1) and (1, 1) of equal weight, |i − j| < ⌈0.1 M⌉, equal costs going back by (i − 1, j), then (i,
/// j − 1), then both. Along the path ε_mag = Σ|c_i − m_j| / Σ|m_j|; E_M = max(0, (0.5 − ε_mag) /
/// 0.5).
///
/// Slope: central differences of the shifted pair, one-sided at its ends, then the moving average
/// over 9 samples (1, 3, 5, 7 towards the ends); ε_slope = Σ|ċ − ṁ| / Σ|ṁ|;
/// E_S = max(0, (2 − ε_slope) / 2).
///
/// Where m is zero (ε_mag) or constant (ε_slope) over the overlap the score is 1 where c is so too,
/// else 0; likewise Z where m is zero. The standard samples at 10 kHz: the moving average and the
/// warping band count samples, so that E_M and E_S of other rates compare with each other only
/// where the number of samples is about the same.
///
/// Takes O(N) memory and O(N²) time: 0.2 N² cells of warping, 0.4 N² products of correlation.
/// At least 2 samples. Source: [ISO18571].
Iso18571 iso18571(const HistoryPair& pair);

/// "excellent" above 0.94, "good" above 0.8, "fair" above 0.58, else "poor", of a rating R or of a
/// score, as the edition of 2014 grades [ISO18571].
std::string_view iso18571_grade(double rating);

}  // namespace impactrig::fitting
