// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/synthetic.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

#include "acquisition/random_stream.hpp"
#include "datasets/sampled_curve.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::Quantity;
using datasets::Record;
using datasets::Sensor;

namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;

/// One sensor with what happens to its signal.
struct Line {
  const Sensor* sensor;
  const Disturbances* disturbances;
  const std::vector<double>* history;
  const char* default_name;

  std::string key() const { return fmt::format("truth.{}.", name(sensor->quantity)); }
};

/// A span of the record's clock [s].
struct Dropout {
  double begin, end;
};

std::vector<Line> lines_of(const Trajectory& trajectory, const SensorSet& sensors,
                           const SyntheticOptions& options) {
  std::vector<Line> lines;
  if (sensors.force) lines.push_back({&*sensors.force, &options.force, &trajectory.force, "Force"});
  if (sensors.velocity)
    lines.push_back({&*sensors.velocity, &options.velocity, &trajectory.velocity, "Velocity"});
  if (sensors.displacement)
    lines.push_back(
        {&*sensors.displacement, &options.displacement, &trajectory.displacement, "Displacement"});
  return lines;
}

void refuse_senseless(const Trajectory& trajectory, const SyntheticOptions& options,
                      const std::vector<Line>& lines) {
  const auto refuse = [](const std::string& problem) { throw std::invalid_argument(problem); };
  if (!(options.sample_rate > 0.0) || !(options.duration > 0.0) ||
      !(options.duration * options.sample_rate < 1e9))
    refuse(fmt::format("a recording of {:.12g} s at {:.12g} Hz cannot be made", options.duration,
                       options.sample_rate));
  if (!(trajectory.interval > 0.0) ||
      trajectory.interval * options.sample_rate > 0.1 * (1.0 + 1e-9))
    refuse(
        fmt::format("the trajectory's step of {:.12g} s must be at least 10 times finer than the "
                    "recording's of {:.12g} s",
                    trajectory.interval, 1.0 / options.sample_rate));
  for (const Line& line : lines) {
    const Disturbances& d = *line.disturbances;
    if (line.history->size() < 4)
      refuse(fmt::format("the trajectory has no {}, which a sensor is to record",
                         name(line.sensor->quantity)));
    if (d.bits < 0 || d.bits == 1 || d.bits > 32)
      refuse(fmt::format("a digitiser of {} bits cannot be made; 2 to 32, or 0 for none", d.bits));
    if (d.bits > 0 && !(d.range > 0.0))
      refuse(fmt::format("a digitiser of {} bits needs the range of the {}", d.bits,
                         name(line.sensor->quantity)));
    if (line.sensor->sensitivity && !(std::abs(line.sensor->sensitivity->value) > 0.0))
      refuse(fmt::format("the sensitivity of the {} is 0", name(line.sensor->quantity)));
  }
}

// --- The sensor's chain -------------------------------------------------------------------------

/// How long the chain remembers a ramp: three periods of its slowest low-pass, the resonance's
/// decay to a thousandth.
double memory_of(const Sensor& sensor) {
  double memory = 0.0;
  if (sensor.high_cut) memory += 3.0 / sensor.high_cut->frequency;
  if (sensor.resonance)
    memory += 7.0 * sensor.resonance->quality / (std::numbers::pi * sensor.resonance->frequency);
  return memory;
}

