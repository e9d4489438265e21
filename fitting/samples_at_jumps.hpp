// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <vector>

#include "fitting/fitted_channel.hpp"
#include "fitting/shot_model.hpp"

namespace impactrig::fitting {

/// What a channel's samples show of a curve that may jump: the curve at the instants that the
/// recorder took them at, and what the record's filters made of these afterwards.
///
/// Where the curve jumps, the cost would too when a time moves a sample from one side to the other,
/// and the search would end there. Samples so near that the time may be that wrong show the side
/// that brings all nearest to what was measured.
class SamplesAtJumps {
 public:
  /// `rough`: the time may be as wrong as while a search is far off. The channel must live as long.
  SamplesAtJumps(const FittedChannel& channel, const Measurement& measurement,
                 const Shown::Curve& curve, bool rough);

  const FittedChannel& channel() const { return channel_; }

  /// What a curve shows at samples of these numbers, ascending (n_numbers). One that has not as
  /// many jumps, as a slope may where these come and go, has no such sides: it is taken at the
  /// samples' times.
  std::vector<double> values(const Shown::Curve& curve, std::span<const std::size_t> numbers) const;

  /// Slope over time of the same [1/s].
  std::vector<double> slopes(const Shown::Curve& curve, std::span<const std::size_t> numbers) const;

 private:
  class JumpPlaces;

  /// On the recorder's samples, counted from an instant that they share with the filtered ones.
  double time_of(std::ptrdiff_t taken) const;
  datasets::GridSamples taken(const Shown::Curve& curve, std::size_t order,
                              std::span<const std::size_t> numbers) const;
  /// What the filters make of samples taken, at some of them (n_numbers).
  std::vector<double> filtered(datasets::GridSamples samples,
                               std::span<const std::size_t> numbers) const;

  const FittedChannel& channel_;
  double shift_, origin_, interval_, reach_;
  std::ptrdiff_t offset_;  // of the signal's first sample from that instant
  std::size_t jumps_;
  /// Samples taken that show another piece of the curve than their time says.
  std::map<std::ptrdiff_t, std::size_t> elsewhere_;
};

}  // namespace impactrig::fitting
