// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <span>
#include <string>

namespace impactrig::fitting {

/// How far a computed history is from a measured one, sample by sample on the same grid (n);
/// rectangle sums.
///
///   nrmse                        √(Σ (c − m)² / n) / max |m|
///   correlation                  Pearson's; 0 when one of the two is constant
///   sprague_geers_magnitude      M = √(Σ c² / Σ m²) − 1
///   sprague_geers_phase          P = arccos(Σ m c / √(Σ m² Σ c²)) / π
///   sprague_geers_comprehensive  √(M² + P²)
///
/// Empty when there are no samples or m is zero throughout. Source: [SpragueGeers2004].
std::map<std::string, double> metrics(std::span<const double> measured,
                                      std::span<const double> computed);

}  // namespace impactrig::fitting
