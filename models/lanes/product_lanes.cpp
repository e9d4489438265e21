// SPDX-License-Identifier: BSD-3-Clause
#include "models/lanes/product_lanes.hpp"

#include "models/lanes/processor.hpp"
#include "models/lanes/product_kernels.hpp"

namespace impactrig::models {
namespace {

MatrixProduct product(const Eigen::MatrixXd& a, const Eigen::Ref<const Eigen::MatrixXd>& x,
                      Eigen::Ref<Eigen::MatrixXd>& to) {
  eigen_assert(a.cols() == x.rows() && a.rows() == to.rows() && x.cols() == to.cols());
  return {.rows = static_cast<int>(a.rows()),
          .inner = static_cast<int>(a.cols()),
          .columns = static_cast<int>(x.cols()),
          .matrix = a.data(),
          .x = x.data(),
          .x_stride = x.outerStride(),
          .to = to.data(),
          .to_stride = to.outerStride()};
}

}  // namespace

void multiply(const MatrixProduct& product) {
  on_processor<const MatrixProduct>(product, multiply_by<2>, multiply_avx2, multiply_avx512);
}

double dot(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  eigen_assert(a.size() == b.size());
  ProductOfRows rows{.size = static_cast<int>(a.size()), .a = a.data(), .b = b.data()};
  on_processor(rows, find_dot_by<2>, find_dot_avx2, find_dot_avx512);
  return rows.sum;
}

void set_product(const Eigen::MatrixXd& a, const Eigen::Ref<const Eigen::MatrixXd>& x,
                 Eigen::Ref<Eigen::MatrixXd> to) {
  multiply(product(a, x, to));
}

void add_product(const Eigen::MatrixXd& a, const Eigen::Ref<const Eigen::MatrixXd>& x,
                 Eigen::Ref<Eigen::MatrixXd> to) {
  MatrixProduct sum = product(a, x, to);
  sum.adds = true;
  multiply(sum);
}

}  // namespace impactrig::models
