// SPDX-License-Identifier: BSD-3-Clause
// Random scenes far apart in size, stiffness and speed: each gives a sound result or a sentence.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "models/beams/bar_element.hpp"
#include "models/simulation.hpp"
#include "tests/models/scenes.hpp"

namespace {

using namespace impactrig::models;

struct Scene {
  Rig rig;
  Solver solver;
};

/// From 5 cm to 10 m, rubber to steel, 1 mm/s to 10 m/s, e 0.05 to 1, every law and model.
Scene random_scene(std::mt19937& random) {
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const auto spread = [&](double low, double high) {
    return std::exp(uniform(std::log(low), std::log(high)));
  };
  const auto choice = [&](int n) { return std::uniform_int_distribution<int>(0, n - 1)(random); };
  Scene scene;
  Rig& rig = scene.rig;
  const double length = spread(0.05, 10.0);
  const double radius = length * spread(0.005, 0.05);
  rig.beam = {.length = length,
              .area = std::numbers::pi * radius * radius,
              .second_moment = std::numbers::pi * std::pow(radius, 4) / 4.0,
              .youngs_modulus = spread(1e7, 2.1e11),
              .density = uniform(900.0, 8000.0)};
  Contact& contact = rig.contact;
  contact.position = choice(8) == 0 ? length : length * uniform(0.05, 0.99);
  contact.counterface = static_cast<Counterface>(choice(3));
  contact.radius = radius;
  contact.counter_radius = radius * uniform(1.01, 4.0);
  contact.length = radius * uniform(0.5, 2.0);
  contact.modulus = rig.beam.youngs_modulus;
  contact.counter_modulus = spread(1e7, 2.1e11);
  contact.poisson_ratio = uniform(0.0, 0.5);
  contact.counter_poisson_ratio = uniform(0.0, 0.5);
  contact.law = choice(5) == 0 ? "linear" : "goldsmith";
  contact.exponent = choice(2) == 0 ? 1 : 3;
  contact.stiffness = contact.modulus * contact.length * spread(0.01, 1.0);
  contact.damping =
      std::array{"none", "lankarani-nikravesh", "exact"}[static_cast<std::size_t>(choice(3))];
  contact.restitution = uniform(0.05, 1.0);
  rig.start.velocity = spread(1e-3, 10.0);
  rig.gravity = choice(2) == 0 ? 0.0 : 9.81;
  Solver& solver = scene.solver;
  solver.model = static_cast<BeamModel>(choice(3));
  solver.basis = static_cast<Basis>(choice(2));
  solver.modes = 1 + choice(8);
  solver.axial_modes = choice(4) == 0 ? 1 : 0;
  const int before = 1 + choice(10);
  solver.elements = {before, contact.position == length ? 0 : 1 + choice(2)};
  solver.accuracy = spread(1e-9, 1e-3);
  // two passages of a bending wave: contact, most of the time, and a return
  solver.duration = 2.0 * length * length /
                    std::sqrt(rig.beam.youngs_modulus * rig.beam.second_moment /
                              (rig.beam.density * rig.beam.area)) /
                    15.4;
  return scene;
}

void expect_sound(const Scene& scene, const Simulation& run, double& worst) {
  EXPECT_TRUE(std::isfinite(run.peak_force) && run.peak_force > 0.0);
  EXPECT_TRUE(std::isfinite(run.max_penetration) && run.max_penetration > 0.0);
  EXPECT_TRUE(std::isfinite(run.impulse) && run.impulse > 0.0);
  EXPECT_TRUE(std::isfinite(run.energy.kinetic) && std::isfinite(run.energy.elastic));
  ASSERT_FALSE(run.episodes.empty());
  EXPECT_LE(std::abs(run.energy.imbalance), 10.0 * scene.solver.accuracy + 1e-11);
  worst = std::max(worst, std::abs(run.energy.imbalance) / (scene.solver.accuracy + 1e-12));
  double before = -1.0;
  for (const Episode& episode : run.episodes) {
    EXPECT_GE(episode.start, before);
    EXPECT_GE(episode.end, episode.start);
    EXPECT_GE(episode.impulse, 0.0);
    EXPECT_GE(episode.dissipated, -scene.solver.accuracy * run.energy.initial);
    before = episode.end;
  }
  // no touch, separation or peak was overlooked: histories show gaps and penetrations as booked
  std::size_t at = 0;
  double highest = 0.0;
  for (std::size_t k = 0; k < run.history.force.size(); ++k) {
    const double t = run.history.start + run.history.interval * static_cast<double>(k);
    while (at + 1 < run.episodes.size() && t >= run.episodes[at + 1].start) ++at;
    const Episode& now = run.episodes[at];
    const bool touching = t >= now.start && (t <= now.end || now.open);
    const double rounding = 1e-6 * run.max_penetration;
    EXPECT_EQ(run.history.penetration[k] < -rounding && touching, false) << "at " << t;
    EXPECT_EQ(run.history.penetration[k] > rounding && !touching, false) << "at " << t;
    EXPECT_GE(run.history.force[k], 0.0) << "at " << t;
    highest = std::max(highest, run.history.force[k]);
  }
  EXPECT_LE(highest, run.peak_force * (1.0 + 3.0 * scene.solver.accuracy));
  for (double velocity : run.history.velocity) EXPECT_TRUE(std::isfinite(velocity));
  for (double force : run.history.sensor_force)
    EXPECT_LE(force, run.sensor->peak_force * (1.0 + 3.0 * scene.solver.accuracy));
}

/// The same with masses, a held hinge, damping and gravity from anywhere.
Scene laden_scene(std::mt19937& random) {
  Scene scene = random_scene(random);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const auto spread = [&](double low, double high) {
    return std::exp(uniform(std::log(low), std::log(high)));
  };
  Rig& rig = scene.rig;
  Beam& beam = rig.beam;
  const double bending = beam.youngs_modulus * beam.second_moment / beam.length;
  const double swing = rig.start.velocity / rig.contact.position;  // [1/s]
  for (int i = 0; i < 2; ++i)
    beam.masses.push_back({beam.length * uniform(0.01, 1.0), beam.bar_mass() * spread(0.01, 3.0)});
  rig.hinge.spring = bending * spread(1e-4, 1.0);
  rig.hinge.viscous = beam.hinge_inertia() * swing * spread(1e-3, 1.0);
  beam.damping.mass = swing * spread(1e-3, 1.0);
  // of the time a wave takes through a twentieth of the bar
  beam.damping.stiffness =
      spread(1e-3, 0.3) * beam.length / 20.0 / std::sqrt(beam.youngs_modulus / beam.density);
  *scene.solver.duration *= 0.3;  // the full equations take their time
  rig.gravity = 9.81;
  rig.gravity_direction = uniform(-3.14, 3.14);
  return scene;
}

/// The same bars in up to four segments, half of them shearing.
Scene built_scene(std::mt19937& random) {
  Scene scene = random_scene(random);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  Beam& beam = scene.rig.beam;
  beam.shear_coefficient = 0.886;
  if (uniform(0.0, 1.0) < 0.5) beam.theory = BeamTheory::timoshenko;
  double left = beam.length;
  for (int i = 0; i < 4; ++i) {
    const double length = i == 3 ? left : left * uniform(0.05, 0.8);
    const double scale = uniform(0.4, 1.6);  // of the radius
    beam.segments.push_back({.length = length,
                             .area = beam.area * scale * scale,
                             .second_moment = beam.second_moment * std::pow(scale, 4),
                             .shear_coefficient = 0.886});
    left -= length;
  }
  beam.segments[1].youngs_modulus = beam.youngs_modulus * uniform(0.3, 3.0);
  beam.segments[2].density = beam.density * uniform(0.3, 3.0);
  scene.solver.axial_modes = 0;
  const std::array<int, 2> fewest = fewest_elements(beam, scene.rig.contact.position);
  for (std::size_t side = 0; side < 2; ++side)
    scene.solver.elements[side] = std::max(scene.solver.elements[side], fewest[side]);
  return scene;
}

/// On a stop from light to heavy, soft to stiff, hardly damped to beyond critical.
Scene sprung_scene(std::mt19937& random) {
  Scene scene = random_scene(random);
  const auto spread = [&](double low, double high) {
    return std::exp(std::uniform_real_distribution<double>(std::log(low), std::log(high))(random));
  };
  const Contact& contact = scene.rig.contact;
  Stop stop{.mass = scene.rig.beam.bar_mass() * spread(1e-3, 10.0),
            .stiffness = contact.modulus * contact.length * spread(1e-2, 1e2)};
  stop.viscous = 2.0 * std::sqrt(stop.mass * stop.stiffness) * spread(1e-3, 3.0);
  scene.rig.stop = stop;
  return scene;
}

void run_scenes(int count, unsigned seed, Scene (*draw)(std::mt19937&), int most_refused) {
  std::mt19937 random(seed);
  double worst = 0.0;
  int refused = 0;
  for (int number = 0; number < count; ++number) {
    const Scene scene = draw(random);
    SimulationOptions options;
    options.history.interval = *scene.solver.duration / 500.0;
    SCOPED_TRACE(testing::Message()
                 << "scene " << number << ": length " << scene.rig.beam.length << ", E "
                 << scene.rig.beam.youngs_modulus << ", v " << scene.rig.start.velocity << ", "
                 << scene.rig.contact.law << ' ' << scene.rig.contact.damping << " e "
                 << scene.rig.contact.restitution << ", " << name(scene.solver.model)
                 << ", accuracy " << scene.solver.accuracy);
    try {
      expect_sound(scene, simulate(scene.rig, scene.solver, options), worst);
    } catch (const std::exception& problem) {
      const std::string sentence = problem.what();
      EXPECT_GT(sentence.size(), 40u) << sentence;
      ++refused;
    }
  }
  testing::Test::RecordProperty("worst imbalance over accuracy", std::to_string(worst));
  EXPECT_LT(refused, most_refused) << "more refusals than hard impacts on soft bars explain";
}

TEST(Stress, ThreeHundredRandomScenesGiveSoundResultsOrASentence) {
  run_scenes(300, 20070101, random_scene, 30);
}

TEST(Stress, SoDoScenesWithMassesHeldHingesDampingAndGravityFromAnywhere) {
  run_scenes(60, 20261121, laden_scene, 6);
}

TEST(Stress, SoDoBarsOfSegmentsThatMayShear) {
  run_scenes(100, 20261122, built_scene, 25);
}

/// With friction in the hinge, from what the impact does not see to what ends the swing within it.
Scene rubbing_scene(std::mt19937& random) {
  Scene scene = random_scene(random);
  const auto spread = [&](double low, double high) {
    return std::exp(std::uniform_real_distribution<double>(std::log(low), std::log(high))(random));
  };
  Rig& rig = scene.rig;
  const double rate = rig.start.velocity / rig.contact.position;
  rig.hinge.friction = rig.beam.hinge_inertia() * rate * rate * spread(1e-3, 1e2);
  *scene.solver.duration *= 0.3;
  return scene;
}

TEST(Stress, SoDoScenesWithFrictionInTheHinge) {
  run_scenes(100, 20261123, rubbing_scene, 10);
}

TEST(Stress, SoDoScenesWithAStopThatGivesWay) {
  run_scenes(200, 20261122, sprung_scene, 20);
}

}  // namespace
