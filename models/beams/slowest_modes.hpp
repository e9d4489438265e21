// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "models/beams/linear_bar.hpp"

namespace impactrig::models {

/// Modes of a bar, slow ones first.
struct SlowestModes {
  Eigen::VectorXd omega;   ///< [rad/s] (n); 0 for a rotation that nothing resists
  Eigen::MatrixXd shapes;  ///< of unit modal mass, in the coordinates that are free (size, n)
};

/// The slowest `count` modes, of mass and elastic stiffness alone, of a bar whose first `held`
/// coordinates (0 or 1) are held at zero; with none held the first is its rotation about the hinge.
/// By Lanczos' method on (K + s M)^-1 M [EricssonRuhe1980], in time that grows with the bar's
/// elements and with the square of `count`. s is between the squares of the slowest and the fastest
/// frequency, so that rounding leaves about the same number of digits to both. Throws
/// std::runtime_error when it does not converge.
SlowestModes slowest_modes(const LinearBar& bar, int held, int count);

}  // namespace impactrig::models
