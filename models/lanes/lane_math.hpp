// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#ifdef __AVX2__
#include <immintrin.h>
#endif

#include <cstdint>
#include <type_traits>
#include <utility>

// Arithmetic on N doubles at once, for the files that are compiled once for each kind of processor:
// everything has internal linkage and stands on nothing else, so that no code for a newer processor
// ends in a function that an older one calls.
namespace impactrig::models {
namespace {

/// N lanes and what comparisons of them give: all bits of a lane set, or none.
template <int N>
struct LaneTypes {
  using Real [[gnu::vector_size(8 * N), gnu::may_alias]] = double;
  using Mask [[gnu::vector_size(8 * N)]] = std::int64_t;
  using Bits [[gnu::vector_size(8 * N)]] = std::uint64_t;
};

/// Calls `action` with 0, 1 ... below a number; below a constant without a loop.
template <typename Action>
void count_up(int number, const Action& action) {
  for (int i = 0; i < number; ++i) action(i);
}

template <int Number, typename Action>
void count_up(std::integral_constant<int, Number>, const Action& action) {
  [&]<int... I>(std::integer_sequence<int, I...>) {
    (action(I), ...);
  }
  (std::make_integer_sequence<int, Number>());
}

template <int N>
struct LaneMath {
  using Real = typename LaneTypes<N>::Real;
  using Mask = typename LaneTypes<N>::Mask;
  using Bits = typename LaneTypes<N>::Bits;

  static Real all(double value) { return Real{} + value; }

  static Real& at(double* lanes) { return *reinterpret_cast<Real*>(lanes); }

  static const Real& at(const double* lanes) { return *reinterpret_cast<const Real*>(lanes); }

  /// From or to any place.
  static Real load(const double* lanes) {
    Real x;
    __builtin_memcpy(&x, lanes, sizeof x);
    return x;
  }

  static void store(Real x, double* lanes) { __builtin_memcpy(lanes, &x, sizeof x); }

  static bool any(Mask mask) {
    if constexpr (N > 4) mask |= turned<4>(mask);
    if constexpr (N > 2) mask |= turned<2>(mask);
    return (mask[0] | mask[1]) != 0;
  }

  static Bits bits(Real x) { return reinterpret_cast<Bits>(x); }

  static Real real(Bits x) { return reinterpret_cast<Real>(x); }

  static Real magnitude(Real x) { return real(bits(x) & (~std::uint64_t{0} >> 1)); }

  /// The size of one with the sign of the other.
  static Real with_sign(Real size, Real sign) {
    const std::uint64_t top = std::uint64_t{1} << 63;
    return real((bits(size) & ~top) | (bits(sign) & top));
  }

  static Real larger(Real x, Real y) { return x > y ? x : y; }

  static Real smaller(Real x, Real y) { return x < y ? x : y; }

  static Real root(Real x) {
#ifdef __AVX512F__
    if constexpr (N == 8) return _mm512_maskz_sqrt_pd(0xff, x);
#endif
#ifdef __AVX2__
    if constexpr (N == 4) return _mm256_sqrt_pd(x);
#endif
    Real result = Real{};
    for (int i = 0; i < N; ++i) result[i] = __builtin_sqrt(x[i]);
    return result;
  }

  static double sum(Real x) {
    if constexpr (N > 4) x += turned<4>(x);
    if constexpr (N > 2) x += turned<2>(x);
    return x[0] + x[1];
  }

  static double largest(Real x) {
    if constexpr (N > 4) x = larger(x, turned<4>(x));
    if constexpr (N > 2) x = larger(x, turned<2>(x));
    return x[0] > x[1] ? x[0] : x[1];
  }

