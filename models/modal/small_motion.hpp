// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace impactrig::models {

/// A bar on its hinge moving little about hanging straight, in coordinates q (n) of which only the
/// motion across the bar is kept: M q̈ + (K + G) q = −rᵀ F, where r q is the displacement of the
/// struck point, closing > 0, and F presses it back.
struct SmallMotion {
  Eigen::MatrixXd mass;       ///< M (n, n)
  Eigen::MatrixXd stiffness;  ///< K, elastic (n, n)
  Eigen::MatrixXd gravity;    ///< G, of the hanging weight (n, n)
  Eigen::VectorXd rigid;      ///< q of a rigid rotation by 1 rad, closing (n)
};

}  // namespace impactrig::models
