// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "acquisition/random_stream.hpp"
#include "acquisition/synthetic.hpp"

namespace impactrig::acquisition {

using datasets::Sensor;

namespace {

/// The noise of a digitiser whose effective bits are 1.5 fewer than its bits, in steps: 2^1.5 times
/// the rounding error of 1/sqrt(12), less that rounding itself.
constexpr double excess_noise = 0.764;

/// Charge of a usual force sensor a newton [pC/N]: the one of Shen et al. (2007).
constexpr double usual_charge = 4.0;

/// The recorder's range for a peak in noise (four standard deviations of it) with a quarter to
/// spare [SI]: 1, 2 or 5 times a power of ten in the recorded unit, no more than the sensor's own.
double range_for(const Sensor& sensor, double peak, double noise) {
  const double factor = sensor.sensitivity ? std::abs(sensor.sensitivity->value) : 1.0;
  const double wanted = 1.25 * (peak + 4.0 * noise) * factor;
  const double decade = std::pow(10.0, std::floor(std::log10(wanted)));
  double range = 10.0 * decade;
  for (const double step : {5.0, 2.0, 1.0})
    if (step * decade >= wanted) range = step * decade;
  range /= factor;
  return sensor.range > 0.0 ? std::min(range, sensor.range) : range;
}

double step_of(const Disturbances& d) {
  return d.range / std::ldexp(1.0, d.bits - 1);
}

/// Charge [pC] as force [N].
double newtons(const Sensor& sensor, double charge) {
  const bool known = sensor.sensitivity && sensor.recorded_unit == "pC";
  return charge / (known ? std::abs(sensor.sensitivity->value) : usual_charge);
}

/// What every channel of a digitiser shares: mains and offset by its range, noise by its step.
Disturbances digitised(double range, int bits, double own_noise, double part) {
  Disturbances d;
  d.range = range;
  d.bits = bits;
  d.noise = std::hypot(own_noise, excess_noise * step_of(d));
  d.hum = part * range;
  d.offset = part * range;
  return d;
}

/// Half of the smallest span of a fringe-counting decoder that holds the motion [m]: 12-bit
/// counters with steps of 0.031, 0.078, 0.31, 1.25 and 5 um.
double counter_range(double motion) {
  constexpr std::array spans{64e-6, 160e-6, 640e-6, 2560e-6, 10240e-6};
  for (const double span : spans)
    if (span >= motion) return span;
  return spans.back();
}

struct Day {
  int bits;
  double charge_noise;  ///< [pC rms]
  double charge_drift;  ///< [pC/s]
  double density;       ///< of the vibrometer's noise [m/s per root Hz]
  double speckle;       ///< [m/s rms]
  double dropouts;      ///< [1/s]
  double range_part;    ///< hum and offset, of the range
  double gain_error;
};

SyntheticOptions recorded_on(const Day& day, const SensorSet& sensors, const ShownPeaks& peaks) {
  SyntheticOptions options;
  if (sensors.force) {
    const Sensor& sensor = *sensors.force;
    const double noise = newtons(sensor, day.charge_noise);
    options.force =
        digitised(range_for(sensor, peaks.force, noise), day.bits, noise, day.range_part);
    options.force.drift = newtons(sensor, day.charge_drift);
    options.force.gain_error = day.gain_error;
  }
  if (sensors.velocity) {
    const Sensor& sensor = *sensors.velocity;
    const double half_rate = 0.5 * options.sample_rate;
    const double band =
        sensor.high_cut ? std::min(sensor.high_cut->frequency, half_rate) : half_rate;
    const double noise = day.density * std::sqrt(band);
    options.velocity =
        digitised(range_for(sensor, peaks.velocity, noise), day.bits, noise, day.range_part);
    options.velocity.low_frequency_noise = day.speckle;
    options.velocity.dropouts_per_second = day.dropouts;
    options.velocity.gain_error = day.gain_error;
  }
  if (sensors.displacement) {
    const double longest = std::max(options.pre_trigger, options.duration - options.pre_trigger);
    Disturbances& d = options.displacement;
    d.range = counter_range(peaks.velocity * longest);
    d.bits = 12;
    d.noise = 0.3 * step_of(d);
    d.dropouts_per_second = day.dropouts;
    d.gain_error = day.gain_error;
  }
  return options;
}

}  // namespace

SyntheticOptions good_laboratory_day(const SensorSet& sensors, const ShownPeaks& peaks) {
  const Day day{12, 0.01, 0.03, 1e-6, 40e-6, 0.2, 0.001, 0.005};
  return recorded_on(day, sensors, peaks);
}

void draw_calibration_errors(const SensorSet& sensors, std::uint64_t seed,
                             SyntheticOptions& options) {
  const auto draw = [&](const std::optional<Sensor>& sensor, Disturbances& d) {
    if (!sensor) return;
    RandomStream random(seed, fmt::format("calibration of {}", datasets::name(sensor->quantity)));
    const double relative =
        sensor->sensitivity ? sensor->sensitivity->uncertainty / sensor->sensitivity->value : 0.0;
    d.gain_error = relative * random.normal();
    d.delay_error = sensor->delay.uncertainty * random.normal();
  };
  draw(sensors.force, options.force);
  draw(sensors.velocity, options.velocity);
  draw(sensors.displacement, options.displacement);
}

SyntheticOptions bad_day(const SensorSet& sensors, const ShownPeaks& peaks) {
  const Day day{8, 0.1, 0.3, 5e-6, 40e-6 + 0.001 * peaks.velocity, 20.0, 0.01, 0.02};
  SyntheticOptions options = recorded_on(day, sensors, peaks);
  options.trigger_jitter = 1.0;
  options.force.delay_error = 21.7e-6;  // 24 us of a 10 kHz filter instead of 2.3 us
  options.force.step = 0.01 * options.force.range;
  options.velocity.step = 0.01 * options.velocity.range;
  options.velocity.dropout_in_contact = sensors.velocity.has_value();
  return options;
}

}  // namespace impactrig::acquisition
