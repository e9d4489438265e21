// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

namespace impactrig::fitting {

/// What a pulse is told by in four numbers. `unit` is that of the history.
struct HistoryScalars {
  double peak = 0.0;       ///< the sample of largest magnitude, with its sign [unit]; the first
  double peak_time = 0.0;  ///< its time [s], to half a sample interval
  double impulse = 0.0;    ///< Σ x Δt [unit s]
  /// How long |x| stays above 5 % of the peak around it, ends by straight lines [s]; NaN where it
  /// has not come down to that within the window, or the history is zero.
  double duration = 0.0;
};

/// Of samples at start + i interval [s], interval > 0. Throws std::invalid_argument without
/// samples.
HistoryScalars history_scalars(std::span<const double> x, double start, double interval);

}  // namespace impactrig::fitting
