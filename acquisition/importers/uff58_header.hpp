// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "acquisition/importers/uff58_data.hpp"

namespace impactrig::acquisition {

/// Columns of a line, by number as the standard counts them (from 1), cut where the line is short.
std::string_view uff_columns(std::string_view line, std::size_t first, std::size_t width);

/// Text of a field; "NONE" stands for nothing.
std::string uff_text(std::string_view field);

/// An axis as records 8 to 11 describe it.
struct UffAxis {
  int type = 0;  ///< specific data type
  std::string label;
  std::string unit;
};

/// The header of one dataset 58.
struct UffHeader {
  std::array<std::string, 5> id;  ///< id lines, "NONE" as it stands there
  int function_type = 0;
  std::string response_entity, reference_entity;
  long response_node = 0, response_direction = 0, reference_node = 0, reference_direction = 0;
  Uff58Form form;
  double start = 0.0;               ///< of an even abscissa, in its unit
  double increment = 0.0;           ///< likewise
  std::string_view increment_text;  ///< as it is written
  UffAxis abscissa, ordinate, denominator;
};

/// Thrown where the file ends within a header.
struct UffHeaderCut {
  const char* at;
};

/// Reads the header of a dataset 58 whose identifier line is behind `at`, and leaves `at` at the
/// first number. Places are bytes where lines no longer count (behind binary data). Throws
/// UffHeaderCut, and datasets::InputError for what is no header, or numbers of machines that are
/// not read.
UffHeader read_uff58_header(const TextFile& file, std::string_view identifier, const char*& at,
                            bool lines_count);

}  // namespace impactrig::acquisition
