// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <type_traits>

#include "models/lanes/lane_chunk.hpp"
#include "models/lanes/product_lanes.hpp"

namespace impactrig::models {
namespace {

/// multiply() for N rows at a time.
template <int N>
class LaneProduct {
 public:
  explicit LaneProduct(const MatrixProduct& product) : product_(product) {}

  void multiply() const {
    int column = 0;
    for (; column + 4 <= product_.columns; column += 4) multiply_columns<4>(column);
    for (; column < product_.columns; ++column) multiply_columns<1>(column);
  }

 private:
  using M = LaneMath<N>;
  using Real = typename M::Real;

  template <int Columns>
  void multiply_columns(int column) const {
    int row = 0;
    if constexpr (Columns == 1)
      for (; row + 4 * N <= product_.rows; row += 4 * N)
        multiply_rows<1>(column, {WholeChunk<N>{row}, WholeChunk<N>{row + N},
                                  WholeChunk<N>{row + 2 * N}, WholeChunk<N>{row + 3 * N}});
    for (; row + 2 * N <= product_.rows; row += 2 * N)
      multiply_rows<Columns>(column, {WholeChunk<N>{row}, WholeChunk<N>{row + N}});
    for (; row + N <= product_.rows; row += N) multiply_rows<Columns>(column, {WholeChunk<N>{row}});
    if (row < product_.rows) multiply_rows<Columns>(column, {LaneChunk<N>(row, product_.rows)});
  }

  /// Sums of so many registers of rows and so many columns: enough of them that each multiplication
  /// need not wait for the one before, none in memory.
  template <int Columns, typename Chunk, int Registers>
  void multiply_rows(int column, const Chunk (&rows)[Registers]) const {
    constexpr std::integral_constant<int, Registers> registers;
    constexpr std::integral_constant<int, Columns> columns;
    const double* const x = product_.x + column * product_.x_stride;
    double* const to = product_.to + column * product_.to_stride;
    const long stride = product_.x_stride;
    Real sum[Registers][Columns];
    count_up(registers, [&](int r) {
      count_up(columns, [&](int c) {
        sum[r][c] = product_.adds ? rows[r].load(to + c * product_.to_stride) : Real{};
      });
    });
    for (int k = 0; k < product_.inner; ++k) {
      const double* const from = product_.matrix + static_cast<long>(k) * product_.rows;
      count_up(registers, [&](int r) {
        const Real a = rows[r].load(from);
        count_up(columns, [&](int c) { sum[r][c] += a * x[c * stride + k]; });
      });
    }
    count_up(registers, [&](int r) {
      count_up(columns, [&](int c) { rows[r].store(sum[r][c], to + c * product_.to_stride); });
    });
  }

  const MatrixProduct& product_;
};

template <int N>
void multiply_by(const MatrixProduct& product) {
  LaneProduct<N>(product).multiply();
}

/// dot() of N numbers at a time, in four sums that need not wait for one another.
template <int N>
void find_dot_by(ProductOfRows& rows) {
  using M = LaneMath<N>;
  constexpr std::integral_constant<int, 4> sums;
  typename M::Real sum[4] = {};
  int i = 0;
  for (; i + 4 * N <= rows.size; i += 4 * N)
    count_up(sums,
             [&](int s) { sum[s] += M::load(rows.a + i + s * N) * M::load(rows.b + i + s * N); });
  for (; i + N <= rows.size; i += N) sum[0] += M::load(rows.a + i) * M::load(rows.b + i);
  if (i < rows.size) {
    const LaneChunk<N> rest(i, rows.size);
    sum[1] += rest.load(rows.a) * rest.load(rows.b);
  }
  const typename M::Real all = (sum[0] + sum[1]) + (sum[2] + sum[3]);
  double total = 0.0;
  for (int lane = 0; lane < N; ++lane) total += all[lane];
  rows.sum = total;
}

}  // namespace
}  // namespace impactrig::models
