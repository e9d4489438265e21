// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

/// What can be done to a recording's channels before impacts are looked for. These values say what
/// is asked for (in a rig file or a map of channels); acquisition/conditioning/steps.hpp does it.
namespace impactrig::datasets {

/// From when to when, both included, on the channel's own clock [s].
struct TimeSpan {
  double begin = 0.0;
  double end = 0.0;
};

/// The mean of a quiet stretch comes off; without a stretch what lies before first touch.
struct RemoveBaseline {
  std::optional<TimeSpan> quiet{};
};

/// The straight line through a quiet stretch comes off; without a stretch as above.
struct RemoveDrift {
  std::optional<TimeSpan> quiet{};
};

/// A charge amplifier's return to zero, c + a exp(-t/T), comes off.
struct RemoveDecay {
  std::vector<TimeSpan> quiet{};          ///< where nothing else is; empty: before first touch
  std::optional<double> time_constant{};  ///< T [s]; without it from the data
};

/// Undoes a first-order high-pass: what an amplifier's lower limit took from a pulse.
struct UndoLowCut {
  double frequency = 0.0;  ///< 3 dB point [Hz], > 0
  std::optional<TimeSpan> quiet{};
};

/// A Butterworth low-pass forwards and backwards, without delay.
struct LowPass {
  double cutoff = 0.0;  ///< where both passes together have 3 dB [Hz], > 0
  int order = 4;        ///< of one pass, 1 to 8

  bool operator==(const LowPass&) const = default;
};

/// Mains hum comes off: sinusoids that are fitted to quiet stretches.
struct RemoveHum {
  std::optional<double> frequency{};  ///< near which the mains is [Hz]; without it 50 Hz
  int harmonics = 5;                  ///< up to which multiple, 1 to 20
  std::vector<TimeSpan> quiet{};      ///< empty: before first touch
};

/// Dropouts and spikes of a laser are marked invalid and bridged.
struct RepairDropouts {
  double longest = 300e-6;  ///< [s], > 0
};

/// The channel's delay against another one is estimated from the data and taken off its clock.
struct AlignTo {
  std::string reference;  ///< channel, as ConditioningStep::channel names it
  double range = 50e-6;   ///< the delay lies within plus or minus this [s], > 0
};

/// The channel on a clock of another rate, band-limited.
struct Resample {
  double rate = 0.0;  ///< [Hz], > 0
};

/// A further channel: the integral over time.
struct Integrate {
  std::string name;                 ///< of the new channel
  std::optional<TimeSpan> quiet{};  ///< where the integrand's own line is zero; without: not taken
  std::optional<double> zero_at{};  ///< where the integral is 0 [s]; without: at the first sample
};

/// A further channel: the derivative.
struct Differentiate {
  std::string name;  ///< of the new channel
};

using ConditioningAction =
    std::variant<RemoveBaseline, RemoveDrift, RemoveDecay, UndoLowCut, LowPass, RemoveHum,
                 RepairDropouts, AlignTo, Resample, Integrate, Differentiate>;

/// One thing to do, to one channel or to several.
struct ConditioningStep {
  std::string channel;  ///< name, pattern with * and ?, or quantity ("force")
  ConditioningAction action;
};

}  // namespace impactrig::datasets
