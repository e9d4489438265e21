// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "datasets/sensor.hpp"

namespace impactrig::fitting {

/// How much of a sensor's chain is taken off a record.
enum class ChainUndo {
  none,      ///< nothing but its delay at 0 Hz
  resolved,  ///< sections that the sampling resolves; of the others the delay at 0 Hz
  all        ///< every section, however coarse the sampling
};

/// What acted on a sensor, from what its chain shows.
struct Undone {
  std::vector<double> values;  ///< (n), unit of the input
  double delay = 0.0;          ///< by which they are still late [s]
  bool complete = true;        ///< no section was left at its delay
};

/// The inverse of a sensor's linear chain (resonance, high cut, low cut; not the stated delay).
///
/// Low-pass sections have poles only, so that their inverse is a sum of derivatives:
///
///   x = y + a₁ ẏ + a₂ ÿ;   resonance: a₁ = 1/(Q ω), a₂ = 1/ω²;   first order: a₁ = 1/ω, a₂ = 0
///
/// y is what is shown, x what acted. Derivatives are those of parabolas through 2 m + 1 samples, m
/// the largest with m ω h <= 0.6 (at least 1; h the interval): 3 % of the section's own ringing
/// stays, and noise grows by about 3 √m/(m ω h)². A section with ω h > 0.8 (above an eighth of the
/// sample rate) is not resolved; it delays by a₁. A low cut is undone by adding a₁ ω times the
/// integral, from the first sample on, where the input was 0.
///
/// shown: (n); interval [s], > 0.
Undone undo_chain(const datasets::Sensor& sensor, std::span<const double> shown, double interval,
                  ChainUndo how);

}  // namespace impactrig::fitting
