// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "datasets/impact.hpp"
#include "datasets/record.hpp"
#include "datasets/sensor.hpp"

namespace impactrig::acquisition {

/// The sensors of a rig, as far as it has them.
struct SensorSet {
  std::optional<datasets::Sensor> force{};
  std::optional<datasets::Sensor> velocity{};
  std::optional<datasets::Sensor> displacement{};
};

/// A record whose channels are force, velocity and displacement in SI, positive in compression and
/// while closing, known delays taken off the clocks. Channels that no sensor claims are left out.
/// Every step is an Edit in the provenance; samples stay as they are, since every step is affine
/// (Channel::scale, Channel::offset and the clock change).
///
/// A sensor that names no channel takes the only channel of its quantity, else the only one in the
/// unit its sensitivity is for. A set without any sensor takes every force, velocity, displacement
/// and acceleration the record has. Each channel carries the sensor's calibration and delay, and
/// the sensor's range as attribute "sensor.range" [SI], its low cut, where that is of first
/// order, as "sensor.low_cut" [Hz].
///
/// Samples that are not finite must be marked invalid. Throws datasets::InputError (with the
/// recording as place) when a named channel is absent, a unit is not that of the sensor's quantity
/// and no sensitivity bridges the two, samples are not finite, or the clock is not uniform.
datasets::Record condition(const datasets::Record& record, const SensorSet& sensors);

/// How impacts are looked for.
struct DetectionOptions {
  double threshold = 0.0;  ///< on the trigger channel [SI]; 0 = from noise and peak
  /// Kept before first touch [s]; none: least_pre_trigger, or half as long as the contact takes, or
  /// 200 samples that no filter ties to each other of the slowest channel, up to 50 ms.
  std::optional<double> pre_trigger{};
  static constexpr double least_pre_trigger = 0.5e-3;  ///< [s]
  /// Kept after first touch [s]; none: least_post_trigger, or twice as long as the contact takes.
  std::optional<double> post_trigger{};
  static constexpr double least_post_trigger = 5e-3;  ///< [s]

  /// Where the channels' rates do not matter [s].
  double before() const { return pre_trigger.value_or(least_pre_trigger); }

  /// Within which later contacts are further hits [s].
  double after() const { return post_trigger.value_or(least_post_trigger); }

  /// Name or index; "" = the first force, else acceleration, else velocity, else displacement.
  std::string trigger_channel{};
  std::optional<std::size_t> trigger_index{};  ///< in place of a name, which may be a number too
};

/// Finds impacts in a conditioned record (or any record with a force, acceleration, velocity or
/// displacement channel), in order of time. Each holds the channels cut to its window, baseline and
/// noise taken from before the trigger. Empty when there is none.
///
/// Force or acceleration: an impact is what leaves the baseline by more than
/// max(6 standard deviations, 5 % of the record's peak); the standard deviation is robust (median
/// absolute deviation), and 6 grows to sqrt(2 ln n) + 1.7 in records of more than 10⁴ samples.
/// First touch is traced back from there to where the signal leaves the baseline's scatter, end is
/// where it comes back to it, both between samples. The first contact is this first pulse; `peak`
/// is its extreme sample, signed (a pulse may be negative throughout; nothing is turned round),
/// `width` the full width at half of it, `impulse` its integral by the trapezoidal rule.
/// A later pulse of the same sign within post_trigger is a double hit when it stands out as above
/// and is more than twice what the signal has swung the other way since, which ringing never is.
/// A pulse further away than that is an impact of its own.
///
/// Velocity: an impact is a lasting change that begins with a bend twice as sharp as any before, as
/// no vibration, hum or drift makes one of which the record shows half of a period (BendSearch).
/// The mean after it is off the course before by 1.5 times the scatter of what the bar is left in.
/// What comes back to its course within 0.3 ms is a dropout, and what follows is looked at anew.
/// `peak` is the change from before to after (negative when the bar is thrown back), `width` twice
/// the time from 25 to 75 % of it (the full width at half height of a half-sine deceleration),
/// `impulse` the way travelled. Double hits are not flagged: a velocity alone does not tell them
/// from the bar's vibration.
///
/// Displacement: an impact begins with such a bend too, behind which the motion turns and has
/// another speed than before by five times what both are uncertain and the bar vibrates by
/// (fit_bounce). `start` is the touch of the fit, `end` where the displacement is back at its value
/// there, `peak` how far it went beyond, `width` how long beyond half of that, `impulse` the
/// integral of the way beyond. Impact::rebound has the speeds. A bar at rest that is struck, one
/// that stays at the stop, and double hits are not told.
///
/// Refuses to find anything in noise, drift or mains hum alone. A record shorter than 20 ms whose
/// pulse fills most of it is told from hum by what a smooth curve cannot follow; there the pulse
/// must be 20 times the noise.
///
/// The values of ImpactSignal at invalid samples are interpolated; `valid` says which. Throws
/// datasets::InputError when the trigger channel is absent, its unit is not understood, or a clock
/// is not uniform; std::invalid_argument when an option is negative or not finite.
std::vector<datasets::Impact> find_impacts(const datasets::Record& record,
                                           const DetectionOptions& options = {});

}  // namespace impactrig::acquisition
