// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace impactrig::models {

/// Values of S stages side by side (lanes), a column for each coordinate of a chain.
template <int S>
using StageArray = Eigen::Array<double, S, Eigen::Dynamic>;

/// Of the bar somewhere, against hanging: cosine and sine of its angle, closing < 0.
struct BarDirection {
  double cosine = 1.0, sine = 0.0;
};

/// What a coordinate has to do with a place of the bar.
struct ChainShare {
  int coordinate = 0;
  double shape = 0.0;  ///< [-]
};

}  // namespace impactrig::models