  /// Natural logarithm of normal numbers > 0, to an ulp: x = 2ᵏ m, √½ <= m < √2, ln m by the odd
  /// series in (m − 1) / (m + 1). Coefficients: FreeBSD's e_log.c (fdlibm, Sun 1993).
  static Real log(Real x) {
    const std::uint64_t half_root = 0x3fe6a09e667f3bcd;  // √½
    const std::uint64_t one = 0x3ff0000000000000;
    const Bits moved = bits(x) + (one - half_root);
    // 2⁵² + an integer below 2⁵² has the integer in its low bits
    const Real k = real((moved >> 52) | 0x4330000000000000) - (4503599627370496.0 + 1023.0);
    const Real f = real((moved & 0x000fffffffffffff) + half_root) - 1.0;
    const Real s = f / (2.0 + f);
    const Real z = s * s;
    const Real w = z * z;
    const Real odd = w * (3.999999999940941908e-01 +
                          w * (2.222219843214978396e-01 + w * 1.531383769920937332e-01));
    const Real even = z * (6.666666666666735130e-01 +
                           w * (2.857142874366239149e-01 +
                                w * (1.818357216161805012e-01 + w * 1.479819860511658591e-01)));
    const Real half_square = 0.5 * f * f;
    return k * 6.93147180369123816490e-01 -
           ((half_square - (s * (half_square + odd + even) + k * 1.90821492927058770002e-10)) - f);
  }

  /// Half as many numbers, twice.
  static Real twice(const double* numbers) {
    const typename LaneTypes<N / 2>::Real half = LaneMath<N / 2>::load(numbers);
#ifdef __AVX2__  // g++ 12 loads and permutes, which is slower
    if constexpr (N == 4) return _mm256_broadcast_pd(reinterpret_cast<const __m128d*>(&half));
#endif
    return [&]<int... I>(std::integer_sequence<int, I...>) {
      return __builtin_shufflevector(half, half, (I % (N / 2))...);
    }
    (std::make_integer_sequence<int, N>());
  }

  /// The lanes, those from a place on first.
  template <int First, typename Lanes>
  static Lanes turned(Lanes lanes) {
    return [&]<int... I>(std::integer_sequence<int, I...>) {
      return __builtin_shufflevector(lanes, lanes, ((I + First) % N)...);
    }
    (std::make_integer_sequence<int, N>());
  }

  struct SineCosine {
    Real sine, cosine;
  };

  /// To an ulp or so for |x| < 1e5: x less a multiple of π/2 in three parts, then polynomials of
  /// FreeBSD's k_sin.c and k_cos.c (fdlibm, Sun 1993).
  static SineCosine sine_cosine(Real x) {
    const double rounder = 6755399441055744.0;  // 1.5 · 2⁵²
    const Real moved = x * 0.63661977236758134308 + rounder;
    const Real turns = moved - rounder;
    const Real near = x - turns * 1.57079632673412561417e+00;
    const Real low = turns * 6.07710050650619224932e-11;
    const Real r = near - low;
    const Real rest = (near - r) - low;
    const Real z = r * r;
    const Real sine = r + (rest + z * r *
                                      (-1.66666666666666324348e-01 +
                                       z * (8.33333333332248946124e-03 +
                                            z * (-1.98412698298579493134e-04 +
                                                 z * (2.75573137070700676789e-06 +
                                                      z * (-2.50507602534068634195e-08 +
                                                           z * 1.58969099521155010221e-10))))));
    const Real half = 0.5 * z;
    const Real whole = 1.0 - half;
    const Real cosine = whole + (((1.0 - whole) - half) +
                                 (z * z *
                                      (4.16666666666666019037e-02 +
                                       z * (-1.38888888888741095749e-03 +
                                            z * (2.48015872894767294178e-05 +
                                                 z * (-2.75573143513906633035e-07 +
                                                      z * (2.08757232129817482790e-09 +
                                                           z * -1.13596475577881948265e-11))))) -
                                  r * rest));
    const Bits quadrant = bits(moved);
    const Mask odd = (quadrant & 1) != 0;
    const Real first = odd ? cosine : sine;
    const Real second = odd ? sine : cosine;
    return {real(bits(first) ^ ((quadrant & 2) << 62)),
            real(bits(second) ^ (((quadrant + 1) & 2) << 62))};
  }
};

}  // namespace
}  // namespace impactrig::models
