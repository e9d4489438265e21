// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "acquisition/conditioning/condition.hpp"
#include "acquisition/source.hpp"
#include "datasets/record.hpp"
#include "datasets/sampled_curve.hpp"

namespace impactrig::acquisition {

/// What really happened at the rig, finely and uniformly sampled, before any sensor saw it (SI;
/// compression and closing motion positive). Whoever has a model makes one; this room does not know
/// models. Histories no sensor looks at may be empty.
struct Trajectory {
  double start = 0.0;                ///< of sample 0 [s]; first touch is at 0
  double interval = 0.0;             ///< [s], at least 10 times finer than the recording
  std::vector<double> force;         ///< [N] (n_samples)
  std::vector<double> velocity;      ///< [m/s] (n_samples), at the laser spot
  std::vector<double> displacement;  ///< [m] (n_samples), at the laser spot
  std::vector<datasets::CurveJump> force_jumps = {};
  /// What lines between the samples of the force miss [N s].
  std::vector<datasets::CurveSpike> force_spikes = {};
};

/// What a digitiser and a laboratory do to a signal, apart from the sensor's own chain, in this
/// order.
struct Disturbances {
  double delay_error = 0.0;          ///< what the stated delay got wrong [s]
  double gain_error = 0.0;           ///< relative; what the calibration got wrong
  double noise = 0.0;                ///< white, at the recorded sample rate [SI rms]
  double low_frequency_noise = 0.0;  ///< 1/f from 10 Hz to 1 kHz (speckle) [SI rms]
  double drift = 0.0;                ///< linear [SI/s]
  double hum = 0.0;     ///< 50 Hz amplitude plus 0.3 of it at 150 Hz, phases drawn [SI]
  double offset = 0.0;  ///< [SI]
  double step = 0.0;    ///< ground-loop step at first touch [SI]
  double dropouts_per_second = 0.0;  ///< laser only: pulls towards zero for 20 to 200 us
  bool dropout_in_contact = false;   ///< one more, within 50 us after first touch
  double range = 0.0;                ///< full scale [SI]; values beyond are clipped; 0 = none
  int bits = 0;  ///< of the digitiser over ±range; 0 = not quantised (samples stay double)
};

/// How the synthetic source records a trajectory.
struct SyntheticOptions {
  double sample_rate = 1e6;     ///< [Hz]
  double pre_trigger = 1e-3;    ///< recorded before first touch [s]
  double duration = 4e-3;       ///< recorded in all [s]
  double trigger_jitter = 0.5;  ///< uniform, in samples, both ways
  std::uint64_t seed = 1;
  Disturbances force{}, velocity{}, displacement{};
};

/// Sends a trajectory through the complete measurement chain of `sensors` (datasets::Sensor, in the
/// order stated there) and the disturbances, and digitises it. Channels are written in the recorded
/// unit of their sensor when it states a sensitivity, else in SI, under the sensor's channel name,
/// else "Force", "Velocity", "Displacement"; a sensor whose channel is an index is sorted to it.
/// The same seed gives the same record, bit for bit (with the same C library: log, sin and cos).
///
/// Before its start the trajectory is taken as free flight: force and velocity constant,
/// displacement going on at the first velocity. Between its samples it is interpolated by cubics.
/// Noise is white at the recorded rate, as if it arose in the digitiser.
///
/// A dropout pulls the velocity to 2 % of itself with five times its noise, with a spike at either
/// edge; a displacement stands still meanwhile and keeps the lost counts as an offset. It is not
/// marked invalid, as in reality.
///
/// What was drawn and applied is in Record::attributes under "truth.": "truth.seed",
/// "truth.first_touch" [s, on the record's clock, without delays], "truth.dropouts" (a JSON list of
/// [from, to] on the record's clock, s), and for each quantity "truth.force.delay" [s], ".gain",
/// ".noise" and so on [SI].
///
/// Throws std::invalid_argument when a history is missing or does not last as long as the
/// recording, the trajectory is not 10 times finer, or bits are asked for without a range.
datasets::Record synthesise(const Trajectory& trajectory, const SensorSet& sensors,
                            const SyntheticOptions& options);

/// The largest magnitudes of a trajectory [SI] as its sensors show them, before any disturbance: a
/// resonance may double them. Its own where there is no such sensor, 0 where there is no history.
struct ShownPeaks {
  double force = 0.0, velocity = 0.0;
};

ShownPeaks shown_peaks(const Trajectory& trajectory, const SensorSet& sensors);

/// A good laboratory day: charge amplifier and decoder noise, drift, mains, digitiser of 12 bits
/// (10.5 effective) with its range a step of 1-2-5 above the peak that is shown, in the recorded
/// unit; the fixed delays are those of the sensors. Values: measurement chain of the rig of Shen et
/// al. (2007), noise of a 4 pC/N sensor unless the sensor records pC, vibrometer with 1 um/s per
/// root hertz.
///
/// Peaks > 0 where there is such a sensor, that of the velocity where there is one of displacement.
SyntheticOptions good_laboratory_day(const SensorSet& sensors, const ShownPeaks& peaks);

/// How wrong the calibration is: gain and delay of each sensor miss by normal draws as large as the
/// uncertainties it states, so that a seed stands for one laboratory and its shots share the
/// errors.
void draw_calibration_errors(const SensorSet& sensors, std::uint64_t seed,
                             SyntheticOptions& options);

/// Everything that goes wrong at once, for tests of robustness: 8 bits (6.5 effective), ten times
/// the charge noise, five times the vibrometer's, hum and a ground-loop step of 1 % of the range,
/// dropouts (one in the contact), a filter of 10 kHz left on (as 21.7 us of unknown delay of the
/// force), calibration off by 2 %, trigger off by up to a sample.
SyntheticOptions bad_day(const SensorSet& sensors, const ShownPeaks& peaks);

/// The synthetic rig as a source: `shots` records of the same trajectory, seeds counting up.
class SyntheticSource : public Source {
 public:
  SyntheticSource(Trajectory trajectory, SensorSet sensors, SyntheticOptions options,
                  std::size_t shots);
  std::optional<datasets::Record> next() override;

 private:
  Trajectory trajectory_;
  SensorSet sensors_;
  SyntheticOptions options_;
  std::size_t left_;
};

}  // namespace impactrig::acquisition
