// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>

#include "fitting/metrics/cora.hpp"
#include "fitting/metrics/history_pair.hpp"
#include "fitting/metrics/history_scalars.hpp"
#include "fitting/metrics/iso18571.hpp"
#include "fitting/metrics/magnitude_phase.hpp"
#include "fitting/metrics/residuals.hpp"

namespace impactrig::fitting {

/// Every measure of this folder that two histories alone can give. What is not defined is NaN.
struct Comparison {
  std::size_t samples = 0;
  MagnitudePhase sprague_geers, geers_1984, russell;
  KnowlesGear knowles_gear;
  double theil_u = 0.0, whang = 0.0, zilliacus = 0.0, rss_factor = 0.0;  ///< [-]
  double weighted_integrated_factor = 0.0;                               ///< [-]
  double correlation = 0.0, r_squared = 0.0;                             ///< [-]
  RootMeanSquareError error;
  ResidualAnalysis residuals;
  std::optional<Iso18571> iso18571;  ///< none above `most_rated` samples
  std::optional<Cora> cora;          ///< likewise
  HistoryScalars measured, computed;
};

/// Above so many samples ratings in O(N²) would take longer than anybody waits for a number.
constexpr std::size_t most_rated = 100'000;

/// Compares samples at start + i interval [s], interval > 0. Throws std::invalid_argument for
/// different lengths, fewer than two samples, what is not finite, or an m of zeros, to which
/// nothing can be relative.
Comparison compare_histories(const HistoryPair& pair, double start, double interval,
                             std::size_t rated = most_rated);

/// Σ c / Σ m; NaN where Σ m is zero but for rounding.
double impulse_ratio(const HistoryPair& pair);

/// What roadside practice accepts: |M|, P and C of Sprague and Geers up to 0.40, |r̄| up to 0.05 and
/// s up to 0.35. Source: [RayEtAl2011].
bool roadside_accepts(const MagnitudePhase& sprague_geers, const ResidualAnalysis& residuals);

}  // namespace impactrig::fitting
