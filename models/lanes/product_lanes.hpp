// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace impactrig::models {

/// A matrix by few columns, A x, all by columns: those of A lie beside one another, those of x and
/// of the result as far apart as is said.
struct MatrixProduct {
  int rows = 0, inner = 0, columns = 0;
  const double* matrix = nullptr;  ///< A (rows, inner)
  const double* x = nullptr;       ///< (inner, columns)
  long x_stride = 0;
  double* to = nullptr;  ///< (rows, columns)
  long to_stride = 0;
  bool adds = false;  ///< to what is there
};

/// By what the processor has.
void multiply(const MatrixProduct& product);

/// Two rows of numbers and the sum of their products.
struct ProductOfRows {
  int size = 0;
  const double* a = nullptr;
  const double* b = nullptr;
  double sum = 0.0;
};

/// a · b, of rows of hundreds of numbers; they are as long as one another.
double dot(const Eigen::VectorXd& a, const Eigen::VectorXd& b);

/// to = A x.
void set_product(const Eigen::MatrixXd& a, const Eigen::Ref<const Eigen::MatrixXd>& x,
                 Eigen::Ref<Eigen::MatrixXd> to);

/// to += A x.
void add_product(const Eigen::MatrixXd& a, const Eigen::Ref<const Eigen::MatrixXd>& x,
                 Eigen::Ref<Eigen::MatrixXd> to);

}  // namespace impactrig::models
