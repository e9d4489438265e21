// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <span>
#include <string>

namespace impactrig::fitting {

/// How far a computed history is from a measured one, sample by sample on the same grid (n), by the
/// names a report shows; the formulas are those of fitting/metrics/.
///
///   nrmse                        RMSE over max |m|
///   correlation                  Pearson's; 0 when one of the two is constant
///   sprague_geers_magnitude, sprague_geers_phase, sprague_geers_comprehensive
///   theil_u, whang               inequalities
///   iso18571_corridor, iso18571_phase, iso18571_magnitude, iso18571_slope, iso18571_rating
///                                ISO/TS 18571; left out above 10 000 samples, where they would
///                                take a fit's time, and where samples do not follow each other
///                                (`contiguous` false)
///
/// Empty when there are no samples, m is zero throughout or something is not finite. Throws
/// std::invalid_argument for different lengths.
std::map<std::string, double> metrics(std::span<const double> measured,
                                      std::span<const double> computed, bool contiguous = true);

}  // namespace impactrig::fitting
