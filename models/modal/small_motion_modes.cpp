// SPDX-License-Identifier: BSD-3-Clause
#include "models/modal/small_motion_modes.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <cmath>
#include <stdexcept>

namespace impactrig::models {

/// Jacobi's method for a nearly diagonal symmetric matrix, to the relative accuracy of each of its
/// entries; the rotations are gathered in the columns of `basis`. [GolubVanLoan2013, 8.5]
void diagonalise(Eigen::MatrixXd& matrix, Eigen::MatrixXd& basis) {
  const Eigen::Index n = matrix.rows();
  // both triangles are kept, so that all that is turned are columns
  const auto turn = [n](double* p, double* q, double c, double s) {
    for (Eigen::Index k = 0; k < n; ++k) {
      const double x = p[k], y = q[k];
      p[k] = c * x - s * y;
      q[k] = s * x + c * y;
    }
  };
  for (int sweep = 0; sweep < 30; ++sweep) {
    bool rotated = false;
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = i + 1; j < n; ++j) {
        const double mixed = matrix(i, j), first = matrix(i, i), second = matrix(j, j);
        if (mixed * mixed <= 1e-32 * std::abs(first * second)) continue;
        const double slope = 0.5 * (second - first) / mixed;
        const double t =
            std::copysign(1.0, slope) / (std::abs(slope) + std::sqrt(1.0 + slope * slope));
        const double c = 1.0 / std::sqrt(1.0 + t * t), s = t * c;
        turn(matrix.col(i).data(), matrix.col(j).data(), c, s);
        matrix.row(i) = matrix.col(i).transpose();
        matrix.row(j) = matrix.col(j).transpose();
        matrix(i, i) = first - t * mixed;
        matrix(j, j) = second + t * mixed;
        matrix(i, j) = matrix(j, i) = 0.0;
        turn(basis.col(i).data(), basis.col(j).data(), c, s);
        rotated = true;
      }
    if (!rotated) return;
  }
}

/// The rigid rotation is taken out first: its only stiffness is that of weight and spring, which a
/// rounding error of the highest modes' would drown. The bending modes among themselves are then
/// solved as they are, and what weight and spring couple them to the rotation by rotations of
/// pairs.
BarModes modes_by_matrices(const SmallMotion& motion) {
  constexpr Eigen::Index most = 700;  // the work grows with the cube of the number
  const Eigen::Index n = motion.rigid.size();
  if (n > most)
    throw std::runtime_error("two of the bar's modes are too close to be told apart in short time");
  const Eigen::LLT<Eigen::MatrixXd> mass(motion.mass);
  if (mass.info() != Eigen::Success)
    throw std::runtime_error("the bar's mass matrix is not positive definite");
  const auto scaled = [&](const Eigen::MatrixXd& matrix) {
    const Eigen::MatrixXd half = mass.matrixL().solve(matrix);
    return Eigen::MatrixXd(mass.matrixL().solve(half.transpose()));
  };
  Eigen::VectorXd rigid = mass.matrixU() * motion.rigid;
  rigid.normalize();
  const Eigen::HouseholderQR<Eigen::MatrixXd> reflection(rigid);
  const Eigen::MatrixXd reflector = reflection.householderQ() * Eigen::MatrixXd::Identity(n, n);
  const Eigen::MatrixXd elastic = reflector.transpose() * scaled(motion.stiffness) * reflector;
  const Eigen::MatrixXd weight = reflector.transpose() * scaled(motion.gravity) * reflector;
  const Eigen::VectorXd hinge = reflector.transpose() * mass.matrixL().solve(motion.hinge);
  const Eigen::MatrixXd restoring = weight + motion.spring * hinge * hinge.transpose();

  Eigen::MatrixXd basis = Eigen::MatrixXd::Identity(n, n);
  Eigen::MatrixXd coupled = Eigen::MatrixXd::Zero(n, n);
  coupled(0, 0) = restoring(0, 0);
  if (n > 1) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> bending(
        elastic.bottomRightCorner(n - 1, n - 1) + restoring.bottomRightCorner(n - 1, n - 1));
    if (bending.info() != Eigen::Success)
      throw std::runtime_error("the bar's modes could not be computed");
    basis.bottomRightCorner(n - 1, n - 1) = bending.eigenvectors();
    coupled.diagonal().tail(n - 1) = bending.eigenvalues();
    coupled.row(0).tail(n - 1) = restoring.row(0).tail(n - 1) * bending.eigenvectors();
    coupled.col(0).tail(n - 1) = coupled.row(0).tail(n - 1).transpose();
    diagonalise(coupled, basis);
  }
  const Eigen::MatrixXd shapes = mass.matrixU().solve(reflector * basis);
  BarModes modes{.squares = coupled.diagonal(),
                 .rows = shapes.transpose(),
                 .own = static_cast<int>(n),
                 .left_out = {},
                 .weight = basis.transpose() * weight * basis,
                 .hinge = basis.transpose() * hinge,
                 .rigid = {}};
  modes.rigid = modes.rows * (motion.mass * motion.rigid);
  return modes;
}

}  // namespace impactrig::models
