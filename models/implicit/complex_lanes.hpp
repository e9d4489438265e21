// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace impactrig::models {

/// K complex numbers side by side, one for each of the systems a Radau step falls into; real and
/// imaginary parts apart so that the compiler takes them by vectors.
template <int K>
struct ComplexLanes {
  using Real = Eigen::Array<double, K, 1>;
  Real re = Real::Zero(), im = Real::Zero();

  /// All 2 K of them, those of others behind them in an array.
  double* numbers() {
    static_assert(sizeof(ComplexLanes) == 2 * K * sizeof(double));
    return re.data();
  }

  const double* numbers() const { return re.data(); }

  ComplexLanes& operator+=(const ComplexLanes& b) {
    re += b.re;
    im += b.im;
    return *this;
  }

  ComplexLanes& operator-=(const ComplexLanes& b) {
    re -= b.re;
    im -= b.im;
    return *this;
  }

  /// this −= a b
  void subtract_product(const ComplexLanes& a, const ComplexLanes& b) {
    re -= a.re * b.re - a.im * b.im;
    im -= a.re * b.im + a.im * b.re;
  }

  friend ComplexLanes operator*(const ComplexLanes& a, const ComplexLanes& b) {
    ComplexLanes c;
    c.re = a.re * b.re - a.im * b.im;
    c.im = a.re * b.im + a.im * b.re;
    return c;
  }

  friend ComplexLanes operator+(ComplexLanes a, const ComplexLanes& b) { return a += b; }

  friend ComplexLanes operator-(ComplexLanes a, const ComplexLanes& b) { return a -= b; }

  ComplexLanes operator-() const {
    ComplexLanes c;
    c.re = -re;
    c.im = -im;
    return c;
  }

  ComplexLanes inverse() const {
    const Real square = (re.square() + im.square()).inverse();
    ComplexLanes c;
    c.re = re * square;
    c.im = -im * square;
    return c;
  }
};

/// Shares of mass, stiffness and the hinge's derivatives in K linear systems: m, k, c.
template <int K>
struct SystemShares {
  ComplexLanes<K> mass, stiffness, first_node;
};

}  // namespace impactrig::models
