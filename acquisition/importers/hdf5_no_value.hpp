// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace impactrig::acquisition {

struct Hdf5Array;

/// What the NetCDF conventions say of numbers that are no samples, as they are stored: those that
/// stand for none, and those beyond a range.
struct Hdf5NoValue {
  std::vector<double> numbers{};
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();

  bool any() const;

  bool holds(double number) const;

  /// "-999, which stands for none" or "not between 0 and 5", or both.
  std::string text() const;
};

/// Of column `which` by the attributes `_FillValue`, `missing_value`, `valid_min`, `valid_max` and
/// `valid_range`: of single precision they are as single precision holds them.
Hdf5NoValue no_value_of(const Hdf5Array& array, std::uint64_t which, std::uint64_t columns);

}  // namespace impactrig::acquisition
