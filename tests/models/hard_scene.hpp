// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "models/simulation.hpp"
#include "tests/models/plain_bars.hpp"

// What tests of absurd scenes share.
namespace impactrig::tests {

/// Round, with a hole [m, m, m, Pa, kg/m^3].
inline models::Beam tube(double length, double radius, double wall, double youngs_modulus,
                         double density) {
  models::Beam beam = round_bar(length, radius, youngs_modulus, density);
  const models::Beam inside = round_bar(length, radius - wall, youngs_modulus, density);
  beam.area -= inside.area;
  beam.second_moment -= inside.second_moment;
  return beam;
}

/// As in Contact.
struct Surfaces {
  models::Counterface counterface = models::Counterface::groove;
  double radius, counter_radius = 0.0, length, modulus, counter_modulus;
};

inline void set_contact(const Surfaces& surfaces, models::Contact& contact) {
  contact.counterface = surfaces.counterface;
  contact.radius = surfaces.radius;
  contact.counter_radius = surfaces.counter_radius;
  contact.length = surfaces.length;
  contact.modulus = surfaces.modulus;
  contact.counter_modulus = surfaces.counter_modulus;
}

/// Of the first contact, relative.
struct Errors {
  double peak, duration, impulse;
};

inline Errors errors(const models::Simulation& run, const models::Simulation& finer) {
  const models::Episode& a = run.episodes.at(0);
  const models::Episode& b = finer.episodes.at(0);
  const auto error = [](double x, double y) { return std::abs(x / y - 1.0); };
  return {error(a.peak_force, b.peak_force), error(a.end - a.start, b.end - b.start),
          error(a.impulse, b.impulse)};
}

/// Against a run a thousand times more accurate.
inline void expect_accurate(const models::Rig& rig, models::Solver solver,
                            const models::SimulationOptions& options = {}) {
  const models::Simulation run = simulate(rig, solver, options);
  solver.accuracy *= 1e-3;
  const Errors e = errors(run, simulate(rig, solver, options));
  solver.accuracy *= 1e3;
  EXPECT_LE(e.peak, solver.accuracy);
  EXPECT_LE(e.duration, solver.accuracy);
  EXPECT_LE(e.impulse, solver.accuracy);
}

}  // namespace impactrig::tests
