// SPDX-License-Identifier: BSD-3-Clause
// What `accuracy` promises: peak force, first contact's duration and impulse are that good.
#include <gtest/gtest.h>

#include <cmath>

#include "models/simulation.hpp"
#include "tests/models/scenes.hpp"

namespace {

using namespace impactrig::models;
using namespace impactrig::tests;

struct Case {
  const char* name;
  Solver solver;
  const char* damping;
  int exponent = 1;
  double position = 0.69;  // [m]
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name << ", " << c.damping;
}

class Accuracy : public testing::TestWithParam<Case> {};

TEST_P(Accuracy, IsKept) {
  Rig rig = paper_rig();
  rig.contact.damping = GetParam().damping;
  rig.contact.restitution = 0.5;
  rig.contact.exponent = GetParam().exponent;
  rig.contact.position = GetParam().position;
  Solver solver = GetParam().solver;
  solver.accuracy = 1e-13;
  const Simulation reference = simulate(rig, solver);
  for (double accuracy = 1e-3; accuracy > 5e-11; accuracy *= 0.1) {
    solver.accuracy = accuracy;
    const Simulation run = simulate(rig, solver);
    const auto error = [](double a, double b) { return std::abs(a / b - 1.0); };
    // a thirteenth digit of the reference is its own rounding
    EXPECT_LE(error(run.peak_force, reference.peak_force), accuracy) << "accuracy " << accuracy;
    EXPECT_LE(error(run.episodes.at(0).end, reference.episodes.at(0).end), accuracy)
        << "accuracy " << accuracy;
    EXPECT_LE(error(run.episodes.at(0).impulse, reference.episodes.at(0).impulse), accuracy)
        << "accuracy " << accuracy;
    EXPECT_LE(std::abs(run.energy.imbalance), 10.0 * accuracy) << "accuracy " << accuracy;
  }
  EXPECT_LT(std::abs(reference.energy.imbalance), 1e-10);
}

const Case cases[] = {
    {"rigid", rigid(1e-6), "none"},
    {"rigid", rigid(1e-6), "exact"},
    // here a step over the separation had a lucky error estimate: the impulse was off by 1e-6
    {"rigid further in", rigid(1e-6), "none", 3, 0.5},
    {"hybrid 5 further in", hybrid(Basis::pinned_free, 5, 1e-6, 5e-4), "none", 3, 0.6},
    // here the damping multiplied the error of a light node's speed: the peak was off by 9e-6
    {"ancf 8 2 further out", ancf(8, 2, 1e-6, 5e-4), "exact", 1, 0.75},
    {"hybrid cantilever 3", hybrid(Basis::cantilever, 3, 1e-6, 5e-4), "lankarani-nikravesh"},
    {"hybrid pinned-free 3", hybrid(Basis::pinned_free, 3, 1e-6, 5e-4), "none"},
    {"hybrid pinned-free 7", hybrid(Basis::pinned_free, 7, 1e-6, 5e-4), "exact"},
    {"ancf 4 2", ancf(4, 2, 1e-6, 5e-4), "none"},
    {"ancf 10 2", ancf(10, 2, 1e-6, 5e-4), "lankarani-nikravesh"},
};

INSTANTIATE_TEST_SUITE_P(EveryModel, Accuracy, testing::ValuesIn(cases), [](const auto& instance) {
  std::string name = std::string(instance.param.name) + " " + instance.param.damping;
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name;
});

}  // namespace
