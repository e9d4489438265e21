// SPDX-License-Identifier: BSD-3-Clause
//
// Fits to the displacement alone that a laser recorded.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "fitting/fit.hpp"
#include "models/simulation.hpp"
#include "tests/fitting/fast_fit.hpp"

namespace impactrig::fitting {
namespace {

const char* const titanium_rig = R"(
[beam]
youngs_modulus = "1.14e+11 Pa"
poisson_ratio = 0.34
density = "4430 kg/m^3"
theory = "euler-bernoulli"
length = "0.19383 m"
section = { shape = "circle", radius = "3.06 mm" }
[contact]
position = "0.1529 m"
counterface = { shape = "groove", radius = "5.109 mm" }
length = "5.22 mm"
radius = "3.06 mm"
counter_modulus = "1.14e+11 Pa"
counter_poisson_ratio = 0.34
law = "goldsmith"
exponent = 3
damping = "lankarani-nikravesh"
restitution = 0.574
stiffness_factor = 1.255
[start]
velocity = "0.1008 m/s"
[solver]
model = "hybrid"
basis = "pinned-free"
modes = 15
accuracy = 1e-5
duration = "4.98 ms"
[sensors.force]
high_cut = "50 kHz"
[sensors.velocity]
high_cut = "1 MHz"
)";

/// The displacement of the struck point with white noise, from 1 ms before touch.
datasets::Impact displacement_of(const RigFile& rig, double noise, unsigned seed) {
  constexpr double interval = 2e-6;  // [s]
  constexpr int before = 500, behind = 2490;
  datasets::Impact impact = tests::synthetic_shot(rig, {.duration = 5e-3});
  datasets::ImpactSignal signal = *impact.velocity;
  impact.force.reset();
  impact.velocity.reset();
  models::SimulationOptions options;
  options.history.interval = interval;
  const models::Simulation run = models::simulate(rig.rig, rig.solver, options);
  signal.quantity = datasets::Quantity::displacement;
  signal.channel = "displacement";
  signal.interval = interval;
  signal.start = tests::true_touch - before * interval;
  signal.values.clear();
  signal.valid.clear();
  std::mt19937 random(seed);
  std::normal_distribution<double> white(0.0, noise);
  for (int k = -before; k < behind; ++k) {
    const double motion = k < 0 ? rig.rig.start.velocity * k * interval
                                : run.history.displacement.at(static_cast<std::size_t>(k));
    signal.values.push_back(motion + white(random));
  }
  impact.displacement = signal;
  return impact;
}

// Many contacts in a few micrometres: from e = 0.5 the search ended at 0, and chi-square was 1.1.
TEST(DisplacementAlone, IsSearchedForFromEverywhere) {
  const RigFile truth = parse_rig_file(titanium_rig, "rig.toml");
  const RigFile rig =
      parse_rig_file(titanium_rig, "rig.toml",
                     {{"contact.restitution", "0.5"}, {"contact.stiffness_factor", "1.0"}});
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const Fit found = fit({displacement_of(truth, 0.3e-6, seed)}, rig);
    EXPECT_LT(std::abs(tests::pull(found, "contact.restitution", 0.574)), 4.0) << seed;
    EXPECT_LT(std::abs(tests::pull(found, "contact.stiffness_factor", 1.255)), 4.0) << seed;
  }
}

}  // namespace
}  // namespace impactrig::fitting
