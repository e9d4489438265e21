// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/lanes/lane_math.hpp"

namespace impactrig::models {
namespace {

/// N of the modes' numbers, less at the end: lanes beyond are of a mode that does not vibrate and
/// is not struck.
template <int N>
struct ModeChunk {
  using Real = typename LaneMath<N>::Real;

  int first, count;

  ModeChunk(int first_mode, int modes)
      : first(first_mode),
        count(modes - first_mode < N ? modes - first_mode : N) {}

  Real load(const double* values) const {
    Real lanes = Real{};
    if (count == N)
      __builtin_memcpy(&lanes, values + first, sizeof lanes);
    else
      for (int i = 0; i < count; ++i) lanes[i] = values[first + i];
    return lanes;
  }

  /// Into every `stride`-th place.
  void store(Real lanes, double* values, int stride = 1) const {
    if (count == N && stride == 1)
      __builtin_memcpy(values + first, &lanes, sizeof lanes);
    else
      for (int i = 0; i < count; ++i) values[(first + i) * stride] = lanes[i];
  }
};

}  // namespace
}  // namespace impactrig::models
