// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <set>
#include <string>
#include <string_view>

namespace impactrig::acquisition {

/// Watches a column in which "1.153" may be 1153: beside whole numbers below 1000, all others have
/// three digits behind the mark. Decimals would have zeros left off, or, as the whole ones show
/// that they have, a zero at their end would be. A few different ones (thirds, levels) are
/// decimals.
class GroupingCheck {
 public:
  /// `mark`: that of decimals in this table.
  explicit GroupingCheck(char mark) : mark_(mark) {}

  enum class Says { open, decimals, thousands };

  /// Looks at the next number as it is written.
  Says see(std::string_view number);

 private:
  char mark_;
  long whole_ = 0;
  long with_mark_ = 0;
  bool ends_in_zero_ = false;
  std::set<std::string> fractions_;  ///< what stood behind the mark, of some
};

}  // namespace impactrig::acquisition
