// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace impactrig::models {

/// What an elastic law says of a penetration.
struct ForceAndStiffness {
  double force = 0.0;      ///< [N]
  double stiffness = 0.0;  ///< df/dδ [N/m]
};

}  // namespace impactrig::models
