// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/lanes/lane_chunk.hpp"
#include "models/lanes/station_lanes.hpp"

namespace impactrig::models {
namespace {

/// find_slopes() for N stations at a time.
template <int N>
void find_slopes_by(const SlopesOfModes& modes) {
  using Real = typename LaneMath<N>::Real;
  by_chunks<N>(modes.stations, [&](const auto& chunk) {
    Real slope = Real{}, rate = Real{};
    for (int k = 0; k < modes.modes; ++k) {
      const Real own = chunk.load(modes.slopes + k * modes.stations);
      slope += own * modes.a[k];
      rate += own * modes.rate[k];
    }
    chunk.store(slope, modes.slope);
    chunk.store(rate, modes.slope_rate);
  });
}

/// find_force_of_pull() likewise.
template <int N>
void find_force_of_pull_by(const PullOnModes& modes) {
  using M = LaneMath<N>;
  for (int k = 0; k < modes.modes; ++k) {
    typename M::Real sum = {};
    by_chunks<N>(modes.stations, [&](const auto& chunk) {
      sum += chunk.load(modes.slopes + k * modes.stations) * chunk.load(modes.pull);
    });
    modes.force[k] = M::sum(sum);
  }
}

/// find_third_order_pull() likewise.
template <int N>
class ThirdOrderPulls {
 public:
  explicit ThirdOrderPulls(ThirdOrderPull& stations) : stations_(stations) {}

  void find() {
    by_chunks<N>(stations_.stations, [this](const auto& chunk) { pull(chunk); });
    for (int first = 0; first < stations_.stations; first += N)
      bend({first, stations_.stations - 1});
    stations_.of_frame = -M::sum(of_frame_);
  }

 private:
  using M = LaneMath<N>;
  using Real = typename M::Real;
  using Chunk = LaneChunk<N>;

  /// By what draws the points towards the hinge, weight and strain.
  void pull(const auto& chunk) {
    const Real length = chunk.load(stations_.length), weight = chunk.load(stations_.weight);
    const Real s = 0.5 * (chunk.load(stations_.slope_before) + chunk.load(stations_.slope_after));
    const Real gained =
        chunk.load(stations_.momentum_after) - chunk.load(stations_.momentum_before);
    Real pull = -length * s *
                (gained / stations_.h + weight * (0.5 * s * s - chunk.load(stations_.strain)));
    if (stations_.floats) {
      const Real off = s - stations_.frame;
      const Real in_frame = 0.5 * length * weight * off * off * off;
      pull += in_frame;
      of_frame_ += in_frame;  // lanes beyond have no length
    }
    chunk.store(s, stations_.slope);
    chunk.store(pull, stations_.pull);
  }

  /// Of ½ ∫ EI w''² (s² − (s − ψ)²) dx, from each station's middle to the next.
  void bend(const Chunk& chunk) {
    const Real low = chunk.load(stations_.slope), high = chunk.load(stations_.slope + 1);
    Real moment = chunk.load(stations_.bending) * (high - low);
    const Real density = 0.5 * moment * (high - low);
    Real of_low = density, of_high = density;
    if (stations_.floats) {
      const double frame = stations_.frame;
      of_frame_ += density * (low + high - 2.0 * frame);
      moment *= frame * (low + high - frame);
      of_low *= frame;
      of_high *= frame;
    } else {
      moment *= 0.5 * (low * low + high * high);
      of_low *= low;
      of_high *= high;
    }
    Real of_one_before = M::template turned<N - 1>(moment + of_high);
    const double last = of_one_before[0];
    of_one_before[0] = before_;
    before_ = last;
    const Chunk here(chunk.first, stations_.stations);
    here.store(here.load(stations_.pull) + (moment - of_low) - of_one_before, stations_.pull);
  }

  ThirdOrderPull& stations_;
  Real of_frame_ = {};
  double before_ = 0.0;  // what the last of a chunk's stations does to the next
};

template <int N>
void find_third_order_pull_by(ThirdOrderPull& stations) {
  ThirdOrderPulls<N>(stations).find();
}

}  // namespace
}  // namespace impactrig::models
