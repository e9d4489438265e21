// SPDX-License-Identifier: BSD-3-Clause
#include "models/implicit/radau_stages.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace impactrig::models {

template <int S>
RadauStages<S>::RadauStages() : rule(Collocation::of(S, Collocation::Nodes::radau)) {
  to_velocity = rule.integration();
  to_displacement = to_velocity * to_velocity;
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(to_velocity);
  const Eigen::MatrixXcd t = solver.eigenvectors();
  const Eigen::MatrixXcd inverse = t.inverse();
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

template struct RadauStages<4>;
template struct RadauStages<8>;

}  // namespace impactrig::models
