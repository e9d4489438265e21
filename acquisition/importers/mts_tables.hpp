// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace impactrig::acquisition {

/// One of several tables of other columns in a text that MTS 793 wrote.
struct MtsTable {
  std::size_t skipped_lines = 0;  ///< of the text, above its head
  std::string_view above;         ///< the first line of a table above it; empty: there is none
  const char* end = nullptr;      ///< where one below it begins; null: there is none
};

/// That of most rows, of those that begin within so many lines; the first behind `stated` lines
/// where the user says how many to skip. As it is where the text is not by MTS 793, or holds one
/// table. Heads that stand again above rows of the same columns begin no other.
MtsTable mts_table(std::string_view text, std::size_t lines, std::optional<std::size_t> stated);

}  // namespace impactrig::acquisition
