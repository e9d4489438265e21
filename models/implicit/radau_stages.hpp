// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Eigenvalues>
#include <cmath>
#include <complex>

#include "models/collocation/collocation.hpp"
#include "models/implicit/complex_lanes.hpp"

namespace impactrig::models {

/// The Radau IIA method of S stages, S even, taken apart so that S coupled real systems become S/2
/// complex ones that are not: A = T Λ T⁻¹, eigenvalues in conjugate pairs, one of each pair kept.
/// [HairerWanner1996, IV.8]
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
  RadauStages() : rule(Collocation::of(S, Collocation::Nodes::radau)) {
    to_velocity = rule.integration();
    to_displacement = to_velocity * to_velocity;
    const Eigen::EigenSolver<Square> solver(to_velocity);
    const Eigen::Matrix<std::complex<double>, S, S> t = solver.eigenvectors();
    const Eigen::Matrix<std::complex<double>, S, S> inverse = t.inverse();
    int pair = 0;
    for (int k = 0; k < S && pair < pairs; ++k) {
      if (!(solver.eigenvalues()[k].imag() > 0.0)) continue;
      eigenvalues[pair] = solver.eigenvalues()[k];
      into_re.row(pair) = inverse.row(k).real();
      into_im.row(pair) = inverse.row(k).imag();
      out_re.col(pair) = 2.0 * t.col(k).real();
      out_im.col(pair) = 2.0 * t.col(k).imag();
      ++pair;
    }
    into << into_re, into_im;
    out << out_re, -out_im;
  }
};

}  // namespace impactrig::models
