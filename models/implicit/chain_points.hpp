// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

#include "models/implicit/stage_array.hpp"
#include "models/rig.hpp"
#include "models/simulation.hpp"

namespace impactrig::models {

/// The points of a chain that a run looks at: what makes up the displacement −Σ w q_k before each
/// stop, that −X at the lasers' spots, and how it changes along the bar where that is asked for.
struct ChainPoints {
  using Shares = std::vector<ChainShare>;

  std::vector<Shares> stops;
  Shares velocity_spot, displacement_spot;
  Shares along_spot;  ///< that the displacement's has along the bar, −U
  Shares velocity_slope, displacement_slope, along_slope;
  double displacement_place = 0.0;  ///< from the hinge [m]

  /// `struck`: X of the node before the first stop.
  template <typename Chain>
  ChainPoints(const typename Chain::Beam& beam, const Chain& /*deduced*/, int struck,
              const Rig& rig, const HistoryRequest& history)
      : stops{{{struck, 1.0}}} {
    const auto shares_of = [](const typename Chain::Beam::Row& row) {
      const std::array<ChainShare, 4> shares = Chain::shares_of(row);
      return Shares(shares.begin(), shares.end());
    };
    const auto at = [&](double x) { return shares_of(beam.row_at(x)); };
    for (const FurtherStop& stop : rig.further_stops) {
      Shares& shares = stops.emplace_back(at(stop.contact.position));
      for (ChainShare& share : shares)  // what is on the hinge is held
        share.shape *= share.coordinate == 0 ? 0.0 : stop.direction();
    }
    const auto spot = [&](double x) { return x > 0.0 ? x : rig.contact.position; };
    displacement_place = spot(history.displacement_position);
    velocity_spot = at(spot(history.velocity_position));
    displacement_spot = at(displacement_place);
    along_spot = beside<Chain>(displacement_spot);
    if (!history.spot_slopes) return;
    velocity_slope = shares_of(beam.slope_row_at(spot(history.velocity_position)));
    displacement_slope = shares_of(beam.slope_row_at(displacement_place));
    along_slope = beside<Chain>(displacement_slope);
  }

  /// Of U what these are of X.
  template <typename Chain>
  static Shares beside(Shares shares) {
    for (ChainShare& share : shares) share.coordinate += Chain::beside;
    return shares;
  }

  /// Nothing looked at, for sums; those have no slopes.
  explicit ChainPoints(std::size_t count) : stops(count) {}

  void add(double weight, const ChainPoints& other) {
    const auto append = [weight](Shares& to, const Shares& from) {
      for (const ChainShare& share : from) to.push_back({share.coordinate, weight * share.shape});
    };
    for (std::size_t k = 0; k < stops.size(); ++k) append(stops[k], other.stops[k]);
    append(velocity_spot, other.velocity_spot);
    append(displacement_spot, other.displacement_spot);
    append(along_spot, other.along_spot);
    displacement_place += weight * other.displacement_place;
  }
};

}  // namespace impactrig::models
