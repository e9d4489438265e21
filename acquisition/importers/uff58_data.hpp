// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "acquisition/importers/text_file.hpp"
#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// What the header of a dataset 58 says of its numbers (record 7 and the identifier line).
struct Uff58Form {
  int ordinate_type = 2;  ///< 2 real single, 4 real double, 5 complex single, 6 complex double
  bool even = true;       ///< false: an abscissa stands before each ordinate
  std::uint64_t points = 0;
  bool binary = false;
  bool little_endian = true;
  std::uint64_t announced_bytes = 0;  ///< of the identifier line of 58b; 0 = not stated

  bool complex() const { return ordinate_type == 5 || ordinate_type == 6; }

  bool double_precision() const { return ordinate_type == 4 || ordinate_type == 6; }
};

/// Where the numbers of a dataset 58 lie.
struct Uff58Extent {
  const char* start = nullptr;
  const char* closing = nullptr;  ///< the closing line, or the end of the file
  std::uint64_t points = 0;       ///< that are there, whatever the header announces
  bool counted = true;            ///< false: the lines look right, their numbers were not counted
  std::uint32_t abscissa_bytes = 0;  ///< binary: of a point's abscissa
  std::uint32_t number_bytes = 4;    ///< binary: of a point's other numbers
  std::vector<std::string> warnings;
};

/// Finds the numbers that begin at `start`. In text, lines that are as long and as many as the
/// header has it are not read through where `trusting`. Sources: SDRC's page on dataset 58; the
/// University of Cincinnati's page on 58b. Throws datasets::InputError when a number is not
/// readable or none is there although some are announced.
Uff58Extent find_uff58_data(const TextFile& file, const char* start, const Uff58Form& form,
                            bool lines_count, bool trusting);

/// Points of a dataset 58, apart.
struct Uff58Block {
  std::vector<double> abscissa;   ///< empty when even
  datasets::RawSamples ordinate;  ///< float where the file holds single precision in binary
  std::vector<double> imaginary;  ///< empty when real

  std::size_t size() const;
};

class Uff58Text;
class Uff58Binary;

/// Reads the points of a dataset 58 piece by piece.
class Uff58Reader {
 public:
  Uff58Reader(const TextFile& file, const Uff58Form& form, const Uff58Extent& extent,
              bool lines_count);
  ~Uff58Reader();
  Uff58Reader(const Uff58Reader&) = delete;
  Uff58Reader& operator=(const Uff58Reader&) = delete;

  /// Passes over points, at most so many, where they need not be looked at; returns how many.
  std::uint64_t skip(std::uint64_t points);

  /// The next points, at most so many; none at the end. Throws datasets::InputError for what
  /// is no number.
  Uff58Block read(std::size_t most);

  const char* at() const;

  std::vector<std::string> warnings() const;

 private:
  std::uint64_t left_;
  bool even_lines_;  // every line but the last is as long as the first
  std::unique_ptr<Uff58Text> text_;
  std::unique_ptr<Uff58Binary> binary_;
};

/// True when a line is the delimiter of datasets: -1 in columns 5 and 6, blanks elsewhere.
bool is_uff_delimiter(std::string_view line);

}  // namespace impactrig::acquisition
