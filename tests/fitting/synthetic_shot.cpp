// SPDX-License-Identifier: BSD-3-Clause
#include "tests/fitting/synthetic_shot.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include "datasets/sensor_response.hpp"
#include "models/simulation.hpp"

namespace impactrig::tests {

const char* const paper_rig = R"(
[beam]
length = "0.8 m"
section = { shape = "circle", radius = "15 mm" }
youngs_modulus = "68.952 GPa"
poisson_ratio = 0.3
density = "2766.7 kg/m^3"
[contact]
position = "0.69 m"
counterface = { shape = "groove", radius = "17.5 mm" }
length = "20 mm"
counter_modulus = "68.952 GPa"
restitution = 0.5
[start]
velocity = "0.441 m/s"
[solver]
accuracy = 1e-6
duration = "3 ms"
[sensors.force]
sensitivity = "4 pC/N"
resonance = { frequency = "45 kHz", quality = 20 }
amplifier = { gain = "1 mV/pC", low_cut = "0.3 Hz", high_cut = "100 kHz" }
delay = { value = "0 us", uncertainty = "1 us" }
[sensors.velocity]
sensitivity = "125 mm/s/V"
high_cut = "250 kHz"
delay = { value = "2 us", uncertainty = "0.1 us" }
)";

namespace {

constexpr double lead = 1e-3;  // recorded before first touch [s]

models::Simulation true_impact(const fitting::RigFile& rig, const ShotTruth& truth) {
  models::Rig true_rig = rig.rig;
  true_rig.contact.restitution = truth.restitution;
  true_rig.contact.stiffness_factor = truth.stiffness_factor;
  true_rig.start.velocity = truth.velocity;
  models::Solver solver = rig.solver;
  solver.duration = truth.duration;
  models::SimulationOptions options;
  options.motion = truth.motion;
  options.history = {.interval = truth.fine, .lead = 1.2 * lead};
  options.history.velocity_position = rig.velocity->position;
  return models::simulate(true_rig, solver, options);
}

/// What one channel adds to what its sensor shows.
struct Additions {
  double noise = 0.0, offset = 0.0, hum = 0.0;  // [SI]
  double late = 0.0;                            // [s]
};

class Recorder {
 public:
  Recorder(const ShotTruth& truth, const models::History& history)
      : truth_(truth),
        start_(history.start),
        generator_(truth.seed) {}

  datasets::ImpactSignal record(const datasets::Sensor& sensor, datasets::Quantity quantity,
                                const std::vector<double>& history, const Additions& added) {
    const std::vector<double> shown = datasets::sensor_response(sensor, history, truth_.fine);
    datasets::ImpactSignal signal;
    signal.quantity = quantity;
    signal.channel = std::string(datasets::name(quantity));
    signal.start = true_touch - lead;
    signal.interval = truth_.interval;
    signal.delay = sensor.delay.value;
    signal.delay_uncertainty = sensor.delay.uncertainty;
    signal.quantum = truth_.step * added.noise;
    signal.noise = std::hypot(added.noise, signal.quantum / std::sqrt(12.0));
    signal.noise_correlation = (1.0 + truth_.noise_memory) / (1.0 - truth_.noise_memory);
    draw_phases(added.hum > 0.0);
    last_ = truth_.noise_memory > 0.0 ? normal_(generator_) : 0.0;
    for (double t = -lead; t < truth_.duration - 20e-6; t += truth_.interval) {
      const double place = (t - added.late - start_) / truth_.fine;
      const auto k = static_cast<std::size_t>(place);
      const double part = place - static_cast<double>(k);
      signal.values.push_back(digitised(added.offset + (1.0 - part) * shown[k] +
                                            part * shown[k + 1] + added.noise * next_noise() +
                                            added.hum * hum(t),
                                        signal.quantum));
    }
    return signal;
  }

 private:
  void draw_phases(bool hums) {
    std::uniform_real_distribution<double> uniform(0.0, 2.0 * std::numbers::pi);
    phase_ = hums ? uniform(generator_) : 0.0;
    third_ = hums ? uniform(generator_) : 0.0;
  }

  double hum(double t) const {
    const double mains = 2.0 * std::numbers::pi * 50.0;
    return std::sin(mains * t + phase_) + 0.3 * std::sin(3.0 * mains * t + third_);
  }

  /// Of unit standard deviation.
  double next_noise() {
    const double phi = truth_.noise_memory;
    last_ = phi * last_ + std::sqrt(1.0 - phi * phi) * normal_(generator_);
    return last_;
  }

  static double digitised(double value, double quantum) {
    return quantum > 0.0 ? quantum * std::round(value / quantum) : value;
  }

  const ShotTruth& truth_;
  double start_;
  std::mt19937_64 generator_;
  std::normal_distribution<double> normal_;
  double phase_ = 0.0, third_ = 0.0, last_ = 0.0;
};

}  // namespace

datasets::Impact synthetic_shot(const fitting::RigFile& rig, const ShotTruth& truth) {
  const models::Simulation simulation = true_impact(rig, truth);
  datasets::Impact impact;
  impact.recording = "synthetic";
  impact.start = true_touch + truth.found_late;
  impact.end = true_touch + simulation.episodes.front().end;
  impact.approach_velocity = 1.003 * truth.velocity;
  Recorder recorder(truth, simulation.history);
  impact.force =
      recorder.record(*rig.force, datasets::Quantity::force, simulation.history.seen_force(),
                      {truth.force_noise, truth.force_offset, truth.force_hum, truth.force_delay});
  impact.velocity =
      recorder.record(*rig.velocity, datasets::Quantity::velocity, simulation.history.velocity,
                      {truth.velocity_noise, 0.0, truth.velocity_hum, truth.velocity_delay});
  return impact;
}

}  // namespace impactrig::tests
