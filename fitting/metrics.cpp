// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/metrics.hpp"

#include <algorithm>
#include <cmath>

#include "fitting/metrics/inequality.hpp"
#include "fitting/metrics/iso18571.hpp"
#include "fitting/metrics/magnitude_phase.hpp"
#include "fitting/metrics/residuals.hpp"

namespace impactrig::fitting {

std::map<std::string, double> metrics(std::span<const double> measured,
                                      std::span<const double> computed, bool contiguous) {
  constexpr std::size_t most_rated_in_a_fit = 10'000;  // some 60 ms
  const HistoryPair pair{measured, computed};
  const auto finite = [](double x) { return std::isfinite(x); };
  if (!std::ranges::all_of(measured, finite) || !std::ranges::all_of(computed, finite)) return {};
  if (measured.empty() || peak_of(measured) == 0.0) return {};
  const MagnitudePhase geers = sprague_geers(pair);
  const double pearson = correlation(pair);
  std::map<std::string, double> result = {{"nrmse", root_mean_square_error(pair).of_peak},
                                          {"correlation", std::isfinite(pearson) ? pearson : 0.0},
                                          {"sprague_geers_magnitude", geers.magnitude},
                                          {"sprague_geers_phase", geers.phase},
                                          {"sprague_geers_comprehensive", geers.comprehensive},
                                          {"theil_u", theil_u(pair)},
                                          {"whang", whang(pair)}};
  if (contiguous && measured.size() >= 2 && measured.size() <= most_rated_in_a_fit) {
    const Iso18571 iso = iso18571(pair);
    result["iso18571_corridor"] = iso.corridor;
    result["iso18571_phase"] = iso.phase;
    result["iso18571_magnitude"] = iso.magnitude;
    result["iso18571_slope"] = iso.slope;
    result["iso18571_rating"] = iso.rating;
  }
  return result;
}

}  // namespace impactrig::fitting
