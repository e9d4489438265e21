// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "models/implicit/complex_lanes.hpp"
#include "models/lanes/stage_lanes.hpp"

namespace impactrig::models {

/// A chain of nodes with four coordinates each: real symmetric matrix, its blocks on the diagonal
/// and those that couple a node (rows) to the next (columns).
struct ChainMatrix {
  std::vector<Eigen::Matrix4d> diagonal;  // (nodes)
  std::vector<Eigen::Matrix4d> next;      // (nodes − 1)

  explicit ChainMatrix(std::size_t nodes)
      : diagonal(nodes, Eigen::Matrix4d::Zero()),
        next(nodes - 1, Eigen::Matrix4d::Zero()) {}

  void set_zero() {
    for (Eigen::Matrix4d& block : diagonal) block.setZero();
    for (Eigen::Matrix4d& block : next) block.setZero();
  }
};

/// K complex symmetric systems m_j M + k_j S + c_j B at once, M and S chain matrices, M positive
/// definite, S nearly so, B a block of the first node, k_j / m_j off the negative real axis.
/// Factored block by block without pivoting, which that allows; solved in place. Cost linear in the
/// nodes.
template <int K>
class BlockTridiagonal {
 public:
  using Complex = ComplexLanes<K>;

  explicit BlockTridiagonal(std::size_t nodes) : inverse_(nodes), lower_(nodes) {}

  using Shares = SystemShares<K>;

  void factor(const ChainMatrix& mass, const ChainMatrix& stiffness,
              const Eigen::Matrix4d& first_node, const Shares& share) {
    const std::size_t n = inverse_.size();
    for (std::size_t i = 0; i < n; ++i) {
      Block pivot = combine(mass.diagonal[i], stiffness.diagonal[i], share);
      if (i == 0) add(first_node, share.first_node, pivot);
      if (i > 0) {
        const Block coupling = combine(mass.next[i - 1], stiffness.next[i - 1], share);
        // G = C' D⁻¹, D ← D − G C; symmetric
        Block& g = lower_[i];
        for (std::size_t r = 0; r < 4; ++r)
          for (std::size_t c = 0; c < 4; ++c) {
            Complex sum = coupling[0][r] * inverse_[i - 1][0][c];
            for (std::size_t k = 1; k < 4; ++k) sum += coupling[k][r] * inverse_[i - 1][k][c];
            g[r][c] = sum;
          }
        for (std::size_t r = 0; r < 4; ++r)
          for (std::size_t c = r; c < 4; ++c)
            for (std::size_t k = 0; k < 4; ++k)
              pivot[r][c].subtract_product(g[r][k], coupling[k][c]);
      }
      invert(pivot, inverse_[i]);
    }
  }

  /// x: four values a node (4 nodes).
  void solve_in_place(std::vector<Complex>& x) const {
    solve_chain({.stages = 2 * K,
                 .nodes = static_cast<int>(inverse_.size()),
                 .inverse = inverse_[0][0][0].numbers(),
                 .lower = lower_[0][0][0].numbers(),
                 .x = x[0].numbers()});
  }

 private:
  using Block = std::array<std::array<Complex, 4>, 4>;
  using Half = std::array<std::array<Complex, 2>, 2>;

  static Block combine(const Eigen::Matrix4d& mass, const Eigen::Matrix4d& stiffness,
                       const Shares& share) {
    Block block;
    for (std::size_t r = 0; r < 4; ++r)
      for (std::size_t c = 0; c < 4; ++c) {
        const auto row = static_cast<Eigen::Index>(r);
        const auto column = static_cast<Eigen::Index>(c);
        block[r][c].re =
            mass(row, column) * share.mass.re + stiffness(row, column) * share.stiffness.re;
        block[r][c].im =
            mass(row, column) * share.mass.im + stiffness(row, column) * share.stiffness.im;
      }
    return block;
  }

  static void add(const Eigen::Matrix4d& matrix, const Complex& share, Block& block) {
    for (std::size_t r = 0; r < 4; ++r)
      for (std::size_t c = 0; c < 4; ++c) {
        const double entry = matrix(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c));
        block[r][c].re += entry * share.re;
        block[r][c].im += entry * share.im;
      }
  }

  /// Of a symmetric matrix [a b; b c].
  static Half invert_half(const Complex& a, const Complex& b, const Complex& c) {
    const Complex determinant = (a * c - b * b).inverse();
    const Complex off = -(b * determinant);
    return {{{c * determinant, off}, {off, a * determinant}}};
  }

  /// By halves, [P Q; Q' R]: the upper triangle of `a` is looked at.
  static void invert(const Block& a, Block& out) {
    const Half p = invert_half(a[0][0], a[0][1], a[1][1]);
    Half pq;  // P⁻¹ Q
    for (std::size_t r = 0; r < 2; ++r)
      for (std::size_t c = 0; c < 2; ++c) pq[r][c] = p[r][0] * a[0][2 + c] + p[r][1] * a[1][2 + c];
    const auto complement = [&](std::size_t r, std::size_t c) {
      Complex s = a[2 + r][2 + c];
      s.subtract_product(a[0][2 + r], pq[0][c]);
      s.subtract_product(a[1][2 + r], pq[1][c]);
      return s;
    };
    const Half s = invert_half(complement(0, 0), complement(0, 1), complement(1, 1));
    Half corner;  // −P⁻¹ Q S⁻¹
    for (std::size_t r = 0; r < 2; ++r)
      for (std::size_t c = 0; c < 2; ++c) corner[r][c] = -(pq[r][0] * s[0][c] + pq[r][1] * s[1][c]);
    for (std::size_t r = 0; r < 2; ++r)
      for (std::size_t c = 0; c < 2; ++c) {
        out[2 + r][2 + c] = s[r][c];
        out[r][2 + c] = out[2 + c][r] = corner[r][c];
        out[r][c] = p[r][c];
        out[r][c].subtract_product(corner[r][0], pq[c][0]);
        out[r][c].subtract_product(corner[r][1], pq[c][1]);
      }
  }

  std::vector<Block> inverse_;  // of the pivots
  std::vector<Block> lower_;
};

}  // namespace impactrig::models
