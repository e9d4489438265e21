// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "models/modal/small_motion.hpp"

namespace impactrig::models {

/// All modes of a small motion, from its matrices. Throws std::runtime_error where the mass matrix
/// is not positive definite, or the work, which grows with the cube of the coordinates' number,
/// would take too long.
BarModes modes_by_matrices(const SmallMotion& motion);

/// Jacobi's method for a nearly diagonal symmetric matrix (n, n), to the relative accuracy of each
/// of its entries; the rotations are gathered in the columns of `basis` (n, n).
/// [GolubVanLoan2013, 8.5]
void diagonalise(Eigen::MatrixXd& matrix, Eigen::MatrixXd& basis);

}  // namespace impactrig::models
