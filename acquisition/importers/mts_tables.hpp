// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string_view>

namespace impactrig::acquisition {

/// The table of most rows in a text that MTS 793 wrote, which may hold several of other columns.
struct MtsTable {
  std::size_t skipped_lines = 0;  ///< of the text, above its head
  std::string_view above;         ///< the first line of a table above it; empty: there is none
  const char* end = nullptr;      ///< where one below it begins; null: there is none
};

/// As it is where the text is not by MTS 793, or holds one table. Heads that stand again above rows
/// of the same columns begin no other.
MtsTable largest_mts_table(std::string_view text);

}  // namespace impactrig::acquisition
