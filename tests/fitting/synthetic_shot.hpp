// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "datasets/impact.hpp"
#include "fitting/rig_file.hpp"
#include "models/simulation.hpp"

namespace impactrig::tests {

/// The rig of Shen et al. with its measuring chain.
extern const char* const paper_rig;

/// What a recording of that rig would be.
struct ShotTruth {
  double restitution = 0.5;
  double stiffness_factor = 1.0;
  double velocity = 0.441;       ///< [m/s]
  double force_noise = 2.0;      ///< [N]
  double velocity_noise = 1e-3;  ///< [m/s]
  double force_offset = 0.0;     ///< [N]
  double force_delay = 0.0;      ///< what the stated delay got wrong [s]
  double velocity_delay = 0.0;   ///< [s]
  double force_hum = 0.0;        ///< 50 Hz amplitude, 0.3 of it at 150 Hz, phases drawn [N]
  double velocity_hum = 0.0;     ///< [m/s]
  double noise_memory = 0.0;  ///< φ of noise x_t = φ x_{t−1} + e_t, its deviation unchanged [-]
  double step = 0.0;          ///< of the digitiser, in parts of each channel's noise
  double duration = 3.2e-3;   ///< recorded after first touch [s]
  double fine = 1e-7;         ///< of the history that the sensors see [s]
  double interval = 1e-6;     ///< of the recording [s]
  double found_late = 3e-6;   ///< first touch: detection is never exact [s]
  models::Motion motion = models::Motion::by_accuracy;
  std::uint64_t seed = 1;
};

/// The true instant of first touch in every shot.
inline constexpr double true_touch = 0.00123;  ///< [s]

/// An impact as detection would hand it on, made without the code under test: its own sampling and
/// noise.
datasets::Impact synthetic_shot(const fitting::RigFile& rig, const ShotTruth& truth);

}  // namespace impactrig::tests
