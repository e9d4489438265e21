// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

/// The numbers of a dataset 58, apart.
struct Uff58Data {
  std::vector<double> abscissa;   ///< empty when even
  datasets::RawSamples ordinate;  ///< float where the file holds single precision in binary
  std::vector<double> imaginary;  ///< empty when real
  std::vector<std::string> warnings;

  std::size_t size() const;
};

/// Reads the numbers that begin at `at` and leaves it at the closing line (or the end of the file).
/// What is there is read, whatever the header announces; nothing is allocated by what it announces.
/// Sources: SDRC's page on dataset 58; the University of Cincinnati's page on 58b. Throws
/// datasets::InputError when a number is not readable or none is there although some are announced.
Uff58Data read_uff58_data(const TextFile& file, const char*& at, const Uff58Form& form,
                          bool lines_count);

/// True when a line is the delimiter of datasets: -1 in columns 5 and 6, blanks elsewhere.
bool is_uff_delimiter(std::string_view line);

}  // namespace impactrig::acquisition
