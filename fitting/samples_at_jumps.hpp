// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "fitting/fitted_channel.hpp"
#include "fitting/shot_model.hpp"

namespace impactrig::fitting {

/// What a channel's samples show of a curve that may jump.
///
/// Where the force jumps, the cost would too when a time moves a sample from one side to the other,
/// and the search would end there. A sample so near that the time may be that wrong shows the side
/// that is nearer to what was measured.
class SamplesAtJumps {
 public:
  /// `rough`: the time may be as wrong as while a search is far off. The channel must live as long.
  SamplesAtJumps(const FittedChannel& channel, const Measurement& measurement,
                 const Shown::Curve& curve, bool rough);

  const FittedChannel& channel() const { return channel_; }

  /// Value and slope of a curve at a sample. A curve that has not as many jumps, as a slope may
  /// where these come and go, has no such sides: it is taken at the sample's time.
  std::array<double, 2> at(const Shown::Curve& curve, std::size_t sample) const;

 private:
  struct Elsewhere {
    std::size_t sample, piece;
  };

  void look_beside(std::size_t jump, double gain, const Shown::Curve& curve, double near);

  const FittedChannel& channel_;
  double shift_;
  std::size_t jumps_;
  std::vector<Elsewhere> elsewhere_;  // samples that show another piece than their time says
};

}  // namespace impactrig::fitting
