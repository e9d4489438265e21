// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "datasets/record.hpp"

namespace impactrig::tests {

/// How a scene is sampled.
struct Sampling {
  double start = -1e-3;    ///< [s]
  double interval = 1e-6;  ///< [s]
  std::size_t samples = 4000;

  double time(std::size_t i) const { return start + interval * static_cast<double>(i); }
};

/// F sin(pi t/T) on [0, T].
inline double half_sine(double t, double height, double duration) {
  return t > 0.0 && t < duration ? height * std::sin(std::numbers::pi * t / duration) : 0.0;
}

/// F sin²(pi t/T) on [0, T].
inline double sine_squared(double t, double height, double duration) {
  const double s = half_sine(t, 1.0, duration);
  return height * s * s;
}

inline std::vector<double> sampled(const Sampling& at, const std::function<double(double)>& f) {
  std::vector<double> values(at.samples);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = f(at.time(i));
  return values;
}

/// Normal noise, the same on every machine with the same libm.
class Noise {
 public:
  explicit Noise(std::uint64_t seed) : engine_(seed) {}

  double operator()() {
    const double u = 1.0 - uniform();
    return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * uniform());
  }

  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }

 private:
  std::mt19937_64 engine_;
};

inline void add_noise(std::vector<double>& values, double sigma, std::uint64_t seed) {
  Noise noise(seed);
  for (double& value : values) value += sigma * noise();
}

inline void round_to(std::vector<double>& values, double step) {
  for (double& value : values) value = step * std::round(value / step);
}

inline datasets::Channel channel_of(std::string name, datasets::Quantity quantity,
                                    const Sampling& at, std::vector<double> values) {
  datasets::Channel channel;
  channel.name = std::move(name);
  channel.quantity = quantity;
  channel.unit = si_unit(quantity);
  channel.clock.start = at.start;
  channel.clock.interval = at.interval;
  channel.raw = std::move(values);
  return channel;
}

inline datasets::Channel force_of(const Sampling& at, std::vector<double> values) {
  return channel_of("Force", datasets::Quantity::force, at, std::move(values));
}

inline datasets::Channel velocity_of(const Sampling& at, std::vector<double> values) {
  return channel_of("Velocity", datasets::Quantity::velocity, at, std::move(values));
}

inline datasets::Record record_of(std::vector<datasets::Channel> channels) {
  datasets::Record record;
  record.provenance.source_file = "shot.csv";
  record.channels = std::move(channels);
  return record;
}

}  // namespace impactrig::tests
