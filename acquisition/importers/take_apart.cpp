// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/take_apart.hpp"

#include <cstring>
#include <utility>

namespace impactrig::acquisition {

namespace {

/// 16 bytes, in the registers that every processor of the architecture has.
template <typename Number>
struct VectorOf {
  typedef Number Type __attribute__((vector_size(16)));  // NOLINT(modernize-use-using)
};

template <typename Number>
using Vector = typename VectorOf<Number>::Type;

/// The first halves of two vectors, number by number in turn, and the second halves.
template <typename Number, std::size_t... i>
Vector<Number> first_halves(Vector<Number> a, Vector<Number> b, std::index_sequence<i...>) {
  return __builtin_shufflevector(a, b, (i % 2 == 0 ? i / 2 : i / 2 + sizeof...(i))...);
}

template <typename Number, std::size_t... i>
Vector<Number> second_halves(Vector<Number> a, Vector<Number> b, std::index_sequence<i...>) {
  constexpr std::size_t half = sizeof...(i) / 2;
  return __builtin_shufflevector(a, b, (half + (i % 2 == 0 ? i / 2 : i / 2 + sizeof...(i)))...);
}

/// A square of 16 bytes by as many rows as they have numbers: its rows become columns.
template <typename Number>
void take_square_apart(const char* from, std::uint64_t stride, char* to, std::uint64_t column) {
  constexpr std::size_t n = 16 / sizeof(Number);
  constexpr auto indices = std::make_index_sequence<n>();
  Vector<Number> rows[n];
  for (std::size_t i = 0; i < n; ++i) std::memcpy(&rows[i], from + i * stride, 16);
  for (std::size_t step = 1; step < n; step *= 2) {  // pairs of rows i and i + n / 2 in turn
    Vector<Number> next[n];
    for (std::size_t i = 0; i < n / 2; ++i) {
      next[2 * i] = first_halves<Number>(rows[i], rows[i + n / 2], indices);
      next[2 * i + 1] = second_halves<Number>(rows[i], rows[i + n / 2], indices);
    }
    for (std::size_t i = 0; i < n; ++i) rows[i] = next[i];
  }
  for (std::size_t i = 0; i < n; ++i) std::memcpy(to + i * column, &rows[i], 16);
}

/// Columns [first, last), one by one.
template <typename Number>
void take_columns(const char* from, std::uint64_t rows, std::uint64_t stride, std::uint64_t first,
                  std::uint64_t last, char* to, std::uint64_t column) {
  for (std::uint64_t c = first; c < last; ++c)
    for (std::uint64_t i = 0; i < rows; ++i)
      std::memcpy(to + c * column + i * sizeof(Number), from + i * stride + c * sizeof(Number),
                  sizeof(Number));
}

/// Two columns: shuffled often enough, what was in turn lies apart.
template <typename Number>
void take_pairs(const char* from, std::uint64_t rows, char* to, std::uint64_t column) {
  constexpr std::size_t n = 16 / sizeof(Number);
  constexpr auto indices = std::make_index_sequence<n>();
  const std::uint64_t whole = rows / n * n;
  for (std::uint64_t i = 0; i < whole; i += n) {
    Vector<Number> a;
    Vector<Number> b;
    std::memcpy(&a, from + 2 * i * sizeof(Number), 16);
    std::memcpy(&b, from + 2 * i * sizeof(Number) + 16, 16);
    for (std::size_t step = 1; step < n; step *= 2) {
      const Vector<Number> both = first_halves<Number>(a, b, indices);
      b = second_halves<Number>(a, b, indices);
      a = both;
    }
    std::memcpy(to + i * sizeof(Number), &a, 16);
    std::memcpy(to + column + i * sizeof(Number), &b, 16);
  }
  take_columns<Number>(from + 2 * whole * sizeof(Number), rows - whole, 2 * sizeof(Number), 0, 2,
                       to + whole * sizeof(Number), column);
}

template <typename Number>
void take_apart(const char* from, std::uint64_t rows, std::uint64_t columns, char* to,
                std::uint64_t column) {
  constexpr std::uint64_t n = 16 / sizeof(Number);
  const std::uint64_t stride = columns * sizeof(Number);
  if (columns == 2) return take_pairs<Number>(from, rows, to, column);
  const std::uint64_t squares = columns / n * n;
  const std::uint64_t whole = rows / n * n;
  for (std::uint64_t i = 0; i < whole; i += n)
    for (std::uint64_t c = 0; c < squares; c += n)
      take_square_apart<Number>(from + i * stride + c * sizeof(Number), stride,
                                to + c * column + i * sizeof(Number), column);
  take_columns<Number>(from + whole * stride, rows - whole, stride, 0, squares,
                       to + whole * sizeof(Number), column);
  take_columns<Number>(from, rows, stride, squares, columns, to, column);
}

}  // namespace

void take_apart(const char* from, std::uint64_t rows, std::uint64_t columns, std::size_t width,
                char* to, std::uint64_t column) {
  if (width == 2) return take_apart<std::uint16_t>(from, rows, columns, to, column);
  if (width == 4) return take_apart<std::uint32_t>(from, rows, columns, to, column);
  take_apart<std::uint64_t>(from, rows, columns, to, column);
}

}  // namespace impactrig::acquisition
