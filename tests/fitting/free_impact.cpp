// SPDX-License-Identifier: BSD-3-Clause
#include "tests/fitting/free_impact.hpp"

#include <array>
#include <cmath>
#include <random>

#include "datasets/sensor_response.hpp"

namespace impactrig::tests {
namespace {

constexpr double fine = 2e-8;        // [s]
constexpr double interval = 1e-6;    // [s]
constexpr double touch = 1e-3;       // [s]
constexpr double recorded = 2.2e-3;  // [s]

struct Motion {
  std::vector<double> force, velocity, displacement;  // every `fine` from 0
  double end = 0.0;                                   // of the contact [s]
};

double force_of(const FreeImpact& impact, double depth, double rate) {
  if (depth <= 0.0) return 0.0;
  return impact.stiffness * std::pow(depth, 1.5) * (1.0 + impact.damping * rate);
}

/// By the classical Runge-Kutta method of fourth order.
Motion motion_of(const FreeImpact& impact) {
  Motion motion;
  std::array<double, 2> y = {0.0, impact.speed};
  const auto slope = [&](const std::array<double, 2>& at) {
    return std::array<double, 2>{at[1], -force_of(impact, at[0], at[1]) / impact.mass};
  };
  const auto ahead = [](const std::array<double, 2>& at, const std::array<double, 2>& by,
                        double h) {
    return std::array<double, 2>{at[0] + h * by[0], at[1] + h * by[1]};
  };
  for (double t = 0.0; t < recorded + interval; t += fine) {
    const bool before = t < touch;
    const double depth = before ? impact.speed * (t - touch) : y[0];
    motion.force.push_back(before ? 0.0 : force_of(impact, y[0], y[1]));
    motion.velocity.push_back(y[1]);
    motion.displacement.push_back(depth);
    if (before) continue;
    const auto a = slope(y), b = slope(ahead(y, a, 0.5 * fine)), c = slope(ahead(y, b, 0.5 * fine)),
               d = slope(ahead(y, c, fine));
    for (std::size_t i = 0; i < 2; ++i)
      y[i] += fine / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]);
    if (motion.end == 0.0 && y[0] < 0.0) motion.end = t;
  }
  return motion;
}

class Noise {
 public:
  Noise(double sigma, double correlation, std::uint64_t seed)
      : sigma_(sigma),
        memory_((correlation - 1.0) / (correlation + 1.0)),
        generator_(seed),
        state_(normal_(generator_)) {}

  double next() {
    const double value = sigma_ * state_;
    state_ = memory_ * state_ + std::sqrt(1.0 - memory_ * memory_) * normal_(generator_);
    return value;
  }

 private:
  double sigma_, memory_;
  std::mt19937_64 generator_;
  std::normal_distribution<double> normal_;
  double state_;
};

}  // namespace

datasets::Impact free_impact(const FreeImpact& impact, const FreeRecording& how,
                             const fitting::RigFile& rig) {
  const Motion motion = motion_of(impact);
  const auto signal_of = [&](datasets::Quantity quantity, const datasets::Sensor& sensor,
                             const std::vector<double>& history, double late, double sigma,
                             std::uint64_t seed) {
    datasets::ImpactSignal signal;
    signal.quantity = quantity;
    signal.channel = std::string(datasets::name(quantity));
    signal.interval = interval;
    signal.noise = sigma;
    signal.noise_correlation = how.correlation;
    signal.delay_uncertainty = sensor.delay.uncertainty;
    const std::vector<double> shown = datasets::sensor_response(sensor, history, fine);
    Noise noise(sigma, how.correlation, seed);
    for (int i = 10; i * interval < recorded; ++i) {
      const double place = (i * interval - late) / fine;
      const auto k = static_cast<std::size_t>(place);
      const double part = place - static_cast<double>(k);
      signal.values.push_back((1.0 - part) * shown[k] + part * shown[k + 1] + noise.next());
    }
    signal.start = 10 * interval;
    return signal;
  };
  datasets::Impact out;
  out.recording = "free";
  out.start = touch + 1.3e-6;  // detection is never exact
  out.end = motion.end - 0.7e-6;
  out.approach_velocity = impact.speed;
  out.force = signal_of(datasets::Quantity::force, rig.force.value_or(datasets::Sensor{}),
                        motion.force, 0.0, how.force_noise, 2 * how.seed);
  if (how.displacement) {
    out.displacement = signal_of(datasets::Quantity::displacement, datasets::Sensor{},
                                 motion.displacement, how.velocity_late, 0.0, 0);
    return out;
  }
  std::vector<double> velocity = motion.velocity;
  for (double& v : velocity) v = how.spot * v + how.velocity_zero;
  out.velocity = signal_of(datasets::Quantity::velocity, rig.velocity.value_or(datasets::Sensor{}),
                           velocity, how.velocity_late, how.velocity_noise, 2 * how.seed + 1);
  return out;
}

}  // namespace impactrig::tests
