// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "acquisition/conditioning/condition.hpp"
#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// What really happened at the rig, finely and uniformly sampled, before any sensor saw it (SI; compression and closing
/// motion positive). Whoever has a model makes one; this room does not know models.
struct Trajectory {
  double start = 0.0;                ///< of sample 0 [s]; first touch is at 0
  double interval = 0.0;             ///< [s], at least 10 times finer than the recording
  std::vector<double> force;         ///< [N] (n_samples)
  std::vector<double> velocity;      ///< [m/s] (n_samples), at the laser spot
  std::vector<double> displacement;  ///< [m] (n_samples), at the laser spot
};

/// What a digitiser and a laboratory do to a signal, apart from the sensor's own chain.
/// Values of reference: a good laboratory day.
struct Disturbances {
  double noise = 0.0;             ///< white, at the recorded sample rate [SI rms]
  double drift = 0.0;             ///< linear [SI/s]
  double hum = 0.0;               ///< 50 Hz amplitude plus 0.3 of it at 150 Hz, phase drawn [SI]
  double offset = 0.0;            ///< [SI]
  double gain_error = 0.0;        ///< relative; what the calibration got wrong
  double delay_error = 0.0;       ///< [s]; what the stated delay got wrong
  int bits = 0;                   ///< of the digitiser over +-range; 0 = not quantised (samples stay double)
  double range = 0.0;             ///< full scale [SI]; values beyond are clipped; 0 = none
  double dropouts_per_second = 0.0;  ///< laser only: pulls towards zero for 20 to 200 us
};

/// How the synthetic source records a trajectory.
struct SyntheticOptions {
  double sample_rate = 1e6;      ///< [Hz]
  double pre_trigger = 1e-3;     ///< recorded before first touch [s]
  double duration = 4e-3;        ///< recorded in all [s]
  double trigger_jitter = 0.5;   ///< uniform, in samples, both ways
  std::uint64_t seed = 1;
  Disturbances force, velocity, displacement;
};

/// Sends a trajectory through the complete measurement chain of `sensors` (datasets::Sensor, in the order stated there)
/// and the disturbances, and digitises it. Channels are written in the recorded unit of their sensor when it states a
/// sensitivity, else in SI. The same seed gives the same record, bit for bit.
datasets::Record synthesise(const Trajectory& trajectory, const SensorSet& sensors,
                            const SyntheticOptions& options);

}  // namespace impactrig::acquisition
