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

datasets::Impact synthetic_shot(const fitting::RigFile& rig, const ShotTruth& truth) {
  constexpr double fine = 1e-7;      // [s]
  constexpr double interval = 1e-6;  // [s]
  constexpr double lead = 1e-3;      // [s]
  models::Rig true_rig = rig.rig;
  true_rig.contact.restitution = truth.restitution;
  true_rig.contact.stiffness_factor = truth.stiffness_factor;
  true_rig.start.velocity = truth.velocity;
  models::Solver solver = rig.solver;
  solver.duration = truth.duration;
  models::SimulationOptions options;
  options.history = {.interval = fine, .lead = 1.2 * lead};
  options.history.velocity_position = rig.velocity->position;
  const models::Simulation simulation = models::simulate(true_rig, solver, options);

  std::mt19937_64 generator(truth.seed);
  std::normal_distribution<double> normal;
  const auto record = [&](datasets::Quantity quantity, const datasets::Sensor& sensor,
                          const std::vector<double>& history, double noise, double offset,
                          double late, double hum) {
    const std::vector<double> shown = datasets::sensor_response(sensor, history, fine);
    datasets::ImpactSignal signal;
    signal.quantity = quantity;
    signal.channel = std::string(datasets::name(quantity));
    signal.start = true_touch - lead;
    signal.interval = interval;
    signal.noise = noise;
    signal.delay = sensor.delay.value;
    signal.delay_uncertainty = sensor.delay.uncertainty;
    std::uniform_real_distribution<double> uniform(0.0, 2.0 * std::numbers::pi);
    const double mains = 2.0 * std::numbers::pi * 50.0;
    const double phase = hum > 0.0 ? uniform(generator) : 0.0;
    const double third = hum > 0.0 ? uniform(generator) : 0.0;
    const double phi = truth.noise_memory;
    double last = phi > 0.0 ? normal(generator) : 0.0;
    const auto coloured = [&] {
      last = phi * last + std::sqrt(1.0 - phi * phi) * normal(generator);
      return noise * last;
    };
    const double quantum = truth.step * noise;
    signal.quantum = quantum;
    signal.noise = std::hypot(noise, quantum / std::sqrt(12.0));
    signal.noise_correlation = (1.0 + phi) / (1.0 - phi);
    const auto digitised = [&](double value) {
      return quantum > 0.0 ? quantum * std::round(value / quantum) : value;
    };
    for (double t = -lead; t < truth.duration - 20e-6; t += interval) {
      const double place = (t - late - simulation.history.start) / fine;
      const auto k = static_cast<std::size_t>(place);
      const double part = place - static_cast<double>(k);
      const double random = phi > 0.0 ? coloured() : noise * normal(generator);
      signal.values.push_back(
          digitised(offset + (1.0 - part) * shown[k] + part * shown[k + 1] + random +
                    hum * (std::sin(mains * t + phase) + 0.3 * std::sin(3.0 * mains * t + third))));
    }
    return signal;
  };
  datasets::Impact impact;
  impact.recording = "synthetic";
  impact.start = true_touch + 3e-6;  // detection is never exact
  impact.end = true_touch + simulation.episodes.front().end;
  impact.approach_velocity = 1.003 * truth.velocity;
  impact.force = record(datasets::Quantity::force, *rig.force, simulation.history.seen_force(),
                        truth.force_noise, truth.force_offset, truth.force_delay, truth.force_hum);
  impact.velocity = record(datasets::Quantity::velocity, *rig.velocity, simulation.history.velocity,
                           truth.velocity_noise, 0.0, truth.velocity_delay, truth.velocity_hum);
  return impact;
}

}  // namespace impactrig::tests
