// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

#include "models/implicit/stage_array.hpp"
#include "models/rig.hpp"
#include "models/simulation.hpp"

namespace impactrig::models {

/// The points of a chain that a run looks at: what makes up the displacement −Σ w q_k before each
/// stop, and that −X at the lasers' spots.
struct ChainPoints {
  using Shares = std::vector<ChainShare>;

  std::vector<Shares> stops;
  Shares velocity_spot, displacement_spot;
  Shares along_spot;                ///< that the displacement's has along the bar, −U
  double displacement_place = 0.0;  ///< from the hinge [m]

  /// `struck`: X of the node before the first stop.
  template <typename Chain>
  ChainPoints(const typename Chain::Beam& beam, const Chain& chain, int struck, const Rig& rig,
              const HistoryRequest& history)
      : stops{{{struck, 1.0}}} {
    const auto at = [&](double x) {
      const std::array<ChainShare, 4> shares = chain.shares_at(beam, x);
      return Shares(shares.begin(), shares.end());
    };
    for (const FurtherStop& stop : rig.further_stops) {
      Shares& shares = stops.emplace_back(at(stop.contact.position));
      for (ChainShare& share : shares)  // what is on the hinge is held
        share.shape *= share.coordinate == 0 ? 0.0 : stop.direction();
    }
    const auto spot = [&](double x) { return x > 0.0 ? x : rig.contact.position; };
    displacement_place = spot(history.displacement_position);
    velocity_spot = at(spot(history.velocity_position));
    displacement_spot = along_spot = at(displacement_place);
    for (ChainShare& share : along_spot) share.coordinate += Chain::beside;
  }

  /// Nothing looked at, for sums.
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
