// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace impactrig::models {

/// Symmetric band matrix with three subdiagonals, what a chain of two-node elements with two
/// coordinates a node has. band(d, i) = entry (i + d, i), d = 0...3.
class BandMatrix {
 public:
  explicit BandMatrix(int size) : band_(Eigen::Matrix<double, 4, Eigen::Dynamic>::Zero(4, size)) {}

  int size() const { return static_cast<int>(band_.cols()); }

  double at(int row, int column) const {
    const int distance = row > column ? row - column : column - row;
    return distance > 3 ? 0.0 : band_(distance, row < column ? row : column);
  }

  /// Adds to entry (row, column) and its mirror image; |row − column| <= 3. To be called for row >=
  /// column only.
  void add(int row, int column, double value) { band_(row - column, column) += value; }

  /// this * x, x and the result (n).
  template <typename In, typename Out>
  void multiply(const In& x, Out&& y) const {
    const int n = size();
    for (int i = 0; i < n; ++i) y[i] = band_(0, i) * x[i];
    for (int d = 1; d <= 3; ++d)
      for (int i = 0; i + d < n; ++i) {
        y[i + d] += band_(d, i) * x[i];
        y[i] += band_(d, i) * x[i + d];
      }
  }

 private:
  Eigen::Matrix<double, 4, Eigen::Dynamic> band_;
};

/// L L' of a positive definite band matrix, factored once, solved in place in 14 n operations.
class BandCholesky {
 public:
  /// Throws std::invalid_argument when the matrix is not positive definite.
  explicit BandCholesky(const BandMatrix& matrix);

  template <typename Out>
  void solve_in_place(Out&& b) const {
    const int n = static_cast<int>(lower_.cols());
    for (int i = 0; i < n; ++i) {
      double sum = b[i];
      for (int d = 1; d <= 3 && d <= i; ++d) sum -= lower_(d, i - d) * b[i - d];
      b[i] = sum * lower_(0, i);
    }
    for (int i = n - 1; i >= 0; --i) {
      double sum = b[i];
      for (int d = 1; d <= 3 && i + d < n; ++d) sum -= lower_(d, i) * b[i + d];
      b[i] = sum * lower_(0, i);
    }
  }

 private:
  Eigen::Matrix<double, 4, Eigen::Dynamic> lower_;  // row 0 holds the inverse of the diagonal
};

}  // namespace impactrig::models
