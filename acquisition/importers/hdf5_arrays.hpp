// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/importers/wide_integers.hpp"
#include "acquisition/recording_reader.hpp"

namespace impactrig::acquisition {

/// How numbers of a data set are handed over: the smallest of our types that holds all of them.
enum class ArrayNumbers : std::uint64_t { i16, i32, f32, f64 };

/// Attributes of an object that are one text, several, or one number.
struct Hdf5Attributes {
  std::map<std::string, std::string> texts;
  std::map<std::string, std::vector<std::string>> lists;
  std::map<std::string, double> numbers;
};

/// A data set of numbers in an HDF5 file, or one field of a table of records.
struct Hdf5Array {
  std::string path;                  ///< "/entry/force"
  std::string field;                 ///< "" = the data set itself
  std::uint64_t field_index = 0;     ///< among all fields of the records
  std::vector<std::uint64_t> shape;  ///< slowest dimension first; empty: a single number
  ArrayNumbers numbers = ArrayNumbers::f64;
  bool wide = false;     ///< integers of 64 bits: not all are exact as doubles
  bool complex = false;  ///< a pair of members, "real" and "imag"
  std::string text;      ///< of MATLAB's, which are numbers to HDF5
  Hdf5Attributes attributes;
};

struct Hdf5Listing {
  std::vector<Hdf5Array> arrays;
  std::map<std::string, Hdf5Attributes> groups;  ///< by path; the root's is "/"
  std::map<std::string, std::string> texts;      ///< data sets of one text, by path
  std::vector<std::string> skipped;              ///< "'/a' (why)"
};

/// Lists the data sets of numbers. HDF5 runs in a child process, since it does not survive all
/// damaged files. Throws datasets::InputError.
Hdf5Listing list_hdf5(const std::string& path);

/// Which numbers of a data set: `count` of them from `first`, along the dimension `along`, at
/// `other` of the other dimension. Data sets of other ranks are taken in the order of the file.
struct Hdf5Slice {
  const Hdf5Array* array = nullptr;
  bool whole = false;     ///< as a list, whatever its shape
  std::size_t along = 0;  ///< dimension that is time, where it has two and is not taken whole
  std::uint64_t other = 0;
  std::uint64_t first = 0;
  std::uint64_t count = 0;
  std::optional<double> missing{};  ///< the number that stands for none
  /// Of as many numbers: handed over as times, time_factor * number + time_offset.
  std::shared_ptr<const Hdf5Slice> times{};
  double time_factor = 1.0;  ///< [s]
  double time_offset = 0.0;  ///< [s]
};

/// What was seen of a slice as it was read.
struct Hdf5SliceSeen {
  WideIntegers wide;
  std::uint64_t missing = 0;  ///< samples that are Hdf5Slice::missing
};

/// Reads slices by blocks, in a child process too. Throws datasets::InputError.
std::vector<Hdf5SliceSeen> read_hdf5_slices(const std::string& path,
                                            const std::vector<Hdf5Slice>& slices, SampleSink& sink);

}  // namespace impactrig::acquisition
