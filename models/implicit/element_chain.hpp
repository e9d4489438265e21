// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "models/implicit/complex_lanes.hpp"

namespace impactrig::models {

/// K complex symmetric systems m_j M + k_j S + c_j e e' at once, M and S real, sums of the matrices
/// of elements one after the other: each has `Own` coordinates of its own and shares the `Shared`
/// that follow with the next, e is one of the first element's. Factored L D L' element by element,
/// without pivoting, for which see BlockTridiagonal; solved in place. Cost linear in the elements.
template <int K, int Own, int Shared>
class ElementChain {
 public:
  static constexpr std::size_t own = Own, shared = Shared, front = own + shared;
  using Complex = ComplexLanes<K>;
  using Matrix = Eigen::Matrix<double, Own + Shared, Own + Shared>;

  explicit ElementChain(std::size_t elements) : pivots_(own * elements + shared) {}

  /// `first`: the coordinate e.
  void factor(const std::vector<Matrix>& mass, const std::vector<Matrix>& stiffness,
              std::size_t first, const SystemShares<K>& share) {
    Front a;
    for (std::size_t e = 0; e < mass.size(); ++e) {
      for (std::size_t r = 0; r < front; ++r)
        for (std::size_t c = r; c < front; ++c) {
          Complex entry = combined(mass[e](row(r), row(c)), stiffness[e](row(r), row(c)), share);
          if (e > 0 && c < shared) entry += a[own + r][own + c];
          a[r][c] = entry;
        }
      if (e == 0) a[first][first] += share.first_node;
      for (std::size_t j = 0; j < own; ++j) eliminate(a, j, pivots_[own * e + j]);
    }
    for (std::size_t j = own; j < front; ++j) eliminate(a, j, pivots_[own * mass.size() + j - own]);
  }

  void solve_in_place(std::vector<Complex>& x) const {
    const std::size_t last = pivots_.size() - shared;
    for (std::size_t i = 0; i < pivots_.size(); ++i)
      for (std::size_t r = 0; r < followers(i, last); ++r)
        x[i + 1 + r].subtract_product(pivots_[i].ratio[r], x[i]);
    for (std::size_t i = pivots_.size(); i-- > 0;) {
      Complex y = pivots_[i].inverse * x[i];
      for (std::size_t r = 0; r < followers(i, last); ++r)
        y.subtract_product(pivots_[i].ratio[r], x[i + 1 + r]);
      x[i] = y;
    }
  }

 private:
  using Front = std::array<std::array<Complex, front>, front>;  // the upper triangle is looked at

  /// Of D, and the entries of L below it.
  struct Pivot {
    Complex inverse;
    std::array<Complex, front - 1> ratio;
  };

  static Eigen::Index row(std::size_t i) { return static_cast<Eigen::Index>(i); }

  static Complex combined(double mass, double stiffness, const SystemShares<K>& share) {
    Complex entry;
    entry.re = mass * share.mass.re + stiffness * share.stiffness.re;
    entry.im = mass * share.mass.im + stiffness * share.stiffness.im;
    return entry;
  }

  static void eliminate(Front& a, std::size_t j, Pivot& pivot) {
    pivot.inverse = a[j][j].inverse();
    for (std::size_t r = j + 1; r < front; ++r) {
      const Complex ratio = a[j][r] * pivot.inverse;
      pivot.ratio[r - j - 1] = ratio;
      for (std::size_t c = r; c < front; ++c) a[r][c].subtract_product(ratio, a[j][c]);
    }
  }

  /// How many coordinates a pivot is coupled to behind it.
  static std::size_t followers(std::size_t i, std::size_t last) {
    return (i < last ? front - i % own : shared - (i - last)) - 1;
  }

  std::vector<Pivot> pivots_;
};

}  // namespace impactrig::models