/// The history as the sensor's chain shows it, from `first` to `last` at least [s].
datasets::SampledCurve shown(const Line& line, const Trajectory& trajectory, double first,
                             double last) {
  const std::vector<double>& history = *line.history;
  const double end =
      trajectory.start + trajectory.interval * static_cast<double>(history.size() - 1);
  // A thousandth of a step of grace: times are rounded.
  if (last > end + 1e-3 * trajectory.interval)
    throw std::invalid_argument(
        fmt::format("the trajectory's {} ends at {:.9g} s, but the recording needs it until "
                    "{:.9g} s; simulate longer or record shorter",
                    name(line.sensor->quantity), end, last));

  // A constant past is in the response already, a ramp has to be laid before it.
  const bool ramp = line.sensor->quantity == Quantity::displacement;
  const double missing = (trajectory.start - first + memory_of(*line.sensor)) / trajectory.interval;
  const auto before =
      static_cast<std::size_t>(ramp ? std::max(0.0, std::ceil(missing) + 2.0) : 0.0);
  const double velocity = trajectory.velocity.empty()
                              ? (history[1] - history[0]) / trajectory.interval
                              : trajectory.velocity[0];
  const double step = ramp ? velocity * trajectory.interval : 0.0;

  std::vector<double> input(before + history.size());
  for (std::size_t i = 0; i < before; ++i)
    input[i] = history[0] - step * static_cast<double>(before - i);
  std::ranges::copy(history, input.begin() + static_cast<std::ptrdiff_t>(before));
  datasets::SampledCurve curve{
      .start = trajectory.start - trajectory.interval * static_cast<double>(before),
      .interval = trajectory.interval,
      .values = std::move(input)};
  if (line.sensor->quantity == Quantity::force) {
    curve.jumps = trajectory.force_jumps;
    curve.spikes = trajectory.force_spikes;
  }
  return sensor_response(*line.sensor, curve);
}

// --- The laboratory -----------------------------------------------------------------------------

/// 1/f noise of unit power from 10 Hz to 1 kHz: five first-order recursions of equal power, their
/// corners half a decade apart.
class LowFrequencyNoise {
 public:
  LowFrequencyNoise(double interval, RandomStream& random) : random_(random) {
    for (std::size_t k = 0; k < size; ++k) {
      const double corner = 10.0 * std::pow(10.0, 0.5 * static_cast<double>(k));  // [Hz]
      keep_[k] = std::exp(-two_pi * corner * interval);
      state_[k] = random_.normal();
    }
  }

  double operator()() {
    double sum = 0.0;
    for (std::size_t k = 0; k < size; ++k) {
      sum += state_[k];
      state_[k] = keep_[k] * state_[k] + std::sqrt(1.0 - keep_[k] * keep_[k]) * random_.normal();
    }
    return sum / std::sqrt(static_cast<double>(size));
  }

 private:
  static constexpr std::size_t size = 5;
  RandomStream& random_;
  std::array<double, size> keep_{}, state_{};
};

/// The record's clock and what was drawn for it.
struct Recording {
  double start, interval;
  std::size_t samples;
  double shift;  ///< true time minus recorded time [s]

  double time(std::size_t i) const { return start + interval * static_cast<double>(i); }
};

void disturb(std::vector<double>& values, const Line& line, const Recording& recording,
             std::uint64_t seed, Record& record) {
  const Disturbances& d = *line.disturbances;
  const std::string quantity(name(line.sensor->quantity));
  RandomStream noise(seed, quantity + " noise"), slow(seed, quantity + " low-frequency noise"),
      mains(seed, quantity + " hum");
  LowFrequencyNoise speckle(recording.interval, slow);
  const double phase = mains.uniform(0.0, two_pi), third = mains.uniform(0.0, two_pi);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double t = recording.time(i);
    double& value = values[i];
    value *= 1.0 + d.gain_error;
    if (d.noise > 0.0) value += d.noise * noise.normal();
    if (d.low_frequency_noise > 0.0) value += d.low_frequency_noise * speckle();
    value += d.drift * (t - recording.start);
    value +=
        d.hum * (std::sin(two_pi * 50.0 * t + phase) + 0.3 * std::sin(two_pi * 150.0 * t + third));
    value += d.offset;
    if (t + recording.shift >= 0.0) value += d.step;
  }
  auto& truth = record.attributes;
  const auto say = [&](const char* what, double value) {
    truth[line.key() + what] = fmt::format("{}", value);
  };
  say("delay", line.sensor->delay.value + d.delay_error);
  say("gain", 1.0 + d.gain_error);
  say("noise", d.noise);
  say("low_frequency_noise", d.low_frequency_noise);
  say("drift", d.drift);
  say("hum", d.hum);
  say("hum_phase", phase);
  say("hum_third_phase", third);
  say("offset", d.offset);
  say("step", d.step);
}

