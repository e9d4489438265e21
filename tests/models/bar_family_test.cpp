// SPDX-License-Identifier: BSD-3-Clause
#include "models/modal/bar_family.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "models/modal/bar_cache.hpp"
#include "tests/models/scenes.hpp"

namespace impactrig::tests {
namespace {

using namespace models;

// Weight and spring bend the modes of every bar differently: what follows from another's modes is
// what the bar itself has.
TEST(BarFamily, GivesTheModesOfEachBar) {
  for (const Solver& solver : {hybrid(Basis::pinned_free, 12, 1e-6, 1e-3),
                               hybrid(Basis::cantilever, 7, 1e-6, 1e-3), ancf(7, 1, 1e-6, 1e-3)})
    for (const double spring : {0.0, 2000.0}) {
      Rig rig = paper_rig();
      rig.gravity = 9.81;
      rig.beam.youngs_modulus *= 0.03;  // weight tells
      rig.beam.density *= 1.7;
      rig.beam.area *= 0.8;
      rig.hinge.spring = spring;
      const auto itself = make_modal_bar(rig, solver);
      const auto derived = BarFamily(*BarFamily::representative(rig), solver).bar(rig);
      const ModalBeam& a = itself->modes();
      const ModalBeam& b = derived->modes();
      ASSERT_EQ(a.modes(), b.modes());
      EXPECT_NEAR(b.elastic_compliance() / a.elastic_compliance(), 1.0, 1e-13);
      for (int k = 0; k < a.modes(); ++k) {
        EXPECT_NEAR(b.omega()[k] / a.omega()[k], 1.0, 1e-10) << k;
        EXPECT_NEAR(std::abs(b.struck()[k] / a.struck()[k]), 1.0, 1e-9) << k;
        EXPECT_NEAR(std::abs(b.rigid()[k]), std::abs(a.rigid()[k]), 1e-9 * a.rigid().norm()) << k;
        EXPECT_NEAR(std::abs(b.point(0.3)[k]), std::abs(a.point(0.3)[k]),
                    1e-9 * a.point(0.3).norm())
            << k;
      }
      const Eigen::VectorXd turned = 0.01 * b.rigid();
      const Eigen::VectorXd also = 0.01 * a.rigid();
      const double weight = a.energy(also, also).gravitational;
      EXPECT_NEAR(b.energy(turned, turned).gravitational / weight, 1.0, 1e-9);
      EXPECT_NEAR(b.energy(turned, turned).spring, a.energy(also, also).spring, 1e-9 * weight);
      const auto shortening = [](const ModalBeam& beam, const Eigen::VectorXd& state) {
        BarStations::Slopes slopes;
        beam.stations().find_slopes(state, state, slopes);
        Eigen::VectorXd momentum;
        return beam.stations().shorten(slopes, momentum);
      };
      EXPECT_NEAR(shortening(b, turned) / shortening(a, also), 1.0, 1e-9);
    }
}

TEST(BarFamily, HasNoBarsWithFurtherMasses) {
  Rig rig = paper_rig();
  rig.beam.masses = {{.position = 0.4, .mass = 0.1}};
  EXPECT_FALSE(BarFamily::representative(rig));
}

/// The paper's bar, so many times as stiff.
Rig bar_of_stiffness(double factor) {
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  rig.beam.youngs_modulus *= factor;
  return rig;
}

std::shared_ptr<const ModalBar> representative_bar(const Rig& rig, const Solver& solver) {
  return make_modal_bar(*BarFamily::representative(rig), solver);
}

// What a table says of its bars is what bars that are solved by themselves do, wherever in its
// range they are.
TEST(BarTable, GivesTheStepsOfBarsBetween) {
  const Rig rig = bar_of_stiffness(1.0);
  for (const Solver& solver : {hybrid(Basis::pinned_free, 12, 1e-6, 1e-3),
                               hybrid(Basis::cantilever, 3, 1e-6, 1e-3), ancf(7, 1, 1e-6, 1e-3)}) {
    const auto family = representative_bar(rig, solver);
    for (const int number : {-3, 0, 2}) {
      const BarTable table(family, BarTable::middle_of(number));
      ASSERT_TRUE(table.knows_modes());
      int known = 0;
      for (const double of_range : {-0.5, -0.2, 0.17, 0.5}) {
        const double heaviness = BarTable::middle_of(number) * std::exp2(0.499 * of_range);
        ASSERT_EQ(BarTable::number_of(heaviness), number);
        const ModalBar solved(family, {.weight = heaviness});
        const BarTable::Weights weights = table.weights(heaviness);
        const ModalBeam modes = table.modes(weights, {});
        for (int k = 0; k < modes.modes(); ++k)
          EXPECT_NEAR(modes.omega()[k] / solved.modes().omega()[k], 1.0, 1e-12) << k;
        EXPECT_LE((modes.struck() - solved.modes().struck()).norm(), 1e-12 * modes.struck().norm());
        const Eigen::MatrixXd& slopes = solved.modes().stations().slopes;
        EXPECT_LE((modes.stations().slopes - slopes).norm(), 1e-12 * slopes.norm());
        EXPECT_LE((modes.stations().weight - solved.modes().stations().weight).norm(),
                  1e-12 * modes.stations().weight.norm());
        for (const int nodes : {6, 8})
          for (const int level : {0, 3, 9, 20, 60}) {
            const Collocation& rule = Collocation::of(nodes);
            known += table.knows_step(rule, level);
            if (!table.knows_step(rule, level)) continue;
            std::optional<ModalStep> step;
            table.find_step(weights, rule, level, nullptr, step);
            const ModalStep& expected = solved.step(rule, level);
            EXPECT_NEAR(step->h() / expected.h(), 1.0, 1e-13);
            EXPECT_LE(expected.distance(*step, solved.modes()), 2e-12)
                << nodes << " nodes, level " << level;
          }
      }
      EXPECT_GE(known, 32);  // of 40
    }
  }
}

TEST(BarTable, KnowsBarsWithoutWeight) {
  const Solver solver = hybrid(Basis::pinned_free, 5, 1e-6, 1e-3);
  Rig rig = bar_of_stiffness(1.0);
  rig.gravity = 0.0;
  const BarTable table(representative_bar(rig, solver), 1.0);
  EXPECT_TRUE(table.knows_modes());
  EXPECT_TRUE(table.knows_step(Collocation::of(8), 9));
}

// A bar so slack that its weight holds it like its stiffness: four bars are too few for what lies
// between, and it is solved by itself.
TEST(BarTable, KnowsNothingOfSlackBars) {
  const Solver solver = hybrid(Basis::pinned_free, 5, 1e-6, 1e-3);
  const Rig slack = bar_of_stiffness(1e-7);
  EXPECT_FALSE(BarTable(representative_bar(slack, solver), 1.0).knows_modes());
  const auto itself = make_modal_bar(slack, solver);
  const auto derived = BarFamily(*BarFamily::representative(slack), solver).bar(slack);
  for (int k = 0; k < itself->modes().modes(); ++k)
    EXPECT_NEAR(derived->modes().omega()[k] / itself->modes().omega()[k], 1.0, 1e-9) << k;
}

// What the weight of a slack bar does to its modes is small, but over its longest steps it adds up:
// those are made by themselves.
TEST(BarTable, LeavesOutStepsItDoesNotKnow) {
  const Solver solver = hybrid(Basis::pinned_free, 5, 1e-6, 1e-3);
  const Collocation& rule = Collocation::of(8);
  const Rig rig = bar_of_stiffness(0.05);
  const BarTable table(representative_bar(rig, solver), 1.0);
  ASSERT_TRUE(table.knows_modes());
  EXPECT_FALSE(table.knows_step(rule, 0));
  EXPECT_TRUE(table.knows_step(rule, 20));
  const auto derived = BarFamily(*BarFamily::representative(rig), solver).bar(rig);
  for (const int level : {0, 2, 5, 20}) {
    const ModalStep own(derived->modes(), rule, derived->ladder().length_of(level));
    EXPECT_LE(own.distance(derived->step(rule, level), derived->modes()), 2e-12) << level;
  }
}

// A bar that comes when another one is gone takes its memory, and is what it is without.
TEST(BarFamily, MakesBarsInTheMemoryOfOthers) {
  const Solver solver = hybrid(Basis::pinned_free, 5, 1e-6, 1e-3);
  const Rig first = bar_of_stiffness(1.04), second = bar_of_stiffness(1.01);
  const BarFamily used(*BarFamily::representative(first), solver);
  const BarFamily fresh(*BarFamily::representative(second), solver);
  const ModalBar* const place = [&] {
    const auto gone = used.bar(first);
    for (const int nodes : {6, 8})
      for (const int level : {9, 20}) gone->step(Collocation::of(nodes), level);
    return gone.get();
  }();
  const auto bar = used.bar(second), expected = fresh.bar(second);
  EXPECT_EQ(bar.get(), place);
  EXPECT_NE(used.bar(first).get(), place);
  EXPECT_EQ(bar->modes().omega(), expected->modes().omega());
  EXPECT_EQ(bar->modes().stations().mass, expected->modes().stations().mass);
  EXPECT_EQ(bar->modes().stations().slopes, expected->modes().stations().slopes);
  for (const int nodes : {8, 6})
    for (const int level : {20, 9, 12}) {
      const Collocation& rule = Collocation::of(nodes);
      const ModalStep& step = bar->step(rule, level);
      EXPECT_EQ(step.nodes(), nodes);
      EXPECT_EQ(step.h(), expected->step(rule, level).h());
      EXPECT_EQ(step.distance(expected->step(rule, level), bar->modes()), 0.0);
    }
}

// Free of weight a bar's step is another's, in other units of time and mass.
TEST(ModalStep, ScalesWithTimeAndMass) {
  Rig rig = paper_rig();
  rig.gravity = 0.0;
  const Solver solver = hybrid(Basis::pinned_free, 7, 1e-6, 1e-3);
  const auto bar = make_modal_bar(rig, solver);
  const ModalBeam::Change change{.stiffness = 1.7, .mass = 0.6};
  const ModalBar other(bar, change);
  for (const int level : {0, 8, 30}) {
    const Collocation& rule = Collocation::of(8);
    const ModalStep::Scale scale(bar->modes().modes(), 8, change.time(), change.mass);
    const std::array steps = {&bar->step(rule, level)};
    const ModalStep scaled =
        ModalStep::sum(steps, std::array{1.0}, change.time() * steps[0]->h(), &scale);
    EXPECT_NEAR(scaled.h() / other.step(rule, level).h(), 1.0, 1e-14);
    EXPECT_LE(other.step(rule, level).distance(scaled, other.modes()), 1e-12);
  }
}

}  // namespace
}  // namespace impactrig::tests
