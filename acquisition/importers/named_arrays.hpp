// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/importer.hpp"

namespace impactrig::acquisition {

/// An array of numbers in a file that has names but no convention for them (MAT, HDF5).
struct NamedArray {
  std::string name;  ///< "run.force", "/entry/force": groups are told by the last '.' or '/'
  std::uint64_t samples = 0;
  bool real = true;
  bool time = false;     ///< the file says that it is
  double seconds = 1.0;  ///< of one of its unit, where it holds times; where rates, of a period
  bool has_unit = false;
  std::vector<std::string> other_names{};  ///< by links, as `name`: it is in these groups too
};

/// Says of an array that its numbers have a unit: of times, of intervals and rates it counts; what
/// has another one holds no times.
void take_unit(NamedArray& array, const std::string& unit);

/// When the samples of an array were taken, as the names tell.
struct ArrayClock {
  double start = 0.0;     ///< [s]
  double interval = 0.0;  ///< [s]; 0: nothing in the file tells
  /// The array that holds its times, where they are not uniform.
  std::optional<std::size_t> times;
  double seconds = 1.0;    ///< of one of their units
  std::string unusable{};  ///< what is stated and can be no interval: "'dt' as 0"
};

/// Some of an array's numbers that follow each other.
struct NumberRange {
  std::uint64_t first = 0, count = 0;
};

/// Hands these numbers of array `index` to `use`, in pieces and in their order.
using EachNumber = std::function<void(std::size_t index, const NumberRange& range,
                                      const std::function<void(std::span<const double>)>& use)>;

struct ArrayClocks {
  std::vector<ArrayClock> clocks;     ///< one an array
  std::vector<std::string> warnings;  ///< one sentence each
  std::string time_column;            ///< what was taken as time and why; "" = nothing
  std::string without_unit;           ///< what of it has no unit: it is taken as s
};

/// Finds the array that holds the times ("t", "time", ...: as long as others and increasing
/// throughout), else a single number that is the sampling interval ("dt", "sampleInterval", ...) or
/// rate ("Fs", "SampleRate", ...), else the first column of a matrix. Times that contradict other
/// times or such a number are a warning. What stands in an array's own group counts before what
/// stands around it, up to the top. An array that may hold the times is read twice, and not
/// kept; where the head alone is asked for, its first and last numbers stand for all. Throws
/// datasets::InputError when a stated time column is not there.
ArrayClocks clocks_by_name(const std::string& path, const std::vector<NamedArray>& arrays,
                           const EachNumber& each_number, const ImportOptions& options);

}  // namespace impactrig::acquisition
