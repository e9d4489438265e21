// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "datasets/record.hpp"
#include "datasets/units.hpp"

namespace impactrig::datasets {

/// A Butterworth section of the measuring chain, by its 3 dB point.
struct BandLimit {
  double frequency = 0.0;  ///< 3 dB point [Hz], > 0
  int order = 1;           ///< 1 to 8
};

/// A sensor's mounted resonance: one degree of freedom, unit gain at 0 Hz.
struct Resonance {
  double frequency = 0.0;  ///< undamped [Hz], > 0
  double quality = 20.0;   ///< Q = 1/(2 zeta), > 0.5
};

/// One sensor with its whole chain, from the struck point to the number in the file ([sensors.*] of
/// the rig file). The order of the signal: resonance, low cut, high cut, delay, sensitivity,
/// polarity.
struct Sensor {
  Quantity quantity = Quantity::force;
  std::string channel;  ///< name or index in the recording; "" = the only one of this quantity
  std::optional<UncertainValue> sensitivity;  ///< recorded unit an SI unit, gain included (V/N)
  std::string recorded_unit;  ///< of the recording when `sensitivity` is given ("V" or "pC")
  double polarity = 1.0;      ///< +1 or -1
  double position = 0.0;  ///< from the hinge [m], 0: the struck point, wherever; vibrometer only
  std::optional<Resonance> resonance;
  std::optional<BandLimit> low_cut;   ///< high-pass of the amplifier
  std::optional<BandLimit> high_cut;  ///< low-pass of amplifier or decoder
  Delay delay;
  double range = 0.0;  ///< largest magnitude before it clips [SI]; 0 not known
};

}  // namespace impactrig::datasets
