// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "acquisition/conditioning/trace.hpp"
#include "datasets/conditioning.hpp"

namespace impactrig::acquisition {

/// How much later one record of an event shows it than another one of the same quantity.
struct ShiftEstimate {
  double value = 0.0;        ///< [s]
  double uncertainty = 0.0;  ///< standard uncertainty [s]
};

/// Estimates it within +-range by least squares of
///
///   y(t + shift) = a x(t) + b + c t,   a > 0,
///
/// over `window` (on the clock of the reference x), which should hold a pulse and rest on either
/// side of it. Both are read between samples (BandLimited), so that a pulse of five samples will
/// do, at steps of 1, 2, 4, ... of the coarser clock's, and of these where the estimate is surest:
/// wider ones leave noise out, narrower ones see sharp edges. Samples that are not valid do not
/// count.
///
/// The standard uncertainty is that of least squares with noise of both, white but for the
/// residuals' autocorrelation time: of noise of variance σ² in their difference, slopes x', y' and
/// S = a Σ x' y', to which noise adds nothing in the mean (two standard errors of it come off),
///
///   u² = σ²/S (1 + (Σ y'² − S) / 2 S)
///
/// In quadrature what a sharp edge between two samples leaves open, √(2 H/S): H is the square of
/// what both have near half of the sample rate, as much of which lies beyond it.
///
/// Throws std::invalid_argument when the best shift is at the edge of the range, what is left over
/// is more than half of what follows, or too few samples count.
ShiftEstimate estimate_shift(const Trace& reference, const Trace& signal,
                             const datasets::TimeSpan& window, double range);

/// Whether the samples on both sides of a place are there and valid.
bool sound_at(const Trace& trace, double index);

}  // namespace impactrig::acquisition
