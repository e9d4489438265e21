// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/importers/hdf5_no_value.hpp"
#include "acquisition/importers/wide_integers.hpp"
#include "acquisition/recording_reader.hpp"

namespace impactrig::acquisition {

/// How numbers of a data set are handed over: the smallest of our types that holds all of them.
enum class ArrayNumbers : std::uint64_t { i16, i32, f32, f64 };

/// Attributes of an object that are texts or numbers, one or several.
struct Hdf5Attributes {
  std::map<std::string, std::string> texts;
  std::map<std::string, std::vector<std::string>> lists;
  std::map<std::string, double> numbers;
  std::map<std::string, std::vector<double>> number_lists;
  std::vector<std::string> others;  ///< names of those that are neither, or too many
};

/// A data set of numbers in an HDF5 file, or one field of a table of records.
struct Hdf5Array {
  std::string path;                     ///< "/entry/force"
  std::vector<std::string> field_path;  ///< names that lead to it; empty: the data set itself
  std::uint64_t field_index = 0;        ///< among all fields of the records
  std::uint64_t fields = 0;             ///< all of the records
  std::uint64_t element = 0;            ///< which number of a field that is a list of them
  std::uint64_t elements = 0;           ///< how many it lists; 0: the field is one number
  std::vector<std::uint64_t> shape;     ///< slowest dimension first; empty: a single number
  ArrayNumbers numbers = ArrayNumbers::f64;
  bool wide = false;            ///< integers of 64 bits: not all are exact as doubles
  bool bits = false;            ///< a bit field, which HDF5 makes no numbers of
  bool complex = false;         ///< a pair of members, "real" and "imag"
  std::string text;             ///< of MATLAB's, which are numbers to HDF5
  std::string shown_as{};       ///< of a field of MATLAB's structures: "run(2).force", not its path
  bool is_axis = false;         ///< the writing program says that those beside it lie over it
  bool rows_first = false;      ///< likewise that each row is a sample, however few there are
  std::uint64_t reference = 0;  ///< what stands for the data set in the lists of others
  /// Data sets that hold the scale of a dimension, by their reference, one list a dimension.
  std::vector<std::vector<std::uint64_t>> scales;
  Hdf5Attributes attributes;

  bool is_field() const { return !field_path.empty(); }

  std::string field() const;  ///< "force", within records "sensor.force", of a list "force:2"
};

/// A data set of references to others; they are compared with Hdf5Array::reference and never
/// followed, so that a damaged one leads nowhere.
struct Hdf5References {
  std::string path;
  std::string kept_as;          ///< by MATLAB: "cell"; "" a field of structures
  std::uint64_t reference = 0;  ///< to itself
  std::vector<std::uint64_t> to{};
};

struct Hdf5Listing {
  std::vector<Hdf5Array> arrays;
  std::vector<Hdf5References> references;
  std::map<std::string, Hdf5Attributes> groups;                ///< by path; the root's is "/"
  std::map<std::uint64_t, std::string> referred_groups;        ///< paths, by their reference
  std::map<std::string, std::string> texts;                    ///< data sets of one text, by path
  std::map<std::string, std::vector<std::string>> text_lists;  ///< those of several
  std::vector<std::string> skipped;                            ///< "'/a' (why)"
  /// Soft links, and hard links to what is listed already, by what they lead to, as paths.
  std::multimap<std::string, std::string> links;
};

/// The paths by which links lead to a data set, to it or to a group around it: the first ones.
std::vector<std::string> links_to(const Hdf5Listing& listing, const std::string& path);

/// Lists the data sets of numbers. HDF5 runs in a child process, since it does not survive all
/// damaged files. Throws datasets::InputError.
Hdf5Listing list_hdf5(const std::string& path);

/// Which numbers of a data set: `count` of them from `first`, along the dimension `along`, at
/// `other` of the other dimensions, the last of which counts fastest.
struct Hdf5Slice {
  const Hdf5Array* array = nullptr;
  bool whole = false;     ///< as a list in the order of the file, whatever its shape
  std::size_t along = 0;  ///< dimension that is time, where it has several and is not taken whole
  std::uint64_t other = 0;
  std::uint64_t first = 0;
  std::uint64_t count = 0;
  /// Integers of 64 bits, less the first of the data set: doubles hold those where they do not hold
  /// the integers.
  bool from_first = false;
  Hdf5NoValue none{};  ///< numbers that are no samples
  /// Of as many numbers: handed over as times, time_factor * number + time_offset.
  std::shared_ptr<const Hdf5Slice> times{};
  double time_factor = 1.0;  ///< [s]
  double time_offset = 0.0;  ///< [s]
};

/// Where a slice lies in each dimension; 0 in that of time.
std::vector<std::uint64_t> places_of(const Hdf5Slice& slice);

/// What was seen of a slice as it was read.
struct Hdf5SliceSeen {
  WideIntegers wide;
  std::uint64_t missing = 0;  ///< samples that Hdf5Slice::none holds
};

/// Reads slices by blocks, in a child process too. Throws datasets::InputError.
std::vector<Hdf5SliceSeen> read_hdf5_slices(const std::string& path,
                                            const std::vector<Hdf5Slice>& slices, SampleSink& sink);

// What attributes say, by their names in lower case.

/// A number, by the first of these names.
std::optional<double> number_of(const Hdf5Attributes& attributes,
                                std::span<const std::string_view> names);

/// The same in a unit, from one that "fs_units" may state, or a text: "51.2 kHz"; `otherwise` where
/// neither does.
std::optional<double> quantity_of(const Hdf5Attributes& attributes,
                                  std::span<const std::string_view> names, const std::string& unit,
                                  const std::string& otherwise = {});

/// "units", "unit" or "unit_string".
bool is_unit_key(std::string_view key);

/// The unit that an attribute states for all columns or one a column, else the name of the channel.
std::string unit_of(const Hdf5Array& array, const std::string& name, std::uint64_t which,
                    std::uint64_t columns);

/// What the NetCDF conventions say of numbers that stand for others.
struct Hdf5Packing {
  double scale = 1.0;
  double offset = 0.0;
  std::string problem;  ///< why it cannot be undone
};

/// Of column `which`: attributes state one number for all columns, or one a column.
Hdf5Packing packing_of(const Hdf5Array& array, std::uint64_t which, std::uint64_t columns);

/// Attributes that may be meant to be applied, and no convention says how; "'gain', 'offset'". More
/// words may be meant so where the numbers are integers, as a converter gives them.
std::string unapplied_scales(const Hdf5Array& array);

}  // namespace impactrig::acquisition
