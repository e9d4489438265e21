// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <type_traits>

#include "models/lanes/lane_math.hpp"

namespace impactrig::models {
namespace {

/// Spherical Bessel functions j_0(z) ... of N numbers z >= 0, of the first kind. Absolute error a
/// few units of rounding. Source: [DLMF2010], 10.51 and 10.60.12.
template <int N, int Most>
class LaneBessel {
 public:
  using M = LaneMath<N>;
  using Real = typename M::Real;
  using Mask = typename M::Mask;

  /// How many of them are above rounding for every z.
  static int needed(Real z) {
    const double largest = M::largest(z);
    return static_cast<int>(largest + 16.0 + 6.0 * __builtin_cbrt(largest));
  }

  /// Miller's backward recurrence; sine and cosine are those of z. The number of terms may be a
  /// constant.
  void evaluate(Real z, Real sine, Real cosine, auto terms) {
    if constexpr (std::is_same_v<decltype(terms), int>)
      if (terms < 2) terms = 2;  // the sign may be the second's to tell
    const Real used = M::larger(z, M::all(small));
    const int n = begin_at(z, terms);
    const Real squares = n <= safe ? recur_freely(used, n, terms) : recur(used, n, terms);
    scale(z, used, sine, cosine, squares, terms);
  }

  Real operator[](int n) const { return values_[n]; }

 private:
  // below, two terms of the power series of j_n are as good as all
  static constexpr double small = 1e-3;
  static constexpr double tiny = 1e-60;  // where the recurrence begins
  // From here it multiplies by (2n + 1)!! / small^n = 1e184 at most: squares can hold that.
  static constexpr int safe = 40;

  /// From order n on; tells Σ (2n + 1) j_n².
  Real recur_freely(Real used, int n, auto terms) {
    const Real inverse = 1.0 / used;
    Real above = Real{}, here = M::all(tiny), squares = Real{};
    const auto go_down = [&](double weight) {
      squares += weight * here * here;
      const Real below = weight * inverse * here - above;
      above = here;
      here = below;
    };
    for (; n >= terms; --n) go_down(2.0 * n + 1.0);
    count_up(terms, [&](int i) {
      const int k = terms - 1 - i;
      values_[k] = here;
      go_down(2.0 * k + 1.0);
    });
    return squares;
  }

  /// The same from where numbers may grow beyond what can be held.
  Real recur(Real used, int n, int terms) {
    const Real inverse = 1.0 / used;
    Real above = Real{}, here = M::all(tiny), squares = Real{};
    while (n >= 0) {
      // four steps multiply by (2n / z)⁴ at most: far from what squares can hold
      for (const int last = n > 3 ? n - 4 : -1; n > last; --n) {
        const double weight = 2.0 * n + 1.0;
        squares += weight * here * here;
        if (n < terms) values_[n] = here;
        const Real below = weight * inverse * here - above;
        above = here;
        here = below;
      }
      const Mask large = M::magnitude(here) > 1e40;
      if (n < 0 || !M::any(large)) continue;
      const Real down = large ? M::all(tiny) : M::all(1.0);
      here *= down;
      above *= down;
      squares *= down * down;
      for (int k = n + 1; k < terms; ++k) values_[k] *= down;
    }
    return squares;
  }

  /// The order at which the recurrence begins. That it begins there with j_{n+1} = 0 changes a
  /// j_k by (j_n / j_k)² of it, and the sum of squares by j_n²: below rounding where j_n < 1e-9,
  /// as j_10(1) and j_14(3) are.
  static int begin_at(Real z, int terms) {
    const double largest = M::largest(z);
    const int enough = largest <= 1.0 ? 10
                       : largest <= 3.0
                           ? 14
                           : static_cast<int>(largest + 12.0 + 7.0 * __builtin_cbrt(largest));
    return enough > terms + 4 ? enough : terms + 4;
  }

  /// Σ (2n + 1) j_n² = 1, the sign from whichever of the first two is larger.
  void scale(Real z, Real used, Real sine, Real cosine, Real squares, auto terms) {
    const Real first = sine / used;
    const Real second = (first - cosine) / used;
    const Mask from_first = M::magnitude(first) >= M::magnitude(second);
    const Real factor =
        M::with_sign(1.0 / M::root(squares), from_first ? values_[0] * first : values_[1] * second);
    const Mask near = z < small;
    count_up(terms, [&](int n) { values_[n] *= factor; });
    if (!M::any(near)) return;
    Real leading = M::all(1.0);  // zⁿ / (2n + 1)!!
    const Real square = z * z;
    count_up(terms, [&](int n) {
      const Real second_term = square * (0.5 / (2.0 * n + 3.0));
      const Real third_part = square * (0.25 / (2.0 * n + 5.0));
      values_[n] = near ? leading * (1.0 - second_term * (1.0 - third_part)) : values_[n];
      leading *= z * (1.0 / (2.0 * n + 3.0));
    });
  }

  Real values_[Most];
};

}  // namespace
}  // namespace impactrig::models
