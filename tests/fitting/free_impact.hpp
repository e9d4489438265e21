// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "datasets/impact.hpp"
#include "fitting/rig_file.hpp"

namespace impactrig::tests {

/// A rigid mass against a spring with proportional damping, m δ̈ = −K δ^(3/2) (1 + μ δ̇): its
/// kinematic, kinetic and energetic restitution are one number. Hertz, e = 1/2 unless said
/// otherwise.
struct FreeImpact {
  double mass = 0.7;                      ///< m [kg]
  double speed = 0.441;                   ///< v₀ [m/s]
  double stiffness = 16368499363.978703;  ///< K [N/m^(3/2)]
  double damping = 3.248867422384069;     ///< μ [s/m]
};

/// How it is recorded.
struct FreeRecording {
  double force_noise = 0.0;     ///< [N]
  double velocity_noise = 0.0;  ///< [m/s]
  double correlation = 1.0;     ///< of the noise [samples]
  double velocity_late = 0.0;   ///< beyond the stated delay [s]
  double velocity_zero = 0.0;   ///< [m/s]
  double spot = 1.0;            ///< speed of the laser's spot over that of the struck point
  bool displacement = false;    ///< instead of the velocity
  std::uint64_t seed = 1;
};

/// Touch at 1 ms, sampled at 1 MHz from 0 to 2.2 ms through the rig's sensors; made without the
/// code under test.
datasets::Impact free_impact(const FreeImpact& impact, const FreeRecording& how,
                             const fitting::RigFile& rig);

}  // namespace impactrig::tests
