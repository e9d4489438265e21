// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/grouping_check.hpp"

#include <algorithm>

#include "acquisition/importers/number.hpp"

namespace impactrig::acquisition {

GroupingCheck::Says GroupingCheck::see(std::string_view number) {
  // of as many decimals rounded to three places one in ten has fewer
  constexpr long no_chance = 50;
  constexpr std::size_t few = 3, many = 12;  // different ones
  if (number.starts_with('-') || number.starts_with('+')) number.remove_prefix(1);
  const std::size_t mark = std::min(number.find(mark_), number.size());
  const std::string_view whole = number.substr(0, mark);
  const std::string_view behind = number.substr(std::min(mark + 1, number.size()));
  const auto are_digits = [](std::string_view text) {
    return std::ranges::all_of(text, detail::is_digit);
  };
  if (whole.empty() || whole.size() > 3 || !are_digits(whole)) return Says::decimals;
  if (mark == number.size()) {
    ++whole_;
  } else if (behind.size() != 3 || !are_digits(behind) || whole.front() == '0') {
    return Says::decimals;
  } else {
    ++with_mark_;
    ends_in_zero_ = ends_in_zero_ || behind.back() == '0';
    if (fractions_.size() < many) fractions_.emplace(behind);
  }
  const bool told = (ends_in_zero_ && fractions_.size() >= few) ||
                    (with_mark_ >= no_chance && fractions_.size() >= many);
  return whole_ > 0 && with_mark_ > 0 && told ? Says::thousands : Says::open;
}

}  // namespace impactrig::acquisition