/// When the laser sees nothing, in order of time.
std::vector<Dropout> dropouts_of(const Disturbances& d, const Recording& recording,
                                 RandomStream& random) {
  std::vector<Dropout> dropouts;
  if (d.dropout_in_contact) {
    const double begin = random.uniform(0.0, 50e-6) - recording.shift;
    dropouts.push_back({begin, begin + random.uniform(20e-6, 200e-6)});
  }
  const double end = recording.time(recording.samples - 1);
  if (d.dropouts_per_second > 0.0) {
    double t = recording.start;
    while ((t += random.exponential() / d.dropouts_per_second) < end) {
      dropouts.push_back({t, t + random.uniform(20e-6, 200e-6)});
      t = dropouts.back().end;
    }
  }
  std::ranges::sort(dropouts, {}, &Dropout::begin);
  return dropouts;
}

void lose_light(std::vector<double>& values, const Line& line, const Recording& recording,
                std::uint64_t seed, std::vector<Dropout>& all) {
  const Disturbances& d = *line.disturbances;
  if (line.sensor->quantity == Quantity::force) return;
  RandomStream random(seed, fmt::format("{} dropouts", name(line.sensor->quantity)));
  double largest = d.range;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  for (const Dropout& dropout : dropouts_of(d, recording, random)) {
    const double n = static_cast<double>(values.size());
    const auto sample = [&](double t) {
      return static_cast<std::size_t>(
          std::clamp(std::ceil((t - recording.start) / recording.interval), 0.0, n));
    };
    const std::size_t begin = sample(dropout.begin), end = sample(dropout.end);
    if (begin >= end) continue;
    all.push_back(dropout);
    if (line.sensor->quantity == Quantity::displacement) {
      const double held = values[begin > 0 ? begin - 1 : 0];
      const double lost = values[end - 1] - held;
      for (std::size_t i = begin; i < end; ++i) values[i] = held;
      for (std::size_t i = end; i < values.size(); ++i) values[i] -= lost;
      continue;
    }
    for (std::size_t i = begin; i < end; ++i)
      values[i] = 0.02 * values[i] + 5.0 * d.noise * random.normal();
    for (const std::size_t edge : {begin, end - 1})
      values[edge] += largest * random.uniform(0.2, 0.6) * (random.uniform() < 0.5 ? -1.0 : 1.0);
  }
}

// --- The digitiser ------------------------------------------------------------------------------

template <typename Code>
std::vector<Code> codes_of(const std::vector<double>& values, double step, int bits) {
  const double top = std::ldexp(1.0, bits - 1) - 1.0;
  std::vector<Code> codes(values.size());
  std::ranges::transform(values, codes.begin(), [&](double value) {
    return static_cast<Code>(std::clamp(std::round(value / step), -top - 1.0, top));
  });
  return codes;
}

/// From SI to the recorded unit, clipped and rounded as the digitiser does.
void digitise(std::vector<double> values, const Line& line, Channel& channel) {
  const Disturbances& d = *line.disturbances;
  const double factor =
      line.sensor->polarity * (line.sensor->sensitivity ? line.sensor->sensitivity->value : 1.0);
  const double range = d.range * std::abs(factor);
  for (double& value : values) {
    value *= factor;
    if (range > 0.0) value = std::clamp(value, -range, range);
  }
  if (d.bits == 0) {
    channel.raw = std::move(values);
    return;
  }
  channel.scale = range / std::ldexp(1.0, d.bits - 1);
  if (d.bits <= 16)
    channel.raw = codes_of<std::int16_t>(values, channel.scale, d.bits);
  else
    channel.raw = codes_of<std::int32_t>(values, channel.scale, d.bits);
}

bool is_index(const std::string& channel) {
  return !channel.empty() && channel.find_first_not_of("0123456789") == std::string::npos;
}

