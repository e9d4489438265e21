// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "models/modal/small_motion.hpp"

namespace impactrig::models {

/// Derivatives of a bar's modes by a parameter. Modes turn into each other as the bar changes; the
/// coordinates go with them, so that the moved bar is as uncoupled as the bar itself.
struct ModalSlope {
  Eigen::VectorXd omega;                 // (m)
  Eigen::VectorXd damping;               // (m)
  Eigen::VectorXd struck;                // (m)
  std::vector<Eigen::VectorXd> further;  // of the points before further stops (m)
  Eigen::VectorXd rigid;                 // (m)
  Eigen::VectorXd load;                  // (m)
  Eigen::MatrixXd shapes;                // (n, m)
};

}  // namespace impactrig::models
