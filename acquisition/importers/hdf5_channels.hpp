// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "acquisition/importers/hdf5_arrays.hpp"
#include "acquisition/importers/hdf5_scales.hpp"
#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// The channels of an HDF5 file of another program, and where the samples of each are. In three
/// steps: made, then set_clocks() of hdf5_clocks.hpp, then settle_the_rest().
struct Hdf5Channels {
  /// Makes channels of the data sets of numbers, single numbers too, which may tell of clocks.
  /// `units`: what the user states instead of the file, one a channel that stays one; "" leaves the
  /// file's. Throws datasets::InputError when there are more or fewer.
  Hdf5Channels(const std::string& file, Hdf5Listing listed, bool of_matlab,
               const std::vector<std::string>& units);

  // slices and scales point into the listing
  Hdf5Channels(const Hdf5Channels&) = delete;
  Hdf5Channels& operator=(const Hdf5Channels&) = delete;

  /// Single numbers become attributes, unless MATLAB wrote them, and what is not read is told.
  /// Throws datasets::InputError when the numbers cannot be read.
  void settle_the_rest();

  /// Of a data set, all fields of records together: "/run/force"; as MATLAB writes it "run.force".
  std::string name_of_set(const Hdf5Array& array) const {
    return array.shown_as.empty() ? name_of_path(array.path) : array.shown_as;
  }

  /// The same of any path.
  std::string name_of_path(const std::string& path_within) const;

  /// Adds a warning that is not there yet.
  void warn(std::string sentence);

  std::string path;
  bool matlab;  ///< a MAT-file of version 7.3
  Hdf5Listing listing;
  DimensionScales scales;
  datasets::Record record;
  std::vector<Hdf5Slice> slices;       ///< one a channel
  std::set<std::size_t> still_packed;  ///< channels whose packing cannot be undone, until settled
};

/// Hands the numbers of a slice to `use`, in pieces and in their order. Throws
/// datasets::InputError.
void each_number_of(const std::string& path, const Hdf5Slice& slice,
                    const std::function<void(std::span<const double>)>& use);

}  // namespace impactrig::acquisition
