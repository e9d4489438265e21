// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/importer.hpp"
#include "acquisition/importers/byte_cursor.hpp"
#include "acquisition/importers/mapped_file.hpp"
#include "acquisition/importers/stored_numbers.hpp"

namespace impactrig::acquisition {

/// A numeric array of a MAT-file, or of another that lists arrays by name: column after column.
struct MatArray {
  std::string name;        ///< "run.force": a field of a structure
  std::uint64_t rows = 0;  ///< of the first column; beyond two dimensions: all of them
  std::uint64_t columns = 0;
  std::uint64_t dimensions = 2;
  NumberKind kind = NumberKind::f64;
  std::uint64_t offset = 0;  ///< of the first number
  std::uint64_t stride = 0;  ///< from one to the next [bytes]; 0: they lie side by side
  std::uint64_t count = 0;   ///< numbers that are there, rows x columns at most
  bool other_order = false;  ///< of bytes, than MatContents::big_endian says
  bool transposed = false;   ///< the program that wrote it calls its rows columns
  bool complex = false;
  std::uint64_t imaginary_offset = 0;
  NumberKind imaginary_kind = NumberKind::f64;
};

/// What a MAT-file of version 4 or 5 holds, or another list of arrays.
struct MatContents {
  std::unique_ptr<MappedFile> file;  ///< where `offset` counts; unpacked when it was compressed
  bool big_endian = false;
  std::string version;  ///< "4", "5"; "" of other files
  std::string header;   ///< its text
  std::vector<MatArray> arrays;
  std::map<std::string, std::string> texts;  ///< UTF-8, with the control characters they have
  /// Arrays of structures at the top, and those in them two levels down: how many they are.
  std::map<std::string, std::uint64_t> structures;
  std::vector<std::string> variables;  ///< structures at the top, in the file's order
  std::vector<std::string> warnings;   ///< one sentence each

  struct Skipped {
    std::string name;
    std::string why;
  };

  std::vector<Skipped> skipped;  ///< what is no array of numbers, the first of them
  std::uint64_t more_skipped = 0;

  std::string_view bytes() const { return file->bytes(); }

  /// A number of the file, in its byte order.
  template <typename Number>
  Number number(std::uint64_t at) const {
    return ByteCursor(*file, big_endian, at).read<Number>("a field");
  }

  void warn(std::string text);
  void skip(const std::string& name, std::string_view why);
  /// A matrix of characters, column after column, as a cell array of its lines would be:
  /// "units{1}".
  void add_lines(const std::string& name, std::uint64_t lines, std::u16string_view letters);
  /// Where fewer numbers are there than it declares, with a warning; where none is, it is skipped.
  void add(const MatArray& array, std::uint64_t declared);
};

constexpr std::uint64_t longest_mat_name = 256;                     ///< MATLAB: 63 [bytes]
constexpr std::uint64_t longest_mat_text = std::uint64_t{1} << 20;  ///< [bytes]

/// What to say of an object of a class of MATLAB, "" where that is not known, with the way out.
std::string matlab_object(std::string_view type);

/// "not read: 'c' (a cell array) and 3 more"; "" where nothing was skipped.
std::string skipped_arrays(const MatContents& contents);

/// Lists the arrays. Throws datasets::InputError.
MatContents read_mat_contents(const std::string& path);

/// Each array or column of one is a channel; names and units of columns, and clocks, are found by
/// the names of the arrays. Throws datasets::InputError for units that are not one a channel.
std::unique_ptr<RecordingReader> reader_of_mat_contents(MatContents contents,
                                                        const ImportOptions& options);

}  // namespace impactrig::acquisition
