// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

namespace impactrig::acquisition {

/// True for numbers of this size [bytes] that take_apart() knows.
constexpr bool can_take_apart(std::size_t width) {
  return width == 2 || width == 4 || width == 8;
}

/// Takes rows of numbers apart: the number of column c in row i goes from `from` + i stride + c
/// width to `to` + c column + i width. All of `columns` numbers of `rows` rows are there; `stride`
/// is columns times width.
void take_apart(const char* from, std::uint64_t rows, std::uint64_t columns, std::size_t width,
                char* to, std::uint64_t column);

}  // namespace impactrig::acquisition
