// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "fitting/metrics/history_pair.hpp"

namespace impactrig::fitting {

/// Scores of CORA [-], each in [0, 1], 1 the best.
struct Cora {
  double corridor = 0.0;           ///< corridor_score()
  double progression = 0.0;        ///< V
  double phase = 0.0;              ///< P
  double size = 0.0;               ///< G
  double cross_correlation = 0.0;  ///< V / 2 + P / 4 + G / 4
  double rating = 0.0;             ///< corridor / 2 + cross correlation / 2
  std::ptrdiff_t shift = 0;        ///< n [samples], > 0 where the computed history comes late
};

/// CORA over the whole window, with the default constants and no interval of its own: n is the
/// shift with the largest cross-correlation
///
///   K(n) = Σ m_i c_{i+n} / √(Σ m_i² Σ c_{i+n}²)
///
/// over what overlaps, at least 80 % of the N samples (order of search and ties as in iso18571());
///
///   V = ((K + 1) / 2)¹⁰,   P = 1 up to |n| = 0.01 N, 0 from 0.12 N, a straight line between,
///   G = min(F, 1 / F) with F = Σ c_{i+n}² / Σ m_i²
///
/// The exponents 10, 1, 1 are those of the default settings as quoted; no published pair of signals
/// with scores is at hand, so that only the closed forms are tested. NaN but for the corridor where
/// m is zero. O(N²) time. At least 2 samples. Source: [Thunert2017].
Cora cora(const HistoryPair& pair);

}  // namespace impactrig::fitting
