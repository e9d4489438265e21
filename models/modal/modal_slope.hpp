// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "models/modal/small_motion.hpp"

namespace impactrig::models {

/// What a bar's modes are made of, or its derivatives by a parameter, while each part of the bar
/// bends as it does in its modes: what is in its way turns and moves with it, so that no stiff
/// element is asked to bend with the bar.
struct BarInModes {
  SmallMotion motion;       ///< the stiffness apart, which is that of the strains
  Eigen::MatrixXd shapes;   ///< SmallMotionBeam::shapes_of() the modes (n, m)
  Eigen::MatrixXd strains;  ///< SmallMotionBeam::strains() (.., m)
  ViscousDamping damping;
};

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
