// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "acquisition/importers/hdf5_arrays.hpp"

namespace impactrig::acquisition {

/// What the scale of a dimension holds, the more telling the later.
enum class ScaleKind {
  none,     ///< there is no scale
  unknown,  ///< its numbers have no unit that says
  other,    ///< frequencies, lengths, ...
  time
};

struct DimensionScale {
  ScaleKind kind = ScaleKind::none;
  const Hdf5Array* array = nullptr;  ///< the data set that is the scale; null: none
};

/// The scales of the dimensions of data sets (DIMENSION_LIST), as netCDF4, xarray and h5py write
/// them. A reference counts where it leads to a data set of the class DIMENSION_SCALE that is as
/// long as the dimension; others are left aside.
class DimensionScales {
 public:
  /// `arrays` must outlive it.
  explicit DimensionScales(const std::vector<Hdf5Array>& arrays);

  /// The unit of a scale that counts instead of what the file says.
  void state_unit(const Hdf5Array& scale, const std::string& unit);

  /// The scale of a dimension, and among several one of time.
  DimensionScale along(const Hdf5Array& array, std::size_t dimension) const;

  /// The dimension of a data set of several that is time: the one whose scale says so, else the
  /// longest, of equal ones the first.
  std::size_t time_dimension(const Hdf5Array& array) const;

  /// False where it is but the first of several that are as long.
  bool time_dimension_is_sure(const Hdf5Array& array) const;

  /// The scale that the samples of a channel lie along.
  DimensionScale of_samples(const Hdf5Slice& slice) const;

 private:
  ScaleKind kind_of(const Hdf5Array& scale) const;

  std::map<std::uint64_t, const Hdf5Array*> by_reference_;
  std::map<const Hdf5Array*, std::string> stated_units_;
};

}  // namespace impactrig::acquisition
