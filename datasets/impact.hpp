// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/conditioning.hpp"
#include "datasets/sample_filter.hpp"
#include "datasets/units.hpp"

namespace impactrig::datasets {

/// What is wrong with an impact as it was recorded.
enum class ImpactFlag {
  clipped,         ///< flat tops or values at the range: peak and impulse are too small
  double_hit,      ///< a second contact within the window
  multiple_hits,   ///< three or more contacts within the window (beside double_hit)
  no_hit,          ///< nothing rises above the noise
  too_short,       ///< the record does not hold the whole contact, for one of the next two reasons
  missed_start,    ///< it begins after first touch
  truncated_tail,  ///< it ends before the contact does
  dropout,         ///< invalid samples within the window
  unmarked_dropout,  ///< the laser's signal does what it does in a dropout, and nobody marked it
  undersampled,      ///< fewer than 20 samples over the contact
  noisy,             ///< noise before touch above 2 % of the signal
  unsteady,          ///< force or acceleration before touch wanders by more than 2 % of the peak
  baseline_shift,  ///< force after the contact is off its level before by more than 1 % of the peak
  inverted,        ///< force is tension, or the bar comes from the wrong side
  swapped,         ///< what is called velocity looks like a force, and the other way round
  implausible      ///< impulse and approach speed do not fit the rig: a wrong unit or sensitivity
};

std::string_view name(ImpactFlag flag);                       ///< "double-hit"
std::string_view sentence(ImpactFlag flag);                   ///< what it means, what to do
std::optional<ImpactFlag> flag_named(std::string_view name);  ///< none when there is no such flag

/// One channel around the impact: calibrated, SI, known delay taken off, baseline taken off.
/// Compression and closing motion are positive.
struct ImpactSignal {
  Quantity quantity = Quantity::force;
  std::string channel;                     ///< name in the recording
  double start = 0.0;                      ///< of values[0], on the record's time axis [s]
  double interval = 0.0;                   ///< [s]
  std::vector<double> values;              ///< [N, m/s, m] (n_samples)
  std::vector<std::uint8_t> valid;         ///< as Channel::valid; empty: all sound
  double noise = 0.0;                      ///< standard deviation before the trigger [SI]
  double noise_correlation = 1.0;          ///< its integrated autocorrelation time [samples], >= 1
  double baseline = 0.0;                   ///< what was taken off [SI]
  double quantum = 0.0;                    ///< one digitiser step [SI]; 0 when not seen
  double gain_uncertainty = 0.0;           ///< relative standard uncertainty of the calibration
  double delay = 0.0;                      ///< known delay that was taken off [s]
  double delay_uncertainty = 0.0;          ///< [s]
  std::vector<SampleFilter> filters = {};  ///< that the channel has been through
  TimeSpan recorded = {};  ///< first and last sample of the whole channel, where it has [s]

  double time(std::size_t i) const { return start + interval * static_cast<double>(i); }
};

/// How a displacement alone shows the bar come and go. A force or a velocity tells more.
struct Rebound {
  double approach_error = 0.0;  ///< standard error of Impact::approach_velocity [m/s]
  double from = 0.0, to = 0.0;  ///< the stretch of the rebound [s, record's time axis]
  double velocity = 0.0;        ///< mean over it, away from the stop > 0 [m/s]
  double velocity_error = 0.0;  ///< its standard error, vibration's scatter included [m/s]
  double restitution = 0.0;     ///< velocity over approach velocity
  double restitution_error = 0.0;
  std::string absent;  ///< why there are no velocity and restitution; empty where there are

  std::array<double, 2> restitution_ci95() const {
    constexpr double quantile = 1.959963985;
    return {restitution - quantile * restitution_error, restitution + quantile * restitution_error};
  }
};

/// One impact found in a recording, ready to be compared with a model.
struct Impact {
  std::string recording;   ///< file it was found in
  std::string trigger;     ///< channel it was found in
  double start = 0.0;      ///< first touch as the trigger channel shows it [s, record's time axis]
  double end = 0.0;        ///< end of the first contact [s]
  double peak = 0.0;       ///< of the trigger channel [SI]
  double peak_time = 0.0;  ///< [s]
  double width = 0.0;      ///< full width at half of the peak [s]
  double impulse = 0.0;    ///< integral of the trigger channel over the contact [SI s]
  /// Mean before touch [m/s]; found in a displacement the speed at touch, else 0 without a
  /// velocity.
  double approach_velocity = 0.0;
  std::optional<Rebound> rebound;  ///< where the impact was found in a displacement
  std::optional<ImpactSignal> force;
  std::optional<ImpactSignal> velocity;
  std::optional<ImpactSignal> displacement;
  std::vector<ImpactFlag> flags;

  bool has(ImpactFlag flag) const;
};

}  // namespace impactrig::datasets
