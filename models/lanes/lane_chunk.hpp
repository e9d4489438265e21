// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/lanes/lane_math.hpp"

namespace impactrig::models {
namespace {

/// N of a row's numbers, less at its end: of modes, stations or nodes. Lanes beyond are zero, as of
/// a mode that does not vibrate and is not struck, or a station of no length; they are not stored.
template <int N>
struct LaneChunk {
  using Real = typename LaneMath<N>::Real;

  int first, count;

  LaneChunk(int first_mode, int modes)
      : first(first_mode),
        count(modes - first_mode < N ? modes - first_mode : N) {}

  Real load(const double* values) const {
#ifdef __AVX512F__
    if constexpr (N == 8) return load_part(values + first);  // as fast as all of them
#endif
    return count == N ? LaneMath<N>::load(values + first) : load_part(values + first);
  }

  void store(Real lanes, double* values) const {
    if (count == N)
      LaneMath<N>::store(lanes, values + first);
    else
      store_part(lanes, values + first);
  }

  /// Into every `stride`-th place.
  void store(Real lanes, double* values, int stride) const {
    for (int i = 0; i < count; ++i) values[(first + i) * stride] = lanes[i];
  }

 private:
  Real load_part(const double* values) const {
#ifdef __AVX512F__
    if constexpr (N == 8) return _mm512_maskz_loadu_pd(part(), values);
#elif defined(__AVX2__)
    if constexpr (N == 4) return _mm256_maskload_pd(values, part());
#endif
    Real lanes = Real{};
    for (int i = 0; i < count; ++i) lanes[i] = values[i];
    return lanes;
  }

  void store_part(Real lanes, double* values) const {
#ifdef __AVX512F__
    if constexpr (N == 8) return _mm512_mask_storeu_pd(values, part(), lanes);
#elif defined(__AVX2__)
    if constexpr (N == 4) return _mm256_maskstore_pd(values, part(), lanes);
#endif
    for (int i = 0; i < count; ++i) values[i] = lanes[i];
  }

#ifdef __AVX512F__
  auto part() const {
    return static_cast<__mmask8>((1 << count) - 1);
  }
#elif defined(__AVX2__)
  auto part() const {
    return _mm256_cmpgt_epi64(_mm256_set1_epi64x(count), _mm256_set_epi64x(3, 2, 1, 0));
  }
#endif
};

/// The same where there are N of them.
template <int N>
struct WholeChunk {
  using Real = typename LaneMath<N>::Real;

  int first;

  Real load(const double* values) const { return LaneMath<N>::load(values + first); }

  void store(Real lanes, double* values) const { LaneMath<N>::store(lanes, values + first); }
};

/// Calls `action` for so many numbers, N at a time: without a question each time whether they are
/// N, which costs as much as the arithmetic where there is little of it.
template <int N, typename Action>
void by_chunks(int count, const Action& action) {
  int first = 0;
  for (; first + N <= count; first += N) action(WholeChunk<N>{first});
  if (first < count) action(LaneChunk<N>(first, count));
}

}  // namespace
}  // namespace impactrig::models
