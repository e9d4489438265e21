// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <complex>

#include "models/collocation/collocation.hpp"

namespace impactrig::models {

/// The Radau IIA method of S stages, S = 4 or 8, taken apart so that S coupled real systems become
/// S/2 complex ones that are not: A = T Λ T⁻¹, eigenvalues in conjugate pairs, one of each pair
/// kept. [HairerWanner1996, IV.8]
template <int S>
struct RadauStages {
  static constexpr int pairs = S / 2;
  using Square = Eigen::Matrix<double, S, S>;
  using Lanes = Eigen::Array<double, S, 1>;

  const Collocation& rule;
  Square to_velocity;      // A
  Square to_displacement;  // A²
  Eigen::Array<std::complex<double>, pairs, 1> eigenvalues;
  Eigen::Matrix<double, pairs, S> into_re, into_im;  // rows of T⁻¹
  Eigen::Matrix<double, S, pairs> out_re, out_im;    // columns of T, twice: x = Re part of both
  Square into, out;  // [into_re; into_im] and [out_re, -out_im], of ComplexLanes

  static const RadauStages& get() {
    static const RadauStages stages;
    return stages;
  }

 private:
  RadauStages();
};

extern template struct RadauStages<4>;
extern template struct RadauStages<8>;

}  // namespace impactrig::models
