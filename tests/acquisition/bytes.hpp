// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <initializer_list>
#include <string>
#include <vector>

namespace impactrig::acquisition::tests {

/// A number as it lies in a file.
template <typename Number>
std::string bytes_of_number(Number number, bool big_endian = false) {
  auto raw = std::bit_cast<std::array<char, sizeof(Number)>>(number);
  if (big_endian != (std::endian::native == std::endian::big)) std::reverse(raw.begin(), raw.end());
  return {raw.begin(), raw.end()};
}

template <typename Number>
std::string bytes_of_numbers(const std::vector<Number>& numbers, bool big_endian = false) {
  std::string bytes;
  for (const Number number : numbers) bytes += bytes_of_number(number, big_endian);
  return bytes;
}

}  // namespace impactrig::acquisition::tests
