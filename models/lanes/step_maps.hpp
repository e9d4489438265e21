// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <type_traits>

#include "models/lanes/clenshaw.hpp"
#include "models/lanes/lane_chunk.hpp"
#include "models/lanes/mode_lanes.hpp"

namespace impactrig::models {
namespace {

/// find_at_nodes() for P times N of the rows, from one on.
template <int N, int P>
void find_rows(const PointAtNodes& point, int first) {
  using M = LaneMath<N>;
  using Real = typename M::Real;
  Real by_a[P] = {}, by_rate[P] = {};
  for (int k = 0; k < point.modes; ++k) {
    const double* const of_a = point.of_a + k * point.rows + first;
    const double* const of_rate = point.of_rate + k * point.rows + first;
    for (int p = 0; p < P; ++p) {
      by_a[p] += M::load(of_a + N * p) * point.a[k];
      by_rate[p] += M::load(of_rate + N * p) * point.rate[k];
    }
  }
  for (int p = 0; p < P; ++p) M::store(by_a[p] + by_rate[p], point.motion + first + N * p);
}

/// find_at_nodes() for N rows at a time where they are those of 8 nodes, or for four of those of 6.
template <int N>
void find_at_nodes_by(const PointAtNodes& point) {
  constexpr int narrow = N < 4 ? N : 4;
  if (point.rows == 16) return find_rows<N, 16 / N>(point, 0);
  if (point.rows == 12) return find_rows<narrow, 12 / narrow>(point, 0);
  for (int first = 0; first < point.rows; first += 2) find_rows<2, 1>(point, first);
}

/// find_values() for N nodes at a time, by Clenshaw's recurrence.
template <int N>
void find_values_by(const SeriesAtNodes& series) {
  using Real = typename LaneMath<N>::Real;
  by_chunks<N>(series.nodes, [&](const auto& chunk) {
    const Real t = 2.0 * (series.begin + series.length * chunk.load(series.points)) - 1.0;
    Real here = Real{}, above = Real{};
    for (int p = series.terms; p-- > 0;) {
      const Real below =
          series.series[p] + clenshaw.forward[p] * (t * here) - clenshaw.back[p] * above;
      above = here;
      here = below;
    }
    chunk.store(here, series.values);
  });
}

/// Of so many arrays, whose number the compiler may know.
template <int N>
void add_arrays(const WeightedSum& sum, auto terms) {
  using Real = typename LaneMath<N>::Real;
  by_chunks<N>(sum.count, [&](const auto& chunk) {
    Real here = sum.weights[0] * chunk.load(sum.arrays[0]);
    for (int j = 1; j < terms; ++j) here += sum.weights[j] * chunk.load(sum.arrays[j]);
    if (sum.factors) here *= chunk.load(sum.factors);
    chunk.store(here, sum.sum);
  });
}

/// find_sum() for N numbers at a time.
template <int N>
void find_sum_by(const WeightedSum& sum) {
  if (sum.terms != 4) return add_arrays<N>(sum, sum.terms);
  // where the compiler sees that nothing written changes them
  const double* const arrays[] = {sum.arrays[0], sum.arrays[1], sum.arrays[2], sum.arrays[3]};
  const double weights[] = {sum.weights[0], sum.weights[1], sum.weights[2], sum.weights[3]};
  WeightedSum four = sum;
  four.arrays = arrays;
  four.weights = weights;
  add_arrays<N>(four, std::integral_constant<int, 4>{});
}

/// find_at_end() for N modes at a time.
template <int N>
void find_at_end_by(const ModesAtEnd& modes) {
  using Real = typename LaneMath<N>::Real;
  by_chunks<N>(modes.modes, [&](const auto& chunk) {
    const Real a = chunk.load(modes.a), rate = chunk.load(modes.rate);
    Real end_a = chunk.load(modes.a_of_a) * a + chunk.load(modes.a_of_rate) * rate;
    Real end_rate = chunk.load(modes.rate_of_a) * a + chunk.load(modes.rate_of_rate) * rate;
    for (int i = 0; modes.force && i < modes.nodes; ++i) {
      end_a += chunk.load(modes.a_of_force + i * modes.modes) * modes.force[i];
      end_rate += chunk.load(modes.rate_of_force + i * modes.modes) * modes.force[i];
    }
    chunk.store(end_a, modes.end_a);
    chunk.store(end_rate, modes.end_rate);
  });
}

}  // namespace
}  // namespace impactrig::models