Channel recorded(const Line& line, const Trajectory& trajectory, const Recording& recording,
                 std::uint64_t seed, Record& record, std::vector<Dropout>& dropouts) {
  const Sensor& sensor = *line.sensor;
  const double delay = sensor.delay.value + line.disturbances->delay_error;
  const double lag = recording.shift - delay;  // what happened at t + lag is shown at t
  const datasets::SampledCurve history =
      shown(line, trajectory, recording.start + lag, recording.time(recording.samples - 1) + lag);
  std::vector<double> values(recording.samples);
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = history.at(recording.time(i) + lag)[0];
  disturb(values, line, recording, seed, record);
  lose_light(values, line, recording, seed, dropouts);

  Channel channel;
  const bool named = !sensor.channel.empty() && !is_index(sensor.channel);
  channel.name = named ? sensor.channel : line.default_name;
  channel.unit = sensor.sensitivity ? sensor.recorded_unit : std::string(si_unit(sensor.quantity));
  channel.quantity =
      sensor.sensitivity ? datasets::quantity_of_unit(sensor.recorded_unit) : sensor.quantity;
  channel.clock.start = recording.start;
  channel.clock.interval = recording.interval;
  digitise(std::move(values), line, channel);
  return channel;
}

/// A sensor that is recorded at an index stands there.
void sort_by_index(const std::vector<Line>& lines, std::vector<Channel>& channels) {
  std::vector<std::pair<std::size_t, Channel>> keyed;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    std::size_t key = i;
    const std::string& wanted = lines[i].sensor->channel;
    if (is_index(wanted)) std::from_chars(wanted.data(), wanted.data() + wanted.size(), key);
    keyed.emplace_back(key, std::move(channels[i]));
  }
  std::ranges::stable_sort(keyed, {}, &std::pair<std::size_t, Channel>::first);
  for (std::size_t i = 0; i < keyed.size(); ++i) channels[i] = std::move(keyed[i].second);
}

}  // namespace

Record synthesise(const Trajectory& trajectory, const SensorSet& sensors,
                  const SyntheticOptions& options) {
  const std::vector<Line> lines = lines_of(trajectory, sensors, options);
  refuse_senseless(trajectory, options, lines);

  RandomStream trigger(options.seed, "trigger");
  const double interval = 1.0 / options.sample_rate;
  const Recording recording{-options.pre_trigger, interval,
                            static_cast<std::size_t>(std::round(options.duration / interval)),
                            trigger.uniform(-1.0, 1.0) * options.trigger_jitter * interval};
  Record record;
  record.title = fmt::format("synthetic impact, seed {}", options.seed);
  record.provenance.importer = "synthetic";
  record.provenance.program = datasets::program_version();
  std::vector<Dropout> dropouts;
  for (const Line& line : lines)
    record.channels.push_back(
        recorded(line, trajectory, recording, options.seed, record, dropouts));
  sort_by_index(lines, record.channels);

  std::string list;
  for (const Dropout& dropout : dropouts)
    list += fmt::format("{}[{:.9g}, {:.9g}]", list.empty() ? "" : ", ", dropout.begin, dropout.end);
  record.attributes["truth.dropouts"] = "[" + list + "]";
  record.attributes["truth.seed"] = fmt::format("{}", options.seed);
  record.attributes["truth.first_touch"] = fmt::format("{}", -recording.shift);
  return record;
}

ShownPeaks shown_peaks(const Trajectory& trajectory, const SensorSet& sensors) {
  const auto largest = [](const std::vector<double>& values) {
    double most = 0.0;
    for (const double value : values) most = std::max(most, std::abs(value));
    return most;
  };
  ShownPeaks peaks{largest(trajectory.force), largest(trajectory.velocity)};
  const SyntheticOptions undisturbed;
  for (const Line& line : lines_of(trajectory, sensors, undisturbed)) {
    if (line.history->size() < 4 || line.sensor->quantity == Quantity::displacement) continue;
    const double length = trajectory.interval * static_cast<double>(line.history->size() - 1);
    double& peak = line.sensor->quantity == Quantity::force ? peaks.force : peaks.velocity;
    peak = largest(shown(line, trajectory, trajectory.start, trajectory.start + length).values);
  }
  return peaks;
}

SyntheticSource::SyntheticSource(Trajectory trajectory, SensorSet sensors, SyntheticOptions options,
                                 std::size_t shots)
    : trajectory_(std::move(trajectory)),
      sensors_(std::move(sensors)),
      options_(options),
      left_(shots) {}

std::optional<Record> SyntheticSource::next() {
  if (left_ == 0) return std::nullopt;
  --left_;
  Record record = synthesise(trajectory_, sensors_, options_);
  ++options_.seed;
  return record;
}

}  // namespace impactrig::acquisition
