// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>

namespace impactrig::acquisition {

/// A number of 58b, whose bytes lie as the identifier line says.
template <typename Number>
Number read_uff58_number(const char* bytes, bool little_endian) {
  std::array<char, sizeof(Number)> raw;
  std::memcpy(raw.data(), bytes, raw.size());
  if (little_endian != (std::endian::native == std::endian::little))
    std::reverse(raw.begin(), raw.end());
  return std::bit_cast<Number>(raw);
}

}  // namespace impactrig::acquisition
