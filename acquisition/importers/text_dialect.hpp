// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "acquisition/importers/text_table.hpp"

namespace impactrig::acquisition {

/// A row of a table: how many cells, and whether they are numbers.
struct RowShape {
  std::size_t cells = 0;          ///< without empty ones at the end
  std::size_t written_cells = 0;  ///< with them
  bool numeric = false;           ///< numbers and missing values only, and at least one number
};

/// Where the rows begin in one dialect, and how well it explains what follows.
struct DialectFound {
  Dialect dialect;
  std::size_t first_line = 0;
  RowShape first_row;
  std::size_t numeric_lines = 0;
  std::size_t numbers = 0;  ///< beside text in these lines
};

/// True for a line that is empty or a remark.
bool is_skipped_line(std::string_view line);

/// How many columns a line above the rows names: 0 where it holds a number or nothing.
std::size_t named_columns(std::string_view line, Dialect dialect);

/// The dialect in which most of the rows behind `from` are numbers, among equals the one with more
/// columns; dates count as numbers where nothing else does, then text where a row holds numbers
/// too. What `options` states is not searched. None where there is no row of numbers. Throws
/// datasets::InputError where separators of thousands make rows ambiguous.
std::optional<DialectFound> find_dialect(TextFile& file, const std::vector<std::string_view>& lines,
                                         std::size_t from, const ImportOptions& options);

}  // namespace impactrig::acquisition
