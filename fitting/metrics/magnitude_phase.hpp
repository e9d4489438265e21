// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fitting/metrics/history_pair.hpp"

namespace impactrig::fitting {

/// An error told as one of magnitude, one of phase, and both together [-]. 0: none.
struct MagnitudePhase {
  double magnitude = 0.0;      ///< M, > 0 where the computed history is the larger
  double phase = 0.0;          ///< P, ≥ 0
  double comprehensive = 0.0;  ///< C, ≥ 0
};

/// Sprague and Geers:
///
///   M = √(Σc² / Σm²) − 1,   P = arccos(ρ) / π,   C = √(M² + P²),   ρ = Σmc / √(Σm² Σc²)
///
/// P lies in [0, 1]: 0 in phase, ½ a quarter of a period off, 1 with the sign reversed. M does not
/// change where a quiet tail is added, nor does P. No mean is removed: a common offset makes P look
/// better, so baselines belong at zero first. A c of zeros has M = −1 and, being orthogonal to
/// everything, P = ½; for an m of zeros all is NaN.
///
/// The angle is 2 atan2(|a − b|, |a + b|) with the histories a and b scaled to length 1, which is
/// arccos(ρ) without its error of √ε near 0 and π.
///
/// Source: [SpragueGeers2004].
MagnitudePhase sprague_geers(const HistoryPair& pair);

/// Geers: M as above, P = 1 − ρ in [0, 2], C = √(M² + P²). Source: [Geers1984].
MagnitudePhase geers_1984(const HistoryPair& pair);

/// Russell: the magnitude by orders of ten, the same for "twice" and "half",
///
///   q = (Σc² − Σm²) / √(Σm² Σc²),   M = sign(q) log₁₀(1 + |q|),
///   P = arccos(ρ) / π,   C = √(π (M² + P²) / 4)
///
/// M and C are NaN where c is zero throughout. Source: [Russell1997].
MagnitudePhase russell(const HistoryPair& pair);

/// Knowles and Gear: shape and arrival apart.
struct KnowlesGear {
  double magnitude = 0.0;         ///< M [-]
  double phase = 0.0;             ///< P [-], relative error of the time of arrival
  double comprehensive = 0.0;     ///< C [-]
  double arrival_measured = 0.0;  ///< TOA_m [s], from the first sample
  double arrival_computed = 0.0;  ///< TOA_c [s], from the first sample
};

/// Knowles and Gear: with c̃ the computed history moved so that both arrive together (straight lines
/// between samples; instants it does not reach are left out),
///
///   M = √(Σ Q (c̃ − m)² / Σ Q m²),   Q_i = |m_i| / max|m| (t_i − t_{i−1}),
///   P = |TOA_c − TOA_m| / TOA_m,     C = √((10 M² + 2 P²) / 12)
///
/// The time of arrival (TOA) is where |x| first reaches 5 % of its largest value, by straight
/// lines, counted from the first sample: P depends on where the window begins, and P and C are NaN
/// where the measured history has arrived at its first sample. Everything is NaN where one is zero
/// throughout. `interval` is the sample interval [s], > 0.
///
/// Source: [KnowlesGear2004] as quoted by [Schwer2007]; weights and threshold are quoted, not
/// checked against published numbers.
KnowlesGear knowles_gear(const HistoryPair& pair, double interval);

}  // namespace impactrig::fitting
