// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "datasets/record.hpp"

namespace impactrig::datasets {

/// A channel as a viewer draws it: at most so many points, in the SI unit where the channel's
/// converts.
struct Quicklook {
  std::string unit;               ///< of `values` and `imaginary`
  std::vector<double> time;       ///< [s] (n_points)
  std::vector<double> values;     ///< (n_points), NaN where the sample is not valid
  std::vector<double> imaginary;  ///< (n_points) of a complex channel, else empty
};

/// All samples where they are few, else the smallest and the largest of each of most/2 buckets, in
/// their order, so that the peak of a short impact stays.
Quicklook quicklook_of(const Channel& channel, std::size_t most);

}  // namespace impactrig::datasets
